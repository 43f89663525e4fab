"""Paths in and out of OMPL."""

import math

import numpy as np
import pytest
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og

from ompl_risk import (
    ClearanceValidityChecker,
    InverseDistance,
    Sobolev,
    TerrainClearance,
    Trajectory,
    publish,
    rank,
)
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain

FLAT = TerrainClearance(Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0)))


def geometric_path(si, positions):
    path = og.PathGeometric(si)
    for position in positions:
        state = si.allocState()
        state[0:3] = [float(x) for x in position]
        path.append(state)
    return path


def r3(size=100.0):
    space = ob.RealVectorStateSpace(3)
    space.setBounds(0.0, size)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(ClearanceValidityChecker(si, FLAT))
    si.setup()
    return si


def test_a_geometric_path_is_flown_at_constant_speed():
    path = geometric_path(r3(), [(0, 0, 5), (30, 40, 5), (30, 40, 65)])
    trajectory = Trajectory.from_path(path, speed=10.0, name="A")
    assert trajectory.t == pytest.approx([0, 5, 11])
    assert trajectory.positions == pytest.approx(np.array([[0, 0, 5], [30, 40, 5], [30, 40, 65]]))
    assert trajectory.name == "A"
    assert trajectory.orientations is None


def test_digits_beyond_what_ompl_prints_survive():
    path = geometric_path(r3(), [(1 / 3, 0, 5), (math.pi, 2 / 7, 5)])
    assert Trajectory.from_path(path, speed=1.0).positions[1].tolist() == [math.pi, 2 / 7, 5]


def se3_path(*steps):
    space = ob.SE3StateSpace()
    bounds = ob.RealVectorBounds(3)
    bounds.setLow(0.0)
    bounds.setHigh(100.0)
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    path = og.PathGeometric(si)
    for x, angle in steps:
        state = si.allocState()
        state.setXYZ(x, 0.0, 5.0)
        state.rotation().setAxisAngle(0.0, 0.0, 1.0, angle)
        path.append(state)
    return path


def test_se3_paths_keep_their_orientation():
    path = se3_path((0.0, 0.0), (10.0, 0.3), (10.0, 0.3), (20.0, 0.9))
    trajectory = Trajectory.from_path(path, speed=10.0)
    assert trajectory.t == pytest.approx([0, 1, 2])
    angles = 2 * np.arctan2(trajectory.orientations[:, 2], trajectory.orientations[:, 3])
    assert angles == pytest.approx([0.0, 0.3, 0.9])


def test_a_turn_on_the_spot_is_refused_rather_than_dropped():
    with pytest.raises(ArgumentError, match="turn on the spot after state 1"):
        Trajectory.from_path(se3_path((0.0, 0.0), (10.0, 0.3), (10.0, 0.6)), speed=10.0)


def control_setup(checker=True):
    space = ob.RealVectorStateSpace(3)
    space.setBounds(0.0, 100.0)
    controls = oc.RealVectorControlSpace(space, 2)
    bounds = ob.RealVectorBounds(2)
    bounds.setLow(-10.0)
    bounds.setHigh(10.0)
    controls.setBounds(bounds)
    setup = oc.SimpleSetup(controls)
    si = setup.getSpaceInformation()

    def propagate(state, control, duration, result):
        x, y, z = state[0], state[1], state[2]
        result[0], result[1], result[2] = x + control[0] * duration, y + control[1] * duration, z

    setup.setStatePropagator(propagate)
    si.setPropagationStepSize(0.5)
    si.setMinMaxControlDuration(1, 10)
    if checker:
        setup.setStateValidityChecker(ClearanceValidityChecker(si, FLAT))
    return setup


def test_a_control_path_has_its_own_time_and_controls():
    si = control_setup().getSpaceInformation()
    si.setup()
    path = oc.PathControl(si)
    for x, u, duration in ((10.0, 4.0, 1.5), (16.0, -2.0, 1.0)):
        state, control = si.allocState(), si.allocControl()
        state[0:3] = [x, 20.0, 5.0]
        control[0], control[1] = u, 0.0
        path.append(state, control, duration)
    state = si.allocState()
    state[0:3] = [14.0, 20.0, 5.0]
    path.append(state)
    trajectory = Trajectory.from_path(path)
    assert trajectory.t == pytest.approx([0, 0.5, 1, 1.5, 2, 2.5])
    assert trajectory.positions[:, 0] == pytest.approx([10, 12, 14, 16, 15, 14])
    assert trajectory.controls == pytest.approx(
        np.array([[4, 0], [4, 0], [4, 0], [-2, 0], [-2, 0]])
    )
    assert path.getStateCount() == 3  # the caller's path is left alone


def test_a_control_planner_stays_free_and_within_bounds():
    setup = control_setup()
    si = setup.getSpaceInformation()
    start, goal = si.allocState(), si.allocState()
    start[0:3], goal[0:3] = [5.0, 5.0, 5.0], [90.0, 90.0, 5.0]
    setup.setStartAndGoalStates(start, goal, 5.0)
    setup.setPlanner(oc.RRT(si))
    assert setup.solve(5.0)
    trajectory = Trajectory.from_path(setup.getSolutionPath())
    assert trajectory.positions.min() >= 0.0
    assert trajectory.positions.max() <= 100.0
    assert FLAT(trajectory.positions).min() > 0.0


def test_the_checker_enforces_bounds_in_control_spaces():
    si = control_setup().getSpaceInformation()
    state = si.allocState()
    state[0:3] = [50.0, 50.0, 120.0]
    assert not si.getStateValidityChecker().isValid(state)
    state[0:3] = [50.0, 50.0, 20.0]
    assert si.getStateValidityChecker().isValid(state)


@pytest.mark.parametrize(
    ("call", "names"),
    [
        (lambda p, c: Trajectory.from_path(p), "speed = None"),
        (lambda p, c: Trajectory.from_path(p, speed=-1.0), "speed = -1.0"),
        (lambda p, c: Trajectory.from_path(c, speed=3.0), "speed = 3.0"),
        (lambda p, c: Trajectory.from_path("path", speed=3.0), "'str'"),
    ],
)
def test_bad_paths_are_named(call, names):
    controlled = oc.PathControl(control_setup().getSpaceInformation())
    with pytest.raises(ArgumentError) as error:
        call(geometric_path(r3(), [(0, 0, 5), (9, 9, 9)]), controlled)
    assert names in str(error.value)


def test_a_planar_path_is_refused():
    space = ob.RealVectorStateSpace(2)
    space.setBounds(0.0, 1.0)
    si = ob.SpaceInformation(space)
    path = og.PathGeometric(si)
    for x in (0.0, 1.0):
        state = si.allocState()
        state[0:2] = [x, x]
        path.append(state)
    with pytest.raises(ArgumentError, match=r"si\.setup\(\)"):
        Trajectory.from_path(path, speed=1.0)
    si.setStateValidityChecker(lambda state: True)
    si.setup()
    with pytest.raises(ArgumentError, match=r"R\^2"):
        Trajectory.from_path(path, speed=1.0)


def published(heights, labels=None):
    si = r3()
    problem = ob.ProblemDefinition(si)
    detour = {3.0: 0.0, 6.0: 20.0, 9.0: 10.0}
    paths = [
        geometric_path(si, [(0, 50, 30), (50, 50 + detour[z], z), (100, 50, 30)]) for z in heights
    ]
    trajectories = [
        Trajectory.from_path(p, speed=10.0, name=f"{z:g} m")
        for p, z in zip(paths, heights, strict=True)
    ]
    ranking = rank(trajectories, FLAT, InverseDistance(20.0), [Sobolev(1)], duration_tolerance=1.0)
    publish(problem, paths, ranking, labels)
    return problem


@pytest.mark.parametrize("heights", [(3.0, 6.0, 9.0), (9.0, 3.0, 6.0), (6.0, 9.0, 3.0)])
def test_the_safest_published_path_comes_first(heights):
    problem = published(heights)
    assert problem.getSolutionCount() == 3
    assert problem.hasExactSolution()
    assert problem.getSolutionPath().getStates()[1][2] == 9.0


def test_publishing_refuses_what_does_not_match():
    with pytest.raises(ArgumentError, match="label = 'H7'"):
        published((3.0, 6.0, 9.0), "H7")
