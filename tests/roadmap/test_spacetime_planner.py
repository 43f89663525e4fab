"""Earliest arrival through OMPL: SimpleSetup over space-time, checkers, paths, wrong use."""

import itertools
import math

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from timed_scene import END, FASTEST, Scene, door

from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingSphere
from ompl_risk.clearance.terrain import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.spacetime.growing import LIMIT, TimedRoadmap
from ompl_risk.planners.spacetime.stays import Hovering
from ompl_risk.terrains import Terrain


def pendulum():
    """A ball that sweeps the wall's only gap."""
    t = np.arange(0.0, 61.0, 4.0)
    return MovingSphere(8.0, t, [[50, 50 + 30 * (-1) ** k, 50] for k in range(len(t))])


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
