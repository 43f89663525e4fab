"""RiskRoadmap as OMPL's users meet it: what it finds, and when it ends."""

import math
import time

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from planner_scene import Scene, found, once
from scene import SPEED, ends

from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory


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


def test_a_condition_may_wait_for_the_first_solution():
    scene = Scene().usual()
    problem = scene.setup.getProblemDefinition()
    scene.solve(once(problem.hasExactSolution))
    assert len(scene.planner.history) <= 5
    assert scene.setup.haveExactSolutionPath()
