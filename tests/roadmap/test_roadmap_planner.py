"""RiskRoadmap as OMPL's users meet it: SimpleSetup, goals, conditions, faults."""

import itertools
import math
import time
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from ompl import base as ob
from ompl import geometric as og
from ompl import tools as ot
from scene import CEILING, D0, SPEED, box, ends, hills

from ompl_risk.avoidance import InverseDistance
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.bridge.states import StateWriter
from ompl_risk.clearance import MeshClearance, TerrainClearance, UnionClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Connection, Steering
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory


def space_of(terrain, kind=ob.RealVectorStateSpace):
    space = kind(3) if kind is ob.RealVectorStateSpace else kind()
    bounds = ob.RealVectorBounds(3)
    for k, (low, high) in enumerate(zip(*box(terrain), strict=True)):
        bounds.setLow(k, float(low))
        bounds.setHigh(k, float(high))
    space.setBounds(bounds)
    return space


class Scene:
    """A SimpleSetup over hills with a RiskRoadmap."""

    def __init__(self, terrain=None, clearance=None, *, kind=ob.RealVectorStateSpace, **options):
        self.terrain = hills() if terrain is None else terrain
        self.clearance = clearance or TerrainClearance(self.terrain, 2.0)
        self.setup = og.SimpleSetup(space_of(self.terrain, kind))
        self.si = self.setup.getSpaceInformation()
        planner_options = {"seed": options.pop("seed", 1)}
        if "steering" in options:
            planner_options["steering"] = options.pop("steering")
        if not options.pop("bare", False):
            self.setup.setStateValidityChecker(ClearanceValidityChecker(self.si, self.clearance))
            self.si.setMotionValidator(ClearanceMotionValidator(self.si, self.clearance))
        if not options.pop("no_objective", False):
            self.objective = RiskObjective(
                self.si, self.clearance, InverseDistance(D0), **{"speed": SPEED, **options}
            )
            self.setup.setOptimizationObjective(self.objective)
        self.planner = RiskRoadmap(self.si, **planner_options)
        self.setup.setPlanner(self.planner)

    def state(self, numbers):
        return StateWriter(self.si).state(np.asarray(numbers, dtype=float))

    def between(self, start, goal):
        self.setup.setStartAndGoalStates(self.state(start), self.state(goal))
        return self

    def usual(self):
        return self.between(*ends(self.terrain))

    def solve(self, condition=0.3):
        return self.setup.solve(condition)

    @property
    def path(self):
        return self.setup.getProblemDefinition().getSolutionPath()

    @property
    def cost(self):
        return self.path.cost(self.objective).value()


def once(reached):
    """A condition that waits for progress, not for the clock."""
    limit = time.monotonic() + 60.0
    return ob.PlannerTerminationCondition(lambda: reached() or time.monotonic() > limit)


def found(scene):
    return once(lambda: len(scene.planner.history) > 0)


@pytest.mark.parametrize(
    "norm", [Lp(1), Lp(2), Lp(4), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)],
    ids=lambda norm: norm.label,
)  # fmt: skip
def test_a_solution_is_valid_exact_and_costs_what_the_planner_says(norm):
    scene = Scene(norm=norm).usual()
    assert scene.solve().getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert scene.path.check()
    assert scene.cost == pytest.approx(scene.planner.history[-1].cost, rel=1e-3)
    start, goal = ends(scene.terrain)
    states = [s[0:3] for s in scene.path.getStates()]
    assert states[0] == start.tolist()
    assert states[-1] == goal.tolist()
    path = Trajectory.from_path(scene.path, speed=SPEED).densify(0.1)
    assert scene.clearance(path.positions).min() > 0.0
    assert scene.planner.compiled


def test_it_does_better_than_rrt_star():
    ours, theirs = Scene().usual(), Scene().usual()
    theirs.setup.setPlanner(og.RRTstar(theirs.si))
    for scene in (ours, theirs):
        scene.solve(1.0)
    assert ours.cost < theirs.cost


def test_history_falls_and_counts():
    scene = Scene().usual()
    scene.solve()
    history = scene.planner.history
    costs = [row.cost for row in history]
    assert costs == sorted(costs, reverse=True)
    assert [row.seconds for row in history] == sorted(row.seconds for row in history)
    assert all(0 < row.evaluated < row.edges for row in history)


def test_a_second_solve_goes_on_from_the_first():
    scene = Scene().usual()
    scene.solve(found(scene))
    n, first = scene.planner.roadmap.n, scene.cost
    scene.solve(once(lambda: scene.planner._roadmap.n >= 3 * n))
    assert scene.planner.roadmap.n >= 3 * n
    assert scene.cost <= first
    assert scene.setup.getProblemDefinition().getSolutionCount() >= 1
    seconds = [row.seconds for row in scene.planner.history]
    assert seconds == sorted(seconds)


def test_clear_forgets():
    scene = Scene().usual()
    scene.solve()
    scene.setup.clear()
    assert scene.planner.history == []
    assert scene.planner.roadmap is None
    assert scene.solve().getStatus() == ob.PlannerStatus.EXACT_SOLUTION


def test_the_condition_ends_it_and_the_best_is_kept():
    scene = Scene().usual()
    asked = []

    def condition():
        asked.append(time.monotonic())
        return len(asked) > 100

    scene.setup.setup()
    scene.solve(ob.PlannerTerminationCondition(condition))
    assert len(asked) >= 101
    assert scene.setup.haveExactSolutionPath()


def test_no_time_is_no_hang_and_no_error():
    scene = Scene().usual()
    status = scene.solve(ob.PlannerTerminationCondition(lambda: True))
    assert status.getStatus() in (ob.PlannerStatus.TIMEOUT, ob.PlannerStatus.EXACT_SOLUTION)
    assert scene.solve(0.0).getStatus() in (
        ob.PlannerStatus.TIMEOUT,
        ob.PlannerStatus.EXACT_SOLUTION,
    )


def test_the_planner_may_be_called_directly_with_seconds():
    scene = Scene().usual()
    scene.setup.setup()
    assert scene.planner.solve(0.2).getStatus() == ob.PlannerStatus.EXACT_SOLUTION


def test_start_in_collision_is_said():
    scene = Scene()
    start, goal = ends(scene.terrain)
    status = scene.between(start - [0.0, 0.0, 40.0], goal).solve()
    assert status.getStatus() == ob.PlannerStatus.INVALID_START
    assert "start" in scene.planner.reason


def test_goal_in_collision_is_said():
    scene = Scene()
    start, goal = ends(scene.terrain)
    status = scene.between(start, goal - [0.0, 0.0, 40.0]).solve()
    assert status.getStatus() == ob.PlannerStatus.INVALID_GOAL
    assert "goal" in scene.planner.reason


@pytest.mark.parametrize("end", [0, 1])
def test_an_end_in_collision_is_said_even_without_a_checker(end):
    scene = Scene(bare=True)
    places = ends(scene.terrain)
    places[end, 2] -= 40.0
    status = scene.between(*places).solve()
    expected = (ob.PlannerStatus.INVALID_START, ob.PlannerStatus.INVALID_GOAL)[end]
    assert status.getStatus() == expected


def test_no_path_ends_in_time_and_says_how_far_it_came():
    heights = np.zeros((41, 41))
    heights[:, 20] = CEILING + 5.0
    scene = Scene(Terrain(heights, spacing=(25.0, 25.0)))
    status = scene.usual().solve(0.2)
    assert status.getStatus() == ob.PlannerStatus.TIMEOUT
    assert "no path" in scene.planner.reason
    assert not scene.setup.haveSolutionPath()


def test_goal_states_give_the_best_of_several():
    scene = Scene()
    start, goal = ends(scene.terrain)
    goals = ob.GoalStates(scene.si)
    near = goal.copy()
    near[:2] -= 300.0
    near[2] = scene.terrain.height(*near[:2]) + 30.0
    for place in (goal, near):
        goals.addState(scene.state(place))
    scene.setup.setStartState(scene.state(start))
    scene.setup.setGoal(goals)
    assert scene.solve().getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert scene.path.getStates()[-1][0:3] == near.tolist()


class Disc(ob.GoalSampleableRegion):
    """Anywhere near a point."""

    def __init__(self, si, centre):
        super().__init__(si)
        self.setThreshold(20.0)
        self._centre, self._rng = np.array(centre), np.random.default_rng(0)
        self.given = []

    def distanceGoal(self, state):
        return float(np.linalg.norm(np.array(state[0:3]) - self._centre))

    def sampleGoal(self, state):
        place = self._centre + self._rng.uniform(-10.0, 10.0, 3)
        self.given.append(tuple(place))
        state[0:3] = place.tolist()

    def maxSampleCount(self):
        return 1000


def test_a_sampled_goal_region_is_reached():
    scene = Scene()
    start, goal = ends(scene.terrain)
    region = Disc(scene.si, goal + np.array([0.0, 0.0, 12.0]))
    scene.setup.setStartState(scene.state(start))
    scene.setup.setGoal(region)
    assert scene.solve(0.5).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert tuple(scene.path.getStates()[-1][0:3]) in region.given
    assert len(region.given) > 16  # goes on sampling while it plans


class Somewhere(ob.GoalRegion):
    """A goal without states."""

    def distanceGoal(self, state):
        return 1.0


def test_a_goal_without_states_is_said():
    scene = Scene()
    scene.setup.setStartState(scene.state(ends(scene.terrain)[0]))
    scene.setup.setGoal(Somewhere(scene.si))
    assert scene.solve().getStatus() == ob.PlannerStatus.UNRECOGNIZED_GOAL_TYPE
    assert "GoalState" in scene.planner.reason


def test_a_cost_threshold_ends_it():
    scene = Scene().usual()
    scene.objective.setCostThreshold(ob.Cost(1e9))
    scene.solve(ob.PlannerTerminationCondition(lambda: False))
    assert scene.setup.haveExactSolutionPath()


def test_an_optimal_path_ends_it():
    flat = Terrain(np.zeros((41, 41)), spacing=(25.0, 25.0))
    scene = Scene(flat).between([60.0, 60.0, 50.0], [900.0, 900.0, 50.0])
    scene.solve(ob.PlannerTerminationCondition(lambda: False))
    assert scene.path.getStateCount() == 2


@pytest.mark.parametrize("given", [True, False])
def test_without_a_risk_objective_it_minimises_the_length(given):
    scene = Scene(no_objective=True)
    length = ob.PathLengthOptimizationObjective(scene.si)
    if given:
        scene.setup.setOptimizationObjective(length)
    scene.usual().solve(0.4)
    assert scene.path.check()
    assert scene.path.length() == pytest.approx(scene.planner.history[-1].cost)
    risky = Scene().usual()
    risky.solve(0.4)
    assert scene.path.length() < risky.path.length()


def test_an_unknown_objective_is_refused():
    scene = Scene(no_objective=True).usual()
    scene.setup.setOptimizationObjective(ob.StateCostIntegralObjective(scene.si, False))
    with pytest.raises(ArgumentError, match="objective"):
        scene.solve()


def test_another_space_is_refused():
    space = ob.RealVectorStateSpace(2)
    space.setBounds(0.0, 1.0)
    setup = og.SimpleSetup(space)
    state = setup.getSpaceInformation().allocState()
    state[0:2] = [0.5, 0.5]
    setup.setStartAndGoalStates(state, state)
    setup.setStateValidityChecker(lambda _: True)
    setup.setPlanner(RiskRoadmap(setup.getSpaceInformation()))
    with pytest.raises(ArgumentError, match="R\\^3"):
        setup.solve(0.1)


def test_a_foreign_checker_and_validator_are_asked():
    scene = Scene(bare=True)
    asked = []

    def outside(state):
        asked.append(1)
        return abs(state[0] - 500.0) > 50.0 or state[1] > 700.0

    scene.setup.setStateValidityChecker(outside)
    scene.si.setStateValidityCheckingResolution(0.002)
    scene.usual().solve(1.0)
    assert asked
    assert not scene.planner.compiled
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(4.0).positions
    assert ((np.abs(fine[:, 0] - 500.0) > 45.0) | (fine[:, 1] > 695.0)).all()
    assert scene.clearance(fine).min() > 0.0


def test_a_python_clearance_works_and_says_that_it_is_slow():
    terrain = hills()
    exact = TerrainClearance(terrain, 2.0)
    scene = Scene(terrain, clearance=lambda points: exact(points)).usual()  # noqa: PLW0108
    assert scene.solve(1.0).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert not scene.planner.compiled


def test_nan_from_a_clearance_surfaces_and_what_was_found_is_kept():
    terrain = hills()
    exact = TerrainClearance(terrain, 2.0)
    broken = []

    def clearance(points):
        d = exact(points)
        return np.full(len(points), np.nan) if broken else d

    scene = Scene(terrain, clearance=clearance, bare=True).usual()
    scene.solve(0.5)
    before = scene.cost
    broken.append(True)
    with pytest.raises(ArgumentError, match="nan"):
        scene.solve(5.0)
    broken.clear()
    assert scene.setup.haveExactSolutionPath()
    # states that were answered before the clearance broke may still be connected, for the better
    assert scene.cost <= before * (1.0 + 1e-9)


def test_an_exception_of_a_clearance_surfaces():
    calls = []
    exact = TerrainClearance(hills(), 2.0)

    def clearance(points):
        calls.append(1)
        if len(calls) > 40:
            raise RuntimeError("sensor unplugged")
        return exact(points)

    scene = Scene(clearance=clearance).usual()
    with pytest.raises(RuntimeError, match="sensor unplugged"):
        scene.solve(5.0)


def test_meshes_and_unions_work():
    terrain = hills()
    tower = trimesh.creation.cylinder(40.0, 200.0)
    tower.apply_translation([500.0, 500.0, 0.0])
    clearance = UnionClearance([TerrainClearance(terrain, 2.0), MeshClearance([tower], 2.0)])
    scene = Scene(terrain, clearance).usual()
    assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(1.0).positions
    assert clearance(fine).min() > 0.0


def test_poses_over_terrain_turn_as_they_go():
    scene = Scene(kind=ob.SE3StateSpace)
    start, goal = ends(scene.terrain)
    turned = [0.0, 0.0, math.sin(0.4), math.cos(0.4)]
    scene.between([*start, 0.0, 0.0, 0.0, 1.0], [*goal, *turned])
    assert scene.solve().getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert scene.planner.compiled
    path = Trajectory.from_path(scene.path, speed=SPEED)
    np.testing.assert_allclose(path.orientations[0], [0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(path.orientations[-1], turned, atol=1e-12)
    angles = 2 * np.arccos(path.orientations[:, 3])
    np.testing.assert_allclose(angles, 0.8 * path.t / path.duration, atol=1e-6)
    assert scene.path.check()


def test_a_body_that_must_turn_to_pass_turns():
    """A rod through a slit that it only fits along its length."""
    walls = [trimesh.creation.box((4.0, 60.0, 60.0)) for _ in range(2)]
    walls[0].apply_translation([0.0, 33.0, 0.0])
    walls[1].apply_translation([0.0, -33.0, 0.0])
    rod = trimesh.creation.box((1.0, 12.0, 1.0))
    clearance = MeshClearance(walls, body=rod)
    space = ob.SE3StateSpace()
    bounds = ob.RealVectorBounds(3)
    for k, half in enumerate((40.0, 20.0, 20.0)):
        bounds.setLow(k, -half)
        bounds.setHigh(k, half)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, clearance))
    si.setMotionValidator(ClearanceMotionValidator(si, clearance))
    setup.setOptimizationObjective(
        RiskObjective(si, clearance, InverseDistance(10.0), Lp(2), speed=5.0, duration_weight=1.0)
    )
    write = StateWriter(si).state
    still = [0.0, 0.0, 0.0, 1.0]
    setup.setStartAndGoalStates(
        write(np.array([-30.0, 0.0, 0.0, *still])), write(np.array([30.0, 0.0, 0.0, *still]))
    )
    planner = RiskRoadmap(si)
    setup.setPlanner(planner)
    setup.solve(once(lambda: planner.history != []))
    assert setup.haveExactSolutionPath(), planner.reason
    assert setup.getSolutionPath().check()


def test_a_better_solution_of_another_planner_stays_first():
    scene = Scene().usual()
    scene.solve(0.5)
    best = scene.cost
    path = og.PathGeometric(scene.path)
    other = RiskRoadmap(scene.si, seed=7)
    problem = scene.setup.getProblemDefinition()
    other.setProblemDefinition(problem)
    other.setup()
    other.solve(once(lambda: other.history != []))
    assert scene.cost <= best
    assert path.cost(scene.objective).value() == pytest.approx(best)


def test_it_runs_in_ompls_benchmark():
    scene = Scene().usual()
    benchmark = ot.Benchmark(scene.setup, "roadmap")
    benchmark.addPlanner(RiskRoadmap(scene.si))
    benchmark.benchmark(ot.Request(0.2, 4096.0, 2, 0.05, False, False, False))
    runs = benchmark.getRecordedExperimentData().planners[0].runs
    assert len(runs) == 2


@pytest.mark.parametrize("options", [{"seed": -1}, {"seed": 1.5}, {"seed": True}, {"threads": 0}])
def test_wrong_options_are_refused(options):
    scene = Scene()
    with pytest.raises(ArgumentError, match=next(iter(options))):
        RiskRoadmap(scene.si, **options)


class Dogleg(Steering):
    """Climbs or descends at half way, level before and after; slower than straight."""

    symmetric = True

    def connect(self, a, b):
        middle = 0.5 * (a + b)
        corners = np.array([a, [*middle[:2], a[2]], [*middle[:2], b[2]], b])
        steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        if steps.max() == 0.0:
            return Connection(0.0, [a, b])
        pieces = [np.linspace(p, q, 9)[:-1] for p, q in pairwise(corners)]
        return Connection(3.0 * steps.max() / SPEED, [*np.vstack(pieces), b])


class OneWay(Steering):
    """Straight, but only towards the east."""

    def connect(self, a, b):
        if b[0] <= a[0]:
            return Connection.none()
        return Connection(float(np.linalg.norm(b - a)) / SPEED, [a, b])


def test_a_steering_shapes_the_path_and_its_duration():
    scene = Scene(steering=Dogleg()).usual()
    assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    corners = np.array([s[0:3] for s in scene.path.getStates()])
    steps = np.diff(corners, axis=0)
    level, upright = np.abs(steps[:, 2]) < 1e-9, np.linalg.norm(steps[:, :2], axis=1) < 1e-9
    assert (level | upright).all()
    assert scene.path.check()
    roadmap = scene.planner.roadmap
    route = roadmap.best
    again = [Dogleg().connect(*ends) for ends in pairwise(roadmap.states[route.vertices])]
    assert route.duration == pytest.approx(sum(way.duration for way in again))
    np.testing.assert_array_equal(corners, route.states)


def test_a_directed_steering_never_goes_back():
    scene = Scene(steering=OneWay()).usual()
    assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    x = [state[0] for state in scene.path.getStates()]
    assert x == sorted(x)
    back = Scene(steering=OneWay()).between(*ends(hills())[::-1])
    assert back.solve(0.3).getStatus() == ob.PlannerStatus.TIMEOUT


def test_the_distance_from_obstacles_is_kept_along_the_way_that_is_steered():
    """The straight motions would keep it, the doglegs have to as well."""
    scene = Scene(steering=Dogleg())
    wide = scene.clearance.with_radius(9.0)
    scene.setup.setStateValidityChecker(ClearanceValidityChecker(scene.si, wide))
    scene.si.setMotionValidator(ClearanceMotionValidator(scene.si, wide))
    scene.usual().solve(found(scene))
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(0.5).positions
    assert wide(fine).min() > 0.0


def test_alternatives_and_pareto_set_come_as_routes_that_can_be_published():
    scene = Scene().usual()
    with pytest.raises(ArgumentError, match="solved with before"):
        scene.planner.alternatives(3)
    scene.solve(0.5)
    routes = scene.planner.alternatives(4, excess=0.2, min_distance=40.0)
    assert len(routes) >= 2
    least = min(route.duration for route in routes)
    for route in routes:
        assert route.duration <= 1.2 * least * (1 + 1e-9)
        path = Trajectory.at_constant_speed(route.states, SPEED)
        assert path.duration == pytest.approx(route.duration)
    front = scene.planner.pareto()
    risks = [route.risk for route in front.routes]
    durations = [route.duration for route in front.routes]
    assert durations == sorted(durations)
    assert risks == sorted(risks, reverse=True)
    assert front.least_risk(within=math.inf).risk == risks[-1]
    assert front.fastest(within_risk=math.inf).duration == durations[0]
    middle = 0.5 * (durations[0] + durations[-1])
    within = front.least_risk(within=middle)
    assert within.duration <= middle
    scene.planner.publish(front.routes)
    problem = scene.setup.getProblemDefinition()
    assert problem.getSolutionCount() >= len(front.routes)
    assert problem.hasExactSolution()


def test_the_same_number_of_iterations_gives_the_same_path():
    paths = []
    for threads in (1, 2):
        scene = Scene().usual()
        planner = RiskRoadmap(scene.si, seed=5, iterations=3000, threads=threads)
        scene.setup.setPlanner(planner)
        scene.solve(ob.PlannerTerminationCondition(lambda: False))
        paths.append([state[0:3] for state in scene.path.getStates()])
    assert paths[0] == paths[1]


class NoFly(ClearanceValidityChecker):
    """Keeps out of a zone besides."""

    def isValid(self, state):
        outside = abs(state[0] - 500.0) > 50.0 or state[1] > 700.0
        return bool(outside and super().isValid(state))


class Dear(RiskObjective):
    """With a cost of its own."""

    def motionCost(self, s1, s2):
        return ob.Cost(1.0)


def test_overridden_checkers_are_not_bypassed():
    scene = Scene()
    scene.setup.setStateValidityChecker(NoFly(scene.si, scene.clearance))
    scene.usual().solve(0.5)
    assert not scene.planner.compiled
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(4.0).positions
    ours = Scene().usual()
    ours.solve(0.5)
    assert ours.planner.compiled
    if len(fine):
        states = [s[0:3] for s in scene.path.getStates()]
        assert all(abs(x - 500.0) > 50.0 or y > 700.0 for x, y, _ in states)


def test_overridden_objectives_are_refused():
    scene = Scene(no_objective=True)
    scene.setup.setOptimizationObjective(Dear(scene.si, scene.clearance, speed=SPEED))
    with pytest.raises(ArgumentError, match="motionCost of its own"):
        scene.usual().solve(0.1)


def test_equal_clearances_of_checker_and_validator_stay_compiled():
    scene = Scene()
    again = TerrainClearance(scene.terrain, 2.0)
    scene.setup.setStateValidityChecker(ClearanceValidityChecker(scene.si, again))
    scene.usual().solve(0.1)
    assert scene.planner.compiled


def test_different_clearances_of_checker_and_validator_are_both_kept():
    scene = Scene()
    wide = scene.clearance.with_radius(8.0)
    scene.setup.setStateValidityChecker(ClearanceValidityChecker(scene.si, wide))
    scene.usual().solve(found(scene))
    assert scene.planner.compiled
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(0.5).positions
    assert wide(fine).min() > 0.0


def test_a_goal_state_in_the_ground_does_not_hide_the_next():
    scene = Scene()
    start, goal = ends(scene.terrain)
    goals = ob.GoalStates(scene.si)
    for place in (goal - [0.0, 0.0, 40.0], goal):
        goals.addState(scene.state(place))
    scene.setup.setStartState(scene.state(start))
    scene.setup.setGoal(goals)
    assert scene.solve().getStatus() == ob.PlannerStatus.EXACT_SOLUTION


def test_all_of_many_goal_states_are_tried():
    scene = Scene(duration_weight=1.0)
    scene.setup.setPlanner(RiskRoadmap(scene.si, iterations=500))
    start, goal = ends(scene.terrain)
    goals = ob.GoalStates(scene.si)
    for k in range(30):
        goals.addState(scene.state(goal - [0.0, 10.0 * k, -10.0]))
    near = start + np.array([60.0, 0.0, 0.0])
    near[2] = scene.terrain.height(*near[:2]) + 20.0
    goals.addState(scene.state(near))
    scene.setup.setStartState(scene.state(start))
    scene.setup.setGoal(goals)
    scene.solve(ob.PlannerTerminationCondition(lambda: False))
    assert scene.path.getStates()[-1][0:3] == near.tolist()


def test_a_clearance_that_fails_once_leaves_the_planner_usable():
    exact = TerrainClearance(hills(), 2.0)
    for failing in (1, 2, 4, 6, 12, 27, 40):
        calls = itertools.count(1)
        broken = [False]

        def clearance(points, failing=failing, calls=calls, broken=broken):
            if broken[0] and next(calls) == failing:
                raise RuntimeError("a glitch")
            return exact(points)

        scene = Scene(clearance=clearance, bare=True).usual()
        scene.setup.setup()
        broken[0] = True
        with pytest.raises(RuntimeError, match="glitch"):
            scene.solve(once(lambda: False))
        broken[0] = False
        assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
        scene.setup.clear()


def test_each_goal_keeps_its_orientation():
    scene = Scene(kind=ob.SE3StateSpace)
    start, goal = ends(scene.terrain)
    turned = [0.0, 0.0, math.sin(0.4), math.cos(0.4)]
    near = goal - np.array([300.0, 300.0, 0.0])
    near[2] = scene.terrain.height(*near[:2]) + 30.0
    goals = ob.GoalStates(scene.si)
    goals.addState(scene.state([*goal, 0.0, 0.0, 0.0, 1.0]))
    goals.addState(scene.state([*near, *turned]))
    scene.setup.setStartState(scene.state([*start, 0.0, 0.0, 0.0, 1.0]))
    scene.setup.setGoal(goals)
    scene.solve(0.3)
    path = Trajectory.from_path(scene.path, speed=SPEED)
    np.testing.assert_allclose(path.positions[-1], near)
    np.testing.assert_allclose(path.orientations[-1], turned, atol=1e-12)


def test_a_condition_may_wait_for_the_first_solution():
    scene = Scene().usual()
    problem = scene.setup.getProblemDefinition()
    scene.solve(once(problem.hasExactSolution))
    assert len(scene.planner.history) <= 5
    assert scene.setup.haveExactSolutionPath()


def test_what_is_published_comes_first_even_if_it_costs_more():
    scene = Scene().usual()
    scene.solve(0.4)
    routes = scene.planner.alternatives(4, excess=0.2, min_distance=40.0)
    assert routes[0].cost > scene.planner.roadmap.best.cost
    scene.planner.publish(routes)
    corners = [state[0:3] for state in scene.path.getStates()]
    np.testing.assert_array_equal(corners, routes[0].states)
    assert scene.setup.getProblemDefinition().getSolutionCount() == len(routes)
    scene.planner.publish(())
    assert scene.setup.getProblemDefinition().getSolutionCount() == 0


def test_samples_stay_where_paths_can_be_better():
    scene = Scene(duration_weight=1.0).usual()
    scene.solve(1.0)
    roadmap = scene.planner.roadmap
    low, high = roadmap._prospects.box()
    region = roadmap.region
    assert np.prod(high - low) < 0.9 * np.prod(region.high - region.low)
    a, b = roadmap.states[roadmap.starts[0]], roadmap.states[roadmap.goals[0]]
    longest = roadmap.best.cost * SPEED
    rng = np.random.default_rng(0)
    points = rng.uniform(region.low, region.high, (20_000, 3))
    way = np.linalg.norm(points - a, axis=1) + np.linalg.norm(points - b, axis=1)
    inside = ((points >= low) & (points <= high)).all(axis=1)
    assert inside[way < longest].all()
