"""Flights as OMPL's paths, and back."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.testing import assert_allclose
from ompl import base as ob
from ompl import control as oc
from scipy.spatial.transform import Rotation

from ompl_risk import Trajectory
from ompl_risk._kernels import rigid_body
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.bridge.controls import ControlBuffers, to_path_control
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flying import fly
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.spaces import control_space, propagator, state_space
from ompl_risk.helicopter.steering import HelicopterSteering

DT = 0.02
X_CELL = Helicopter()


@dataclass
class Flown:
    dt: float
    states: np.ndarray
    controls: np.ndarray


def box(count, size):
    bounds = ob.RealVectorBounds(count)
    bounds.setLow(-size)
    bounds.setHigh(size)
    return bounds


def rigid_body_setup(step=DT, propagate=None):
    """SE(3) x R^6 and four inputs; ``propagate(x, u, dt) -> x``, by default the helicopter."""
    pose, motion = ob.SE3StateSpace(), ob.RealVectorStateSpace(6)
    pose.setBounds(box(3, 1000.0))
    motion.setBounds(box(6, 100.0))
    space = ob.CompoundStateSpace()
    space.addSubspace(pose, 1.0)
    space.addSubspace(motion, 0.5)
    space.lock()
    controls = oc.RealVectorControlSpace(space, 4)
    controls.setBounds(box(4, 200.0))
    si = oc.SpaceInformation(space, controls)
    x, u = Buffer(13), Buffer(4)  # not ControlBuffers, which would keep si alive for ever

    def fly(x, u, dt):
        out = np.empty(13)
        rigid_body.propagate(x, u, dt, X_CELL.given, out)
        return out

    advance = fly if propagate is None else propagate

    def propagator(state, control, duration, result):
        space.serialize(x.capsule, state)
        controls.serialize(u.capsule, control)
        x.numbers[:] = advance(x.numbers.copy(), u.numbers.copy(), duration)
        space.deserialize(result, x.capsule)

    si.setStatePropagator(propagator)
    si.setPropagationStepSize(step)
    si.setMinMaxControlDuration(1, 100)
    si.setStateValidityChecker(lambda state: True)
    si.setup()
    return si


def flown(runs=(5, 1, 1, 40, 2), seed=4):
    """A flight whose inputs are held for so many steps."""
    rng = np.random.default_rng(seed)
    inputs = [X_CELL.weight, 0.0, 0.0, 0.0] + rng.normal(size=(len(runs), 4)) * [5, 0.5, 0.01, 0.01]
    controls = np.repeat(inputs, runs, axis=0)
    start = np.concatenate([[1 / 3, 20.0, 30.0, 0.0, 0.0, 0.6, 0.8], rng.normal(size=6)])
    states = np.empty((len(controls) + 1, 13))
    rigid_body.rollout(start, controls, DT, X_CELL.given, states)
    return Flown(DT, states, controls)


def test_inputs_that_are_held_become_one_control():
    si, flight = rigid_body_setup(), flown()
    path = to_path_control(si, flight)
    assert path.getControlCount() == 5
    assert_allclose(path.getControlDurations(), np.array([5, 1, 1, 40, 2]) * DT, rtol=1e-15)
    assert path.length() == pytest.approx(49 * DT)
    buffers = ControlBuffers(si)
    joints = [0, 5, 6, 7, 47, 49]
    states = np.array([buffers.read_state(state) for state in path.getStates()])
    assert (states == flight.states[joints]).all()
    controls = np.array([buffers.read_control(control) for control in path.getControls()])
    assert (controls == flight.controls[joints[:-1]]).all()


def test_the_path_checks_and_propagates_to_the_flight():
    si, flight = rigid_body_setup(), flown()
    path = to_path_control(si, flight)
    assert path.check()
    path.interpolate()
    buffers = ControlBuffers(si)
    states = np.array([buffers.read_state(state) for state in path.getStates()])
    assert (states == flight.states).all()


def test_a_path_that_meets_an_invalid_state_does_not_check():
    si, flight = rigid_body_setup(), flown()
    height = float(flight.states[30, 2])  # within a held input
    si.setStateValidityChecker(lambda state: state[0].getZ() != height)
    si.setup()
    assert not to_path_control(si, flight).check()


def test_a_propagator_of_finer_steps_will_do():
    """It integrates more finely: the same flight but for what that changes."""
    flight = flown()
    path = to_path_control(rigid_body_setup(step=DT / 2), flight)
    trajectory = Trajectory.from_path(path)
    assert len(trajectory) == 2 * len(flight.controls) + 1
    assert_allclose(trajectory.positions[::2], flight.states[:, :3], atol=1e-5)
    assert_allclose(trajectory.controls[::2], flight.controls, atol=1e-15)


def test_another_vehicle_does_not_check():
    heavy = Helicopter(9.0)

    def fly(x, u, dt):
        out = np.empty(13)
        rigid_body.propagate(x, u, dt, heavy.given, out)
        return out

    assert not to_path_control(rigid_body_setup(propagate=fly), flown()).check()


def test_a_flight_of_the_shipped_primitives_checks_in_the_helicopters_space():
    library = default_library()
    steering = HelicopterSteering(library)
    a = steering.vertex_at((0.0, 0.0, 100.0), 0.3, speed=20.0)
    b = steering.vertex_at((700.0, 200.0, 130.0), 1.2, speed=30.0)
    flight = fly(library, a, steering.connect(a, b).pieces)
    space = state_space([-100.0] * 3, [1000.0] * 3, library.limits)
    controls = control_space(space, library.helicopter, library.limits)
    si = oc.SpaceInformation(space, controls)
    si.setStatePropagator(propagator(space, controls, library.helicopter))
    si.setPropagationStepSize(library.dt)
    si.setMinMaxControlDuration(1, 100)
    si.setStateValidityChecker(space.satisfiesBounds)
    si.setup()
    path = to_path_control(si, flight)
    assert path.check()
    assert path.getControlCount() < len(flight)
    trajectory = Trajectory.from_path(path)
    assert_allclose(trajectory.positions, flight.states[:, :3], rtol=0.0, atol=0.0)
    assert_allclose(trajectory.velocities, flight.trajectory().velocities, atol=1e-12)


@pytest.mark.parametrize("step", [0.03, 0.04, 0.015])
def test_a_propagation_step_that_does_not_fit_is_named(step):
    with pytest.raises(ArgumentError, match=f"getPropagationStepSize.. = {step}"):
        to_path_control(rigid_body_setup(step=step), flown())


@pytest.mark.parametrize(
    ("field", "rows", "name"),
    [
        ("states", np.zeros((50, 12)), r"flight\.states\.shape"),
        ("controls", np.zeros((49, 3)), r"flight\.controls\.shape"),
        ("controls", np.zeros((48, 4)), r"len\(flight\.controls\) = 48"),
        ("controls", np.zeros((0, 4)), r"len\(flight\.controls\) = 0"),
    ],
)
def test_flights_that_do_not_fit_the_space_are_named(field, rows, name):
    flight = flown()
    setattr(flight, field, rows)
    with pytest.raises(ArgumentError, match=name):
        to_path_control(rigid_body_setup(), flight)


def test_a_path_reads_back_with_velocities_in_the_world():
    flight = flown()
    trajectory = Trajectory.from_path(to_path_control(rigid_body_setup(), flight), name="A")
    assert_allclose(trajectory.t, np.arange(50) * DT)
    assert (trajectory.positions == flight.states[:, :3]).all()
    assert_allclose(trajectory.orientations, flight.states[:, 3:7], atol=1e-15)
    assert (trajectory.controls == flight.controls).all()
    body = Rotation.from_quat(flight.states[:, 3:7])
    assert_allclose(trajectory.velocities, body.apply(flight.states[:, 7:10]), atol=1e-12)


def test_other_numbers_after_the_pose_are_not_taken_for_velocities():
    """Velocities in the world: the same space, another meaning."""

    def drift(x, u, dt):
        x[:3] += dt * x[7:10]
        return x

    si = rigid_body_setup(propagate=drift)
    states = np.tile([0.0, 0.0, 0.0, 0.0, 0.0, 0.6, 0.8, 3.0, 2.0, 1.0, 0.0, 0.0, 0.0], (11, 1))
    states[:, :3] += np.arange(11)[:, None] * DT * states[:, 7:10]
    path = to_path_control(si, Flown(DT, states, np.zeros((10, 4))))
    trajectory = Trajectory.from_path(path)
    assert trajectory.velocities is None
    assert_allclose(trajectory.positions, states[:, :3], atol=1e-12)


def test_buffers_write_what_they_read():
    buffers = ControlBuffers(rigid_body_setup())
    assert (buffers.width, buffers.control_width) == (13, 4)
    numbers, inputs = np.arange(13) / 3.0, np.arange(4) / 7.0
    assert (buffers.read_state(buffers.write_state(numbers)) == numbers).all()
    assert (buffers.read_control(buffers.write_control(inputs)) == inputs).all()
    state = buffers.write_state(numbers)
    assert (state[0].getX(), state[0].rotation().w, state[1][5]) == (0.0, 2.0, 4.0)
