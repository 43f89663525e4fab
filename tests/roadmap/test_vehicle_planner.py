"""RiskRoadmap with a helicopter's steering in oc.SimpleSetup: PathControls that OMPL can replay."""

import numpy as np
import pytest
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og

from ompl_risk import RiskObjective, Sobolev, TerrainClearance, Trajectory, helicopter, terrains
from ompl_risk.bridge.states import StateReader
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter import HelicopterSteering
from ompl_risk.planners import RiskRoadmap

START, GOAL = (400.0, 1000.0, 80.0), (2600.0, 1000.0, 80.0)
LOW, HIGH = (0.0, 0.0, -1.0), (3000.0, 2000.0, 160.0)


@pytest.fixture(scope="module")
def clearance():
    """A ridge across the way, higher than the box but for a gap."""
    x, y = np.meshgrid(np.arange(0.0, 3001.0, 50.0), np.arange(0.0, 2001.0, 50.0))
    ridge = 250.0 * np.exp(-(((x - 1500.0) / 150.0) ** 2))
    gap = 1.0 - np.exp(-(((y - 500.0) / 200.0) ** 2))
    return TerrainClearance(terrains.Terrain(ridge * gap, spacing=(50.0, 50.0)), 2.0, threads=1)


def set_up(clearance, start=START, goal=GOAL, slack=None, **options):
    steering = HelicopterSteering()
    if slack is not None:
        steering.slack = slack
    setup = helicopter.simple_setup(clearance, start=start, goal=goal, low=LOW, high=HIGH)
    si = setup.getSpaceInformation()
    options = {"seed": 1, "iterations": 400, "threads": 1, **options}
    planner = RiskRoadmap(si, steering=steering, **options)
    setup.setPlanner(planner)
    return setup, planner


@pytest.fixture(scope="module")
def solved(clearance):
    setup, planner = set_up(clearance)
    status = setup.solve(60.0)
    assert status.getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    return setup, planner


def numbers(si, states):
    reader = StateReader(si.getStateSpace())
    buffer = np.empty(13)
    read, rows = reader.into(buffer), []
    for state in states:
        read(state)
        rows.append(buffer.copy())
    return np.array(rows)


def test_solution_is_a_path_control_that_ompl_finds_valid(solved):
    setup, _ = solved
    path = setup.getProblemDefinition().getSolutionPath()
    assert isinstance(path, oc.PathControl)
    assert path.check()
    assert setup.haveExactSolutionPath()


def test_solution_leads_from_the_start_to_the_goal(solved):
    setup, _ = solved
    path = setup.getProblemDefinition().getSolutionPath()
    rows = numbers(setup.getSpaceInformation(), path.getStates())
    np.testing.assert_allclose(rows[0, :3], START, atol=1e-12)
    np.testing.assert_allclose(rows[-1, :3], GOAL, atol=0.3)
    assert setup.getGoal().isSatisfied(path.getState(path.getStateCount() - 1))


def test_ompl_propagates_the_controls_to_the_states(solved):
    setup, _ = solved
    si = setup.getSpaceInformation()
    path = setup.getProblemDefinition().getSolutionPath()
    states, controls = path.getStates(), path.getControls()
    durations, step = path.getControlDurations(), si.getPropagationStepSize()
    state = si.allocState()
    si.copyState(state, states[0])
    for control, duration in zip(controls, durations, strict=True):
        si.propagate(state, control, round(duration / step), state)
    reached = numbers(si, [state])[0]
    last = numbers(si, [path.getState(path.getStateCount() - 1)])[0]
    np.testing.assert_allclose(reached, last, atol=1e-9)


def test_flown_trajectory_keeps_clear_and_is_as_risky_as_the_planner_says(solved, clearance):
    setup, planner = solved
    trajectory = Trajectory.from_path(setup.getProblemDefinition().getSolutionPath())
    d = clearance(trajectory.positions)
    assert d.min() > 0.0
    objective = setup.getProblemDefinition().getOptimizationObjective()
    f = objective.risk.avoidance(d)
    route = planner.roadmap.best
    assert Sobolev(1)(trajectory.t, f) ** 2 == pytest.approx(route.risk, rel=0.03)
    assert trajectory.duration == pytest.approx(route.duration, abs=0.1)
    speeds = np.linalg.norm(trajectory.velocities, axis=1)
    assert speeds.max() == pytest.approx(planner.roadmap.risk.speed, rel=0.05)


def test_history_and_compiled(solved):
    _, planner = solved
    costs = [row.cost for row in planner.history]
    assert costs == sorted(costs, reverse=True)
    assert planner.compiled
    assert planner.reason == ""


def test_alternatives_can_be_published(solved):
    setup, planner = solved
    routes = planner.alternatives(3, excess=0.5, min_distance=50.0)
    assert len(routes) >= 2
    planner.publish(routes)
    problem = setup.getProblemDefinition()
    assert problem.getSolutionCount() == len(routes)
    first = Trajectory.from_path(problem.getSolutionPath())
    assert first.duration == pytest.approx(routes[0].duration, abs=0.1)


def test_same_seed_and_iterations_give_the_same_route(clearance, solved):
    _, before = solved
    setup, planner = set_up(clearance)
    setup.solve(60.0)
    np.testing.assert_array_equal(planner.roadmap.best.states, before.roadmap.best.states)


def test_path_length_is_duration_and_risk_counts_only_in_collision(clearance):
    setup, planner = set_up(clearance)
    si = setup.getSpaceInformation()
    setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(si))
    setup.solve(60.0)
    route = planner.roadmap.best
    assert route.cost == pytest.approx(route.duration, rel=1e-9)
    assert route.duration == pytest.approx(planner.roadmap.fastest().duration, rel=1e-9)


def test_a_start_in_flight_is_a_vertex(clearance):
    steering = HelicopterSteering()
    state = steering.state(steering.vertex_at(START, 0.3, speed=20.0))
    setup, _ = set_up(clearance, start=state)
    assert setup.solve(60.0)
    rows = numbers(
        setup.getSpaceInformation(), setup.getProblemDefinition().getSolutionPath().getStates()
    )
    np.testing.assert_allclose(rows[0], state, atol=1e-9)


def test_a_start_that_is_no_trim_is_refused(clearance):
    steering = HelicopterSteering()
    state = steering.state(steering.vertex_at(START, 0.0, speed=20.0)).copy()
    state[7] = 23.0
    setup, _ = set_up(clearance, start=state)
    with pytest.raises(ArgumentError, match="23"):
        setup.solve(1.0)


def test_another_space_is_refused():
    space = ob.RealVectorStateSpace(3)
    space.setBounds(0.0, 100.0)
    setup = og.SimpleSetup(space)
    si = setup.getSpaceInformation()
    start, goal = si.allocState(), si.allocState()
    start[0:3], goal[0:3] = [10.0, 10.0, 10.0], [90.0, 90.0, 10.0]
    setup.setStartAndGoalStates(start, goal)
    setup.setPlanner(RiskRoadmap(si, steering=HelicopterSteering()))
    with pytest.raises(ArgumentError, match="simple_setup"):
        setup.solve(1.0)


def test_a_checker_of_the_users_own_is_refused(clearance):
    class Own(ob.StateValidityChecker):
        def isValid(self, state):
            return True

    setup, _ = set_up(clearance)
    setup.setStateValidityChecker(Own(setup.getSpaceInformation()))
    with pytest.raises(ArgumentError, match=r"getStateValidityChecker.*Own"):
        setup.solve(1.0)


def test_a_wider_obstacle_than_the_objectives_is_kept_clear_of(clearance):
    """The objective knows a body of 2 m, the checker one of 40 m."""
    setup, planner = set_up(clearance)
    si = setup.getSpaceInformation()
    wide = clearance.with_radius(40.0)
    envelope = setup.getStateValidityChecker().envelope
    setup.setStateValidityChecker(helicopter.HelicopterValidityChecker(si, wide, envelope))
    setup.setOptimizationObjective(RiskObjective(si, clearance, speed=30.0))
    assert setup.solve(60.0)
    states = planner.roadmap.best.states[:, :3]
    assert wide(np.ascontiguousarray(states)).min() > 0.5 - 2e-3


def fastest_ways(clearance, slack, seeds):
    """Positions along the fastest way that each seed finds."""
    for seed in seeds:
        setup, planner = set_up(clearance, slack=slack, seed=seed, iterations=700)
        si = setup.getSpaceInformation()
        setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(si))
        assert setup.solve(60.0)
        yield np.ascontiguousarray(planner.roadmap.best.states[:, :3])


@pytest.mark.parametrize("slack", [0.0, 20.0])
def test_connections_keep_the_slack_of_a_flight(slack, clearance):
    """To obstacles and to the sides of the box; the fastest ways use what room they have."""
    ways = list(fastest_ways(clearance, slack, range(1, 9)))
    nearest = min(clearance(way).min() for way in ways)
    room = min(min((way - LOW).min(), (HIGH - way).min()) for way in ways)
    assert nearest >= slack - 2e-3
    assert room >= slack - 1e-9
    assert (nearest < 20.0 and room < 20.0) == (slack == 0.0)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"helicopter": helicopter.Helicopter(9.0)}, "steering.*beside.*optimal_control"),
        ({"limits": helicopter.Limits(speed=15.0)}, r"speed 30\.\d+, not 0 to 15 m/s"),
        ({"limits": helicopter.Limits(tilt=0.05)}, "rotor pitch 0.18, not -0.05 to 0.05"),
        ({"step": 0.01}, r"getPropagationStepSize\(\) = 0.01.*0.02 s"),
    ],
)
def test_a_vehicle_that_the_steering_was_not_made_for_is_refused(options, says, clearance):
    setup = helicopter.simple_setup(
        clearance, start=START, goal=GOAL, low=LOW, high=HIGH, **options
    )
    planner = RiskRoadmap(setup.getSpaceInformation(), steering=HelicopterSteering())
    setup.setPlanner(planner)
    with pytest.raises(ArgumentError, match=says):
        setup.solve(1.0)


def test_routes_become_trajectories_that_can_be_ranked(solved):
    _, planner = solved
    for route in planner.alternatives(2, excess=0.5, min_distance=50.0):
        trajectory = Trajectory.from_path(planner.path(route))
        assert trajectory.duration == pytest.approx(route.duration, abs=0.1)
        np.testing.assert_allclose(trajectory.positions[-1], GOAL, atol=0.3)
