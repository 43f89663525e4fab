"""RiskRoadmap and the goals that OMPL knows: states, regions, poses, none at all."""

import math

import numpy as np
import pytest
from ompl import base as ob
from planner_scene import Scene
from scene import CEILING, SPEED, ends

from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory


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
