import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from ompl_risk._kernels import rigid_body
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.trims import Trim, solve_trim

X_CELL = Helicopter()
G = X_CELL.gravity
DRAGGED = Helicopter(drag=(0.4, 1.1, 0.7))

numbers = st.floats
vehicles = st.builds(
    lambda mass, a, b, c, hub, tail, drag: Helicopter(
        mass, inertia=(a + b, b + c, c + a), hub=hub, tail=tail, drag=drag
    ),
    numbers(1.0, 30.0),
    *[numbers(0.02, 0.5)] * 3,
    numbers(0.1, 0.5),
    numbers(0.3, 2.0),
    st.tuples(*[numbers(0.0, 2.0)] * 3),
)
motions = st.tuples(numbers(0.0, 35.0), numbers(-8.0, 8.0), numbers(-0.9, 0.9))


def newton_euler(helicopter: Helicopter, trim: Trim) -> np.ndarray:
    """Imbalance of momentum and of angular momentum per inertia, all in the world's frame."""
    R = Rotation.from_quat(trim.orientation).as_matrix()
    u_c, u_psi, gp, gr = trim.control
    tilt = [math.sin(gp) * math.cos(gr), -math.sin(gr), math.cos(gp) * math.cos(gr)]
    lift, tail = u_c * np.array(tilt), np.array([0.0, -u_psi, 0.0])
    torque = np.cross([0, 0, helicopter.hub], lift) + np.cross([-helicopter.tail, 0, 0], tail)
    velocity, spin = np.array([trim.speed, 0, trim.climb]), np.array([0, 0, trim.turn])
    drag = R @ np.diag(helicopter.drag) @ R.T @ velocity
    weight = helicopter.weight * np.array([0, 0, 1])
    force = R @ (lift + tail) - drag - weight
    J = R @ np.diag(helicopter.inertia) @ R.T  # about the world's axes
    return np.concatenate([
        force / helicopter.mass - np.cross(spin, velocity),
        np.linalg.solve(J, R @ torque - np.cross(spin, J @ spin)),
    ])  # fmt: skip


@settings(deadline=None, max_examples=60)
@given(vehicles, motions)
def test_momentum_and_angular_momentum_balance_in_the_world_frame(helicopter, motion):
    trim = solve_trim(helicopter, *motion)
    assert trim.residual <= 1e-10
    assert np.abs(newton_euler(helicopter, trim)).max() <= 1e-9
    R = Rotation.from_quat(trim.orientation).as_matrix()
    np.testing.assert_allclose(R @ trim.velocity, [motion[0], 0.0, motion[1]], atol=1e-13)
    np.testing.assert_allclose(R @ trim.rates, [0.0, 0.0, motion[2]], atol=1e-14)


@pytest.mark.parametrize("helicopter", [X_CELL, DRAGGED], ids=["vacuum", "drag"])
@pytest.mark.parametrize(
    "motion",
    [
        (0, 0, 0),
        (0, 2, 0.8),
        (0, -2, -0.3),
        (10, 0, 0),
        (10, 0, 0.82),
        (20, -6, -0.4),
        (30, 6, 0.27),
    ],
)
def test_ten_seconds_in_trim_are_the_exact_helix(helicopter, motion):
    trim = solve_trim(helicopter, *motion, Limits())
    position, heading, duration = np.array([5.0, -3.0, 40.0]), 2.1, 10.0
    end = np.empty(13)
    start, steps = trim.state(position, heading), 5000
    rigid_body.hold(start, trim.control, duration / steps, steps, helicopter.given, end)
    x, y, z, turned = trim.displacement(duration)
    c, s = math.cos(heading), math.sin(heading)
    wanted = trim.state(position + np.array([c * x - s * y, s * x + c * y, z]), heading + turned)
    wanted[3:7] *= np.sign(wanted[3:7] @ end[3:7])
    np.testing.assert_allclose(end, wanted, rtol=0, atol=2e-10)


@given(numbers(0.0, 30.0), numbers(-5.0, 5.0), numbers(-0.5, 0.5), numbers(0.0, 20.0))
@settings(deadline=None, max_examples=40)
def test_displacement_is_the_integral_of_the_velocity(speed, climb, turn, duration):
    trim = solve_trim(X_CELL, speed, climb, turn)
    x = quad(lambda t: speed * math.cos(turn * t), 0.0, duration)[0]
    y = quad(lambda t: speed * math.sin(turn * t), 0.0, duration)[0]
    wanted = [x, y, climb * duration, turn * duration]
    np.testing.assert_allclose(trim.displacement(duration), wanted, atol=1e-8)


def test_hover_level_flight_and_climb_need_the_weight_alone():
    for motion in [(0, 0, 0), (0, 0, 0.8), (0, 2, 0), (30, 0, 0), (20, -6, 0)]:
        trim = solve_trim(X_CELL, *motion)
        assert trim.control.tolist() == [X_CELL.weight, 0.0, 0.0, 0.0]
        assert trim.orientation.tolist() == [0.0, 0.0, 0.0, 1.0]
        assert trim.velocity.tolist() == [motion[0], 0.0, motion[1]]


@pytest.mark.parametrize("turn", [0.05, 0.3, -0.3, 0.8])
@pytest.mark.parametrize("climb", [0.0, 4.0])
def test_coordinated_bank_without_gyroscopic_torque(turn, climb):
    round_body = Helicopter(inertia=(0.18, 0.3, 0.3))
    trim = solve_trim(round_body, 12.0, climb, turn)
    assert math.tan(-trim.roll) == pytest.approx(12.0 * turn / G, rel=1e-12)
    assert trim.control[0] == pytest.approx(8.2 * math.hypot(G, 12.0 * turn), rel=1e-12)
    np.testing.assert_allclose(trim.control[1:], 0.0, atol=1e-15)
    assert trim.pitch == 0.0


def test_rotor_and_tail_balance_the_gyroscopic_torque():
    trim = solve_trim(DRAGGED, 10.0, 2.0, 0.8)
    u_c, u_psi, gp, gr = trim.control
    o1, o2, o3 = trim.rates
    j1, j2, j3 = DRAGGED.inertia
    torques = [
        DRAGGED.hub * u_c * math.sin(gr),
        DRAGGED.hub * u_c * math.sin(gp) * math.cos(gr),
        DRAGGED.tail * u_psi,
    ]
    wanted = [(j3 - j2) * o2 * o3, (j1 - j3) * o3 * o1, (j2 - j1) * o1 * o2]
    np.testing.assert_allclose(torques, wanted, rtol=1e-10)
    assert min(np.abs(wanted)) > 1e-4


def test_drag_in_straight_flight():
    level = solve_trim(DRAGGED, 25.0)
    assert math.tan(level.pitch) == pytest.approx(0.4 * 25.0 / DRAGGED.weight, rel=1e-12)
    climbing = solve_trim(DRAGGED, 0.0, 5.0)
    assert climbing.control[0] == pytest.approx(DRAGGED.weight + 0.7 * 5.0, rel=1e-14)


def test_steps_that_overshoot_do_not_wind_up_the_attitude():
    falling = Helicopter(1.0, inertia=(1.0, 1.0, 1.0), hub=0.5, tail=1.0, drag=(1.0, 0.0, 2.0))
    trim = solve_trim(falling, 1.0, -5.0)  # drag carries nearly the whole weight
    assert abs(trim.pitch) < math.pi / 2
    assert trim.orientation[3] > 0.0


@settings(deadline=None, max_examples=40)
@given(vehicles, numbers(0.0, 35.0), numbers(-8.0, 8.0))
def test_straight_trims_are_exactly_within_their_plane(helicopter, speed, climb):
    trim = solve_trim(helicopter, speed, climb)
    lateral = [*trim.orientation[[0, 2]], trim.velocity[1], *trim.rates, *trim.control[[1, 3]]]
    assert lateral == [0.0] * 8
    assert not np.signbit(np.concatenate([trim.state()[:3], lateral])).any()


@settings(deadline=None, max_examples=40)
@given(vehicles, motions)
def test_mirror_image_is_the_trim_of_the_turn_to_the_other_side(helicopter, motion):
    speed, climb, turn = motion
    mirrored = solve_trim(helicopter, *motion).mirrored()
    solved = solve_trim(helicopter, speed, climb, -turn)
    assert mirrored.key == solved.key
    for name in ("orientation", "velocity", "rates", "control"):
        a, b = getattr(mirrored, name), getattr(solved, name)
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-12, err_msg=name)
        assert not a.flags.writeable
        np.testing.assert_array_equal(getattr(mirrored.mirrored().mirrored(), name), a)


@given(numbers(-4.0, 4.0))
def test_state_points_and_flies_to_the_heading(heading):
    trim = solve_trim(DRAGGED, 15.0, 1.0, 0.3)
    state = trim.state([1.0, 2.0, 3.0], heading)
    R = Rotation.from_quat(state[3:7]).as_matrix()
    world = R @ state[7:10]
    assert state[:3].tolist() == [1.0, 2.0, 3.0]
    assert np.linalg.norm(state[3:7]) == pytest.approx(1.0, abs=1e-15)
    flown = [15 * math.cos(heading), 15 * math.sin(heading), 1.0]
    np.testing.assert_allclose(world, flown, atol=1e-13)
    np.testing.assert_allclose(
        R[:2, 0] / np.hypot(*R[:2, 0]), [math.cos(heading), math.sin(heading)], atol=1e-15
    )
    np.testing.assert_array_equal(trim.state()[3:7], trim.orientation)


def test_roll_and_pitch_are_the_angles_of_the_attitude():
    trim = solve_trim(DRAGGED, 22.0, -3.0, 0.4)
    psi, theta, phi = Rotation.from_quat(trim.orientation).as_euler("ZYX")
    assert (trim.roll, trim.pitch) == pytest.approx((phi, theta), abs=1e-15)
    assert psi == pytest.approx(0.0, abs=1e-15)
    assert trim.roll < 0.0 < trim.pitch


@pytest.mark.parametrize(
    ("motion", "limits", "named"),
    [
        ((20, 0, 0.9), Limits(), r"attitude 1\.07\d+, not 0 to 1 rad|attitude"),
        ((30, 0, 0), Limits(speed=29.0), r"speed 30, not 0 to 29 m/s"),
        ((28, 8, 0), Limits(speed=29.0), r"speed 29\.1204, not 0 to 29 m/s"),
        ((20, 0, 0.8), Limits(lift=(0.2, 1.5)), r"collective 153\.\d+, not 16\.0884 to 120\.663 N"),
        ((0, 0, 1.5), Limits(rate=1.2), r"angular velocity 1\.5, not 0 to 1\.2 rad/s"),
        ((10, 0, 0.8), Limits(tilt=1e-4), r"rotor roll 0\.000\d+, not -0\.0001 to 0\.0001 rad"),
    ],
)
def test_a_trim_that_breaks_a_limit_is_refused_by_name(motion, limits, named):
    limits = Limits(attitude=1.0) if "attitude" in named else limits
    with pytest.raises(ArgumentError, match=named) as caught:
        solve_trim(X_CELL, *motion, limits)
    assert caught.value.value == motion
    solve_trim(X_CELL, *motion)  # without limits it exists


def test_yaw_force_limit():
    strong_wind_of_flight = Helicopter(drag=(2.0, 2.0, 2.0))
    with pytest.raises(ArgumentError, match=r"yaw force 0\.0\d+, not -0\.001 to 0\.001 N"):
        solve_trim(strong_wind_of_flight, 20.0, 0.0, 0.4, Limits(yaw_force=0.001))


def test_a_limit_that_is_just_met_is_kept():
    trim = solve_trim(X_CELL, 20.0, 0.0, 0.5)
    attitude = math.acos(math.cos(trim.roll) * math.cos(trim.pitch))
    kept = solve_trim(X_CELL, 20.0, 0.0, 0.5, Limits(attitude=attitude, speed=20.0))
    assert kept.roll == trim.roll


@pytest.mark.parametrize("motion", [(1e200, 0.0, 1e200), (10.0, 0.0, 1e7)])
def test_a_motion_without_a_trim_is_refused(motion):
    with pytest.raises(ArgumentError, match="a motion that has a trim; the best leaves"):
        solve_trim(X_CELL, *motion)


def test_descent_carried_by_the_air_alone():
    sinking = Helicopter(drag=(0.0, 0.0, X_CELL.weight / 8.0))
    assert solve_trim(sinking, 0.0, -8.0).control[0] == 0.0
    with pytest.raises(ArgumentError, match="collective 0, not 16"):
        solve_trim(sinking, 0.0, -8.0, limits=Limits())


@pytest.mark.parametrize(
    ("given_motion", "name"),
    [
        ((-1.0, 0.0, 0.0), "speed"),
        ((math.nan, 0.0, 0.0), "speed"),
        ((math.inf, 0.0, 0.0), "speed"),
        (("fast", 0.0, 0.0), "speed"),
        ((True, 0.0, 0.0), "speed"),
        ((10.0, math.inf, 0.0), "climb"),
        ((10.0, 0.0, math.nan), "turn"),
        ((10.0, 0.0, None), "turn"),
    ],
)
def test_wrong_motions(given_motion, name):
    with pytest.raises(ArgumentError) as caught:
        solve_trim(X_CELL, *given_motion)
    assert caught.value.argument == name


def test_wind_is_refused():
    with pytest.raises(ArgumentError, match=r"helicopter\.wind.*still air"):
        solve_trim(Helicopter(wind=(3.0, 0.0, 0.0)), 10.0)


@pytest.mark.parametrize("position", [[1.0, 2.0], [[1.0, 2.0, 3.0]], 1.0])
def test_position_of_another_shape(position):
    with pytest.raises(ArgumentError, match=r"position\.shape"):
        solve_trim(X_CELL, 10.0).state(position)


def test_solved_arrays_are_read_only():
    trim = solve_trim(X_CELL, 10.0, turn=0.2)
    for name in ("orientation", "velocity", "rates", "control"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(trim, name)[0] = 1.0


@settings(deadline=None, max_examples=30)
@given(vehicles, motions)
def test_derivatives_of_the_equations_by_differences(helicopter, motion):
    from ompl_risk.helicopter.equilibrium import _accelerations

    speed, climb, turn = motion
    columns = np.array([[speed, 0, 0], [0, speed * turn, 0], [climb, G, turn]], dtype=float)
    at = np.array([0.3, -0.2, 1.1 * helicopter.weight, 0.4, 0.05, -0.07])
    slopes = _accelerations(helicopter, columns, at)[1]
    for k in range(6):
        nudge = np.zeros(6)
        nudge[k] = 1e-5 * max(1.0, abs(at[k]))
        ahead, behind = (_accelerations(helicopter, columns, at + s * nudge)[0] for s in (1, -1))
        difference = (ahead - behind) / (2.0 * nudge[k])
        assume(np.isfinite(difference).all())
        np.testing.assert_allclose(
            slopes[:, k], difference, rtol=1e-6, atol=1e-6 * np.abs(slopes).max()
        )
