"""Earliest arrival through OMPL: SimpleSetup over space-time, checkers, paths, wrong use."""

import itertools
import math

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og

from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingSphere
from ompl_risk.clearance.terrain import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.motion.steering import Connection, Steering
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.spacetime.growing import LIMIT, TimedRoadmap
from ompl_risk.planners.spacetime.stays import Hovering
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

FASTEST, ROOM, END = 10.0, 100.0, 60.0


def door(opens=20.0, rise=25.0):
    """A wall across the room, from x = 45 to 55, that rises from a time on until it is gone."""
    up = 150.0 + 10.0 * rise
    t = [0.0, opens, opens + 10.0, opens + 100.0]
    return MovingBox([10, 300, 300], t, [[50, 50, z] for z in (140.0, 140.0, up, up)])


def pendulum():
    """A ball that sweeps the wall's only gap."""
    t = np.arange(0.0, 61.0, 4.0)
    return MovingSphere(8.0, t, [[50, 50 + 30 * (-1) ** k, 50] for k in range(len(t))])


class Scene:
    """A SimpleSetup in a room of 100 m with a RiskRoadmap."""

    def __init__(self, clearance=None, *, end=END, motions=True, checker=True, **options):
        self.clearance = clearance or MovingClearance(door(), radius=1.0)
        place = ob.RealVectorStateSpace(3)
        place.setBounds(0.0, ROOM)
        self.space = ob.SpaceTimeStateSpace(place, FASTEST)
        if end is not None:
            self.space.setTimeBounds(0.0, end)
        self.setup = og.SimpleSetup(self.space)
        self.si = self.setup.getSpaceInformation()
        if checker:
            self.setup.setStateValidityChecker(ClearanceValidityChecker(self.si, self.clearance))
        if motions:
            self.si.setMotionValidator(ClearanceMotionValidator(self.si, self.clearance))
        self.planner = RiskRoadmap(self.si, **options)
        self.setup.setPlanner(self.planner)
        self.between((10, 50, 50, 0), (90, 50, 50, 0))

    def state(self, numbers):
        state = self.si.allocState()
        state[0][0:3] = [float(x) for x in numbers[:3]]
        state[1].position = float(numbers[3])
        return state

    def between(self, start, goal):
        self.setup.setStartAndGoalStates(self.state(start), self.state(goal))
        return self

    def solve(self, condition=20.0):
        return self.setup.solve(condition)

    @property
    def path(self):
        return self.setup.getProblemDefinition().getSolutionPath()

    @property
    def flown(self):
        return Trajectory.from_path(self.path)


def is_exact(status):
    return status.asString() == "Exact solution"


def dense(flown, clearance, n=20_001):
    fine = flown.resample(np.linspace(flown.t[0], flown.t[-1], n))
    return clearance(fine.positions, fine.t).min()


def test_waits_for_the_door_and_passes_below_it():
    scene = Scene(iterations=500)
    assert is_exact(scene.solve())
    flown = scene.flown
    assert scene.path.check()
    assert dense(flown, scene.clearance) > 0.0
    assert flown.t[0] == 0.0
    assert flown.positions[[0, -1]].tolist() == [[10, 50, 50], [90, 50, 50]]
    still = (np.diff(flown.positions, axis=0) == 0.0).all(axis=1)
    assert still.any()
    speeds = np.linalg.norm(np.diff(flown.positions, axis=0), axis=1) / np.diff(flown.t)
    assert speeds[~still] == pytest.approx(FASTEST)
    # Below the door there is nothing but its edge, at 25 (t - 20) - 10: whoever crosses x = 46 at
    # t is below it, and has the rest of the way to fly. Nothing is earlier than the best of that.
    t = np.linspace(20.0, 30.0, 100_001)
    edge = np.clip(25.0 * (t - 20.0) - 10.0, -math.inf, 50.0)
    bound = np.where(edge >= 0.0, t + np.hypot(44.0, 50.0 - edge) / FASTEST, math.inf).min()
    assert bound < flown.t[-1] < bound + 0.3


def test_its_trajectory_is_that_of_its_path():
    scene = Scene(iterations=100)
    scene.solve()
    own = scene.planner.trajectory("A")
    assert own.name == "A"
    assert own.t.tolist() == scene.flown.t.tolist()
    assert own.positions.tolist() == scene.flown.positions.tolist()


def test_a_vehicle_that_cannot_hover_never_stands_still():
    scene = Scene(iterations=150, can_wait=False)
    assert is_exact(scene.solve())
    flown = scene.flown
    assert (np.linalg.norm(np.diff(flown.positions, axis=0), axis=1) > 0.0).all()
    assert flown.length == pytest.approx(FASTEST * flown.duration)
    assert dense(flown, scene.clearance) > 0.0
    waiting = Scene(iterations=500)
    waiting.solve()
    assert waiting.flown.t[-1] < flown.t[-1] < waiting.flown.t[-1] + 3.0


def test_a_vehicle_that_cannot_hover_takes_a_way_without_waits_at_once():
    walls = [MovingBox([5, 60, 300], [0, 1], [[x, y, 50]] * 2) for x, y in ((40, 30), (60, 70))]
    hovering = Scene(MovingClearance(walls, radius=1.0), iterations=500)
    passing = Scene(MovingClearance(walls, radius=1.0), iterations=500, can_wait=False)
    assert is_exact(hovering.solve())
    assert is_exact(passing.solve())
    assert hovering.planner.trajectory().t.tolist() == passing.planner.trajectory().t.tolist()


def test_a_free_way_is_straight_and_done_at_once():
    away = MovingSphere(1.0, [0, 1], [[0, 0, 500]] * 2)
    scene = Scene(MovingClearance(away))
    scene.between((10, 50, 50, 7), (90, 50, 50, 0))
    calls = itertools.count()
    never = ob.PlannerTerminationCondition(lambda: next(calls) > 1000)
    assert is_exact(scene.solve(never))
    assert next(calls) < 1000  # it ended of itself: nothing was left to gain
    assert scene.flown.t.tolist() == [7.0, 15.0]


def test_says_that_there_is_no_way():
    shut = MovingBox([10, 300, 300], [0, 1], [[50, 50, 50]] * 2)
    scene = Scene(MovingClearance(shut, radius=1.0), iterations=400)
    status = scene.solve()
    assert status.asString() == "Timeout"
    assert not scene.setup.haveSolutionPath()
    assert "no way among the obstacles arrives by t = 60 s" in scene.planner.reason
    with pytest.raises(ArgumentError, match="solved"):
        scene.planner.trajectory()


class Counted(MovingClearance):
    """Counts what it is asked, in motions and places."""

    asked = 0

    def are_free(self, a, ta, b, tb):
        self.asked += len(a)
        return super().are_free(a, ta, b, tb)

    def free_intervals(self, points, t0, t1, **options):
        self.asked += len(points)
        return super().free_intervals(points, t0, t1, **options)


@pytest.mark.parametrize("can_wait", [True, False])
def test_stops_within_a_portion_of_work(can_wait):
    shut = MovingBox([10, 300, 300], [0, 1], [[50, 50, 50]] * 2)
    clearance = Counted(shut, radius=1.0)
    scene = Scene(clearance, can_wait=can_wait)
    scene.setup.setup()
    after = []

    def stop():
        if clearance.asked > 5000:
            after.append(clearance.asked)
        return bool(after)

    assert scene.solve(ob.PlannerTerminationCondition(stop)).asString() == "Timeout"
    assert "no path found in time" in scene.planner.reason
    assert clearance.asked == after[0]  # once it was told to stop, nothing more was asked
    assert len(after) < 10


def test_goes_on_where_it_stopped_and_only_gets_better():
    scene = Scene(iterations=150)
    scene.solve()
    first = scene.flown.t[-1]
    scene.setup.setStartAndGoalStates(scene.state((10, 50, 50, 0)), scene.state((90, 50, 50, 0)))
    scene.solve()
    assert scene.flown.t[-1] <= first
    arrivals = [row.cost for row in scene.planner.history]
    assert arrivals == sorted(arrivals, reverse=True)
    assert arrivals[-1] == scene.flown.t[-1]
    assert scene.setup.getProblemDefinition().getSolutionCount() == 1


def test_the_same_seed_gives_the_same_path():
    paths = []
    for _ in range(2):
        scene = Scene(iterations=100, seed=5)
        scene.solve()
        paths.append(scene.flown)
    assert paths[0].t.tolist() == paths[1].t.tolist()
    assert paths[0].positions.tolist() == paths[1].positions.tolist()


def test_clear_forgets_what_was_found():
    scene = Scene(iterations=100)
    scene.solve()
    scene.setup.clear()
    assert scene.planner.history == []
    with pytest.raises(ArgumentError, match="solved"):
        scene.planner.trajectory()
    scene.between((10, 50, 50, 0), (90, 20, 50, 0))
    assert is_exact(scene.solve())
    assert scene.flown.positions[-1].tolist() == [90, 20, 50]


def test_the_time_of_the_goal_state_is_not_looked_at():
    found = []
    for when in (0.0, 59.0):
        scene = Scene(iterations=100).between((10, 50, 50, 0), (90, 50, 50, when))
        assert is_exact(scene.solve())
        found.append(scene.flown.t[-1])
    assert found[0] == found[1]


def test_the_nearest_in_time_of_several_goals():
    scene = Scene(iterations=150)
    goals = ob.GoalStates(scene.si)
    for goal in [(90, 50, 50, 0), (20, 50, 50, 0), (500, 50, 50, 0)]:
        goals.addState(scene.state(goal))
    scene.setup.setGoal(goals)
    scene.solve()
    assert scene.flown.t.tolist() == [0.0, 1.0]


def test_over_terrain_places_are_free_of_the_ground():
    y, x = np.mgrid[0:21, 0:21] * 5.0
    ridge = 60.0 * np.exp(-(((x - 50) / 8) ** 2)) * (1 - np.exp(-(((y - 50) / 12) ** 2)))
    static = TerrainClearance(Terrain(ridge, spacing=(5, 5)), 1.0)
    clearance = MovingClearance(pendulum(), static=static, radius=1.0)
    scene = Scene(clearance, iterations=1000).between((10, 50, 10, 0), (90, 50, 10, 0))
    assert is_exact(scene.solve())
    assert dense(scene.flown, clearance) > 0.0
    assert scene.path.check()


def timed_roadmap(clearance, height=50.0):
    return TimedRoadmap(
        Region([0] * 3, [100] * 3, seed=1),
        clearance,
        np.array([[10.0, 50, height]]),
        np.zeros(1),
        np.array([[90.0, 50, height]]),
        speed=FASTEST,
        latest=END,
        stays=lambda _search: Hovering(),
    )


def test_places_are_free_of_what_stands_still_and_near_enough_to_matter():
    ground = TerrainClearance(Terrain(np.full((11, 11), 40.0), spacing=(10.0, 10.0)), 1.0)
    made = timed_roadmap(MovingClearance(door(), static=ground, radius=1.0))
    made.grow(250)
    assert 50 < made.n < 200  # of the room, 59 of 100 m are free
    assert (ground(made.places) > 0.0).all()
    made.search()
    made.grow(1000)
    there = np.linalg.norm(made.places[:, None] - made.places[:2], axis=2).sum(axis=1)
    new = there[made.n - 100 :]  # drawn last, knowing the best route
    assert (new <= FASTEST * made.best.duration).all()


def test_a_network_that_is_large_enough_begins_anew_with_the_best_route():
    made = timed_roadmap(MovingClearance(door(), radius=1.0))
    made.grow(250)
    assert made.search()
    before = made.best
    made.grow(LIMIT)
    assert made.n > LIMIT
    made.grow(100)
    assert made.n < 200
    assert all(p in made.places.tolist() for p in before.positions.tolist())
    made.search()
    assert made.best.arrival <= before.arrival


class TestChecker:
    def test_reads_the_time_of_a_state(self):
        scene = Scene()
        checker = scene.si.getStateValidityChecker()
        inside = (50, 50, 50)
        assert not checker.isValid(scene.state((*inside, 0)))
        assert checker.isValid(scene.state((*inside, 29)))
        want = scene.clearance([inside], [25.0])[0]
        assert checker.clearance(scene.state((*inside, 25))) == want

    def test_motions_take_their_time(self):
        scene = Scene()
        a, b = (10, 50, 50, 0), (20, 50, 50, 1)

        def check(p, q):
            return scene.si.checkMotion(scene.state(p), scene.state(q))

        assert check(a, b)
        assert check(a, a)
        assert not check(b, a)  # backwards in time
        assert not check(a, (20, 50, 50, 0.99))  # faster than the space says
        assert check(a, (20, 50, 50, 30))
        assert not check(a, (20, 50, 50, 0))

    def test_motions_are_checked_at_their_own_time(self):
        scene = Scene()

        def check(p, q):
            return scene.si.checkMotion(scene.state(p), scene.state(q))

        assert not check((40, 50, 50, 0), (60, 50, 50, 2))
        assert check((40, 50, 50, 27), (60, 50, 50, 29))
        assert not check((40, 50, 50, 10), (60, 50, 50, 40))  # too early at the door, slowly
        ball = MovingClearance(MovingSphere(1e-3, [0, 1], [[50, 0, 50], [50, 1e5, 50]]))
        scene = Scene(ball)
        assert not check((50, 50, 50, 0), (50, 50, 50, 1))  # swept while it stays
        assert check((50, 50, 50, 0.01), (50, 50, 50, 1))

    def test_obstacles_that_stand_still_will_do(self):
        flat = TerrainClearance(Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0)), 1.0)
        scene = Scene(flat)
        assert scene.si.checkMotion(scene.state((10, 50, 5, 0)), scene.state((20, 50, 5, 9)))
        assert not scene.si.checkMotion(scene.state((10, 50, 5, 9)), scene.state((20, 50, 5, 0)))
        assert not scene.si.isValid(scene.state((10, 50, 0.5, 0)))
        with pytest.raises(ArgumentError, match="MovingClearance"):
            scene.solve()

    def test_paths_with_times_are_trajectories(self):
        scene = Scene()
        scene.setup.setup()
        path = og.PathGeometric(scene.si)
        rows = [(1, 2, 3, 4), (1, 2, 3, 4), (1, 2, 3, 9), (11, 2, 3, 10)]
        for row in rows:
            path.append(scene.state(row))
        flown = Trajectory.from_path(path, name="B")
        assert flown.t.tolist() == [4, 9, 10]
        assert flown.positions.tolist() == [list(row[:3]) for row in rows[1:]]
        with pytest.raises(ArgumentError, match="carry their times"):
            Trajectory.from_path(path, speed=3.0)


class ElsewhereSteering(Steering):
    def connect(self, a, b):
        return Connection(np.stack([a, b]), 1.0)


class TestWrongUse:
    @pytest.mark.parametrize("kind", [ClearanceValidityChecker, ClearanceMotionValidator])
    def test_a_space_without_time(self, kind):
        place = ob.RealVectorStateSpace(3)
        place.setBounds(0.0, ROOM)
        clearance = MovingClearance(door())
        with pytest.raises(ArgumentError, match=r"RealVector.*SpaceTimeStateSpace"):
            kind(ob.SpaceInformation(place), clearance)

    def test_an_objective_without_time(self):
        place = ob.RealVectorStateSpace(3)
        place.setBounds(0.0, ROOM)
        with pytest.raises(ArgumentError, match=r"SpaceTimeStateSpace.*rank"):
            RiskObjective(ob.SpaceInformation(place), MovingClearance(door()), speed=1.0)
        with pytest.raises(ArgumentError, match="without an objective"):
            RiskObjective(Scene().si, MovingClearance(door()), speed=1.0)
        with pytest.raises(ArgumentError, match="stands still"):
            motion_batch(MovingClearance(door()), Risk(speed=1.0))

    def test_space_time_over_something_else(self):
        space = ob.SpaceTimeStateSpace(ob.RealVectorStateSpace(2), 1.0)
        with pytest.raises(ArgumentError, match="RealVectorStateSpace"):
            RiskRoadmap(ob.SpaceInformation(space))
        with pytest.raises(ArgumentError, match="SE3StateSpace"):
            RiskRoadmap(ob.SpaceInformation(ob.SpaceTimeStateSpace(ob.SE3StateSpace(), 1.0)))

    def test_no_bounds_in_time(self):
        with pytest.raises(ArgumentError, match="setTimeBounds"):
            Scene(end=None).solve()

    def test_an_objective(self):
        scene = Scene()
        scene.setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(scene.si))
        with pytest.raises(ArgumentError, match=r"objective.*left out"):
            scene.solve()

    def test_a_checker_of_somebody_else(self):
        scene = Scene(checker=False, motions=False)
        scene.setup.setStateValidityChecker(lambda _state: True)
        with pytest.raises(ArgumentError, match="ClearanceValidityChecker"):
            scene.solve()

    def test_a_validator_of_another_clearance(self):
        scene = Scene()
        other = MovingClearance(door(), radius=2.0)
        scene.si.setMotionValidator(ClearanceMotionValidator(scene.si, other))
        with pytest.raises(ArgumentError, match="clearance of the validity checker"):
            scene.solve()

    def test_a_steering(self):
        with pytest.raises(ArgumentError, match="steering"):
            Scene(steering=ElsewhereSteering())

    def test_a_start_in_the_door(self):
        scene = Scene().between((50, 50, 50, 0), (90, 50, 50, 0))
        assert scene.solve().asString() == "Invalid start"
        assert "free at its time" in scene.planner.reason

    def test_a_goal_out_of_the_room(self):
        scene = Scene().between((10, 50, 50, 0), (90, 50, 500, 0))
        assert scene.solve().asString() == "Invalid goal"
        assert "within the bounds" in scene.planner.reason

    def test_what_needs_a_roadmap_of_risk(self):
        scene = Scene(iterations=150)
        scene.solve()
        for wrong in (scene.planner.alternatives, scene.planner.pareto):
            with pytest.raises(ArgumentError, match="space-time"):
                wrong()

    def test_a_goal_farther_than_flight_can_come(self):
        scene = Scene(end=7.9)
        assert scene.solve().asString() == "Invalid goal"
        assert "straight flight at vMax = 10 m/s arrives at t = 8 s" in scene.planner.reason

    def test_a_goal_that_is_never_free(self):
        flat = TerrainClearance(Terrain(np.full((11, 11), 20.0), spacing=(10.0, 10.0)), 1.0)
        scene = Scene(MovingClearance(door(), static=flat)).between((10, 50, 50, 0), (90, 50, 9, 0))
        assert scene.solve().asString() == "Invalid goal"
        assert scene.planner.reason == "the goal is never free until t = 60 s"


def test_a_path_of_another_planner_that_arrives_earlier_stays():
    away = MovingSphere(1.0, [0, 1], [[0, 0, 500]] * 2)
    scene = Scene(MovingClearance(away), iterations=250)
    scene.setup.setup()
    problem = scene.setup.getProblemDefinition()
    for last, stays in ((7.0, True), (30.0, False)):
        problem.clearSolutionPaths()
        theirs = og.PathGeometric(scene.si)
        theirs.append(scene.state((10, 50, 50, 0)))
        theirs.append(scene.state((90, 50, 50, last)))
        problem.addSolutionPath(theirs, False, -1.0, "other")
        scene.planner.clear()
        scene.solve()
        assert (scene.flown.t[-1] == last) == stays
