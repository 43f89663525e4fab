"""The model against closed forms and conservation laws."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_scene import HOVER, WINDY, XCELL, random_controls, random_states, rotation

from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter import model
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.primitives import mirrored_controls, mirrored_states


def reference_derivative(machine, state, control):
    """Eqs. (7) and (8) once more, with matrices and cross products."""
    R, v, omega = rotation(state).as_matrix(), state[7:10], state[10:]
    J = np.diag(machine.inertia)
    u_c, u_psi, gp, gr = control
    lift = u_c * np.array([np.sin(gp) * np.cos(gr), -np.sin(gr), np.cos(gp) * np.cos(gr)])
    yaw = np.array([0.0, -u_psi, 0.0])
    torque = np.cross([0, 0, machine.hub], lift) + np.cross([-machine.tail, 0, 0], yaw)
    drag = -np.array(machine.drag) * (v - R.T @ machine.wind)
    force = lift + yaw + drag + R.T @ [0, 0, -machine.weight]
    qv, qw = state[3:6], state[6]
    turning = 0.5 * np.append(qw * omega + np.cross(qv, omega), -qv @ omega)
    return np.concatenate(
        [
            R @ v,
            turning,
            np.cross(v, omega) + force / machine.mass,
            np.linalg.solve(J, np.cross(J @ omega, omega) + torque),
        ]
    )


def test_control_matrix_is_the_papers():
    gp, gr = 0.13, -0.21
    d_t, d_r = XCELL.hub, XCELL.tail
    sp, cp, sr, cr = np.sin(gp), np.cos(gp), np.sin(gr), np.cos(gr)
    papers = [[d_t * sr, 0], [d_t * sp * cr, 0], [0, d_r], [sp * cr, 0], [-sr, -1], [cp * cr, 0]]
    assert model.control_matrix(XCELL, gp, gr) == pytest.approx(np.array(papers), abs=1e-16)


@given(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(-200, 200), st.floats(-50, 50))
@settings(max_examples=50, deadline=None)
def test_control_matrix_is_the_wrench_of_lift_at_the_hub_and_force_at_the_tail(gp, gr, u_c, u_psi):
    lift = u_c * np.array([np.sin(gp) * np.cos(gr), -np.sin(gr), np.cos(gp) * np.cos(gr)])
    tail = np.array([0.0, -u_psi, 0.0])
    torque = np.cross([0, 0, XCELL.hub], lift) + np.cross([-XCELL.tail, 0, 0], tail)
    found = model.control_matrix(XCELL, gp, gr) @ [u_c, u_psi]
    assert found == pytest.approx(np.concatenate([torque, lift + tail]), abs=1e-12)


@pytest.mark.parametrize("machine", [XCELL, WINDY], ids=["paper", "drag and wind"])
def test_derivative_is_equations_7_and_8(machine):
    for state, control in zip(random_states(50), random_controls(50), strict=True):
        wanted = reference_derivative(machine, state, control)
        assert model.derivative(machine, state, control) == pytest.approx(wanted, abs=1e-11)


def test_steps_approach_the_derivative():
    state, control = random_states(1)[0], random_controls(1)[0]
    h = 1e-4
    ahead = model.simulate(WINDY, state, [control], dt=h)[1]
    slope = (ahead - state) / h
    wanted = model.derivative(WINDY, state, control)
    assert slope == pytest.approx(wanted, abs=5e-3 * (1 + np.abs(wanted).max()))


def test_torque_free_rotation_conserves_energy_and_angular_momentum():
    """The error over a fixed time must fall as the fourth power of the step."""
    start = random_states(1, seed=3)[0]
    start[10:] = 1.1, 1.4, -0.9
    J = np.array(XCELL.inertia)

    def drift(dt):
        states = model.simulate(XCELL, start, np.zeros((round(4.0 / dt), 4)), dt=dt)
        energy = 0.5 * (states[:, 10:] ** 2) @ J
        momentum = rotation(states).apply(J * states[:, 10:])
        return np.ptp(energy), np.abs(momentum - momentum[0]).max()

    coarse, fine = np.array(drift(0.04)), np.array(drift(0.02))
    assert (fine < 1e-8).all()
    assert (coarse / fine > 12.0).all()  # 16 for order 4; a quaternion left unscaled shows as 8


@given(st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_free_fall_is_a_parabola_however_the_body_tumbles(seed):
    start = random_states(1, seed)[0]
    start[10:] *= 0.3
    states = model.simulate(XCELL, start, np.zeros((50, 4)))
    t = 0.02 * np.arange(51)[:, None]
    parabola = start[:3] + model.world_velocity(start) * t + 0.5 * np.array([0, 0, -9.81]) * t**2
    assert np.abs(states[:, :3] - parabola).max() < 1e-7


def test_free_fall_without_rotation_is_exact():
    start = model.make_state((0, 0, 500), velocity=(12, -3, 2))
    states = model.simulate(XCELL, start, np.zeros((200, 4)), dt=0.05)
    t = 0.05 * np.arange(201)[:, None]
    parabola = start[:3] + np.array([12.0, -3.0, 2.0]) * t + 0.5 * np.array([0, 0, -9.81]) * t**2
    assert np.abs(states[:, :3] - parabola).max() < 1e-9


def test_hover_is_a_fixed_point():
    start = model.make_state((1, 2, 3), heading=2.0)
    assert np.abs(model.derivative(XCELL, start, HOVER)).max() < 1e-14
    assert np.abs(model.simulate(XCELL, start, np.tile(HOVER, (1000, 1))) - start).max() < 1e-11


def test_the_method_is_of_order_4():
    start, control = random_states(1, seed=5)[0], random_controls(1, seed=6, tilt=0.01)[0]
    control[1] *= 0.1

    def end(n):
        return model.simulate(WINDY, start, np.tile(control, (n, 1)), dt=1.0 / n)[-1]

    counts = np.array([25, 50, 100, 200])
    truth = end(6400)
    errors = np.array([np.linalg.norm(end(n) - truth) for n in counts])
    slope = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(4.0, abs=0.25)


def test_quaternions_keep_norm_1():
    states = model.simulate(XCELL, random_states(1)[0], random_controls(500))
    assert np.abs(np.linalg.norm(states[:, 3:7], axis=1) - 1.0).max() < 1e-15


@given(st.integers(0, 1000))
@settings(max_examples=20, deadline=None)
def test_a_mirrored_flight_is_the_flight_of_mirrored_inputs(seed):
    start, controls = random_states(1, seed)[0], random_controls(60, seed)
    flight = model.simulate(XCELL, start, controls)
    mirror = model.simulate(XCELL, mirrored_states(start), mirrored_controls(controls))
    scale = 1.0 + np.abs(flight).max()
    assert np.abs(mirror - mirrored_states(flight)).max() < 1e-12 * scale


def test_terminal_velocity_of_a_fall():
    """m v' = -m g - c v from rest: v = -(m g / c) (1 - exp(-c t / m))."""
    c = 4.0
    machine = Helicopter(drag=(c, c, c))
    states = model.simulate(machine, (0, 0, 1000), np.zeros((500, 4)))
    t = 0.02 * np.arange(501)
    wanted = -(machine.weight / c) * (1.0 - np.exp(-c * t / machine.mass))
    assert np.abs(states[:, 9] - wanted).max() < 1e-8
    assert np.abs(states[:, 7:9]).max() == 0.0


def test_drag_acts_along_the_bodys_axes():
    machine = Helicopter(drag=(1.0, 2.0, 3.0))
    moving = model.make_state((0, 0, 0), heading=1.0, velocity=(5.0, 4.0, 3.0))
    still = model.derivative(XCELL, moving, HOVER)
    slowed = model.derivative(machine, moving, HOVER)
    assert (slowed - still)[7:10] == pytest.approx(-np.array([5.0, 8.0, 9.0]) / machine.mass)
    assert (slowed - still)[10:] == pytest.approx(0.0)


def test_a_wind_that_moves_with_the_vehicle_cancels_drag():
    """Galilean invariance: in steady wind w the flight is that in calm air, carried along by w."""
    wind, drag = np.array([6.0, -2.0, 1.5]), (0.9, 1.3, 2.0)
    start, controls = random_states(1, seed=8)[0], random_controls(100, seed=9, tilt=0.02)
    calm = model.simulate(Helicopter(drag=drag), start, controls)
    carried = start.copy()
    carried[7:10] += rotation(start).inv().apply(wind)
    windy = model.simulate(Helicopter(drag=drag, wind=wind), carried, controls)
    t = 0.02 * np.arange(101)[:, None]
    # the two are equal to the error of the method, which sees other numbers: v includes the wind
    assert np.abs(windy[:, :3] - calm[:, :3] - wind * t).max() < 1e-4
    assert np.abs(windy[:, 3:7] - calm[:, 3:7]).max() < 1e-13
    assert np.abs(windy[:, 10:] - calm[:, 10:]).max() < 1e-13


def test_compiled_and_interpreted_steps_agree():
    script = (
        "import numpy as np; from ompl_risk.helicopter import model;"
        "from ompl_risk.helicopter.parameters import Helicopter;"
        "m = Helicopter(drag=(.7, 1.1, 1.6), wind=(4., -3., 1.));"
        "s = model.make_state((0, 0, 50), heading=.4, velocity=(15, 0, 1), rates=(.1, -.2, .3));"
        "print(model.simulate(m, s, [[85., .5, .04, -.03], [70., -1., 0., .1]] * 3)[-1].tolist())"
    )
    command = [sys.executable, "-c", script]
    runs = [
        subprocess.run(command, env=env, check=True, capture_output=True, text=True).stdout
        for env in (os.environ | {"NUMBA_DISABLE_JIT": "1"}, os.environ)
    ]
    plain, compiled = (np.array(json.loads(text)) for text in runs)
    assert plain == pytest.approx(compiled, rel=1e-14, abs=1e-14)


def test_make_state_puts_the_parts_in_place():
    state = model.make_state((1, 2, 3), heading=0.5, velocity=(4, 5, 6), rates=(7, 8, 9))
    assert state[[0, 1, 2, 7, 8, 9, 10, 11, 12]].tolist() == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    forward = rotation(state).apply([1, 0, 0])
    assert forward == pytest.approx([np.cos(0.5), np.sin(0.5), 0.0])
    assert not state.flags.writeable
    turned = model.make_state((0, 0, 0), orientation=(0.6, 0.0, 0.0, 0.8))
    assert turned[3:7].tolist() == [0.6, 0.0, 0.0, 0.8]
    assert model.make_state((0, 0, 0))[3:].tolist() == [0, 0, 0, 1, 0, 0, 0, 0, 0, 0]


def test_world_velocity_is_turned_by_the_attitude():
    for state in random_states(20):
        wanted = rotation(state).apply(state[7:10])
        assert model.world_velocity(state) == pytest.approx(wanted, abs=1e-13)


UPRIGHT = [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: model.make_state((1, 2)), r"position.shape = \(2,\)"),
        (lambda: model.make_state((1, 2, np.nan)), r"position\[2\] = nan: must be finite"),
        (lambda: model.make_state((0, 0, 0), heading=np.inf), "heading = inf"),
        (lambda: model.make_state((0, 0, 0), heading=1.0, orientation=UPRIGHT), "left out"),
        (lambda: model.make_state((0, 0, 0), orientation=(0, 0, 0, 1.1)), "norm is 1.1"),
        (lambda: model.make_state((0, 0, 0), velocity=(1, 2)), "velocity.shape"),
        (lambda: model.make_state((0, 0, 0), rates=5.0), "rates.shape"),
        (lambda: model.as_state("start", np.zeros(12)), r"start.shape = \(12,\)"),
        (lambda: model.as_state("start", np.zeros(13)), r"start\[3:7\] = .* norm is 0"),
        (lambda: model.derivative(XCELL, np.ones(13), HOVER), "norm is 2"),
        (lambda: model.derivative(XCELL, (0, 0, 0), HOVER[:3]), "control.shape"),
        (lambda: model.control_matrix(XCELL, np.nan, 0.0), "gamma_p = nan"),
        (lambda: model.control_matrix(XCELL, 0.0, "up"), "gamma_r = 'up'"),
        (lambda: model.simulate(XCELL, (0, 0, 0), HOVER), "controls.shape"),
        (lambda: model.simulate(XCELL, (0, 0, 0), [HOVER], dt=0.0), "dt = 0.0"),
        (lambda: model.simulate(XCELL, (0, 0, 0), [HOVER * np.nan]), "finite"),
    ],
)
def test_what_is_no_state_control_or_step_is_refused(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()
