"""Run a task: OMPL in, positions out."""

from __future__ import annotations

import math
import threading
import time
import warnings
from itertools import pairwise
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker
from ompl_risk.errors import TrapWarning
from ompl_risk.motion import Risk, motion_model
from ompl_risk.planners.criteria import Length
from ompl_risk.planners.methods import Heeds
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.searching import Budget, search_of
from ompl_risk.planners.shortcut import MotionCost, shortcut
from ompl_risk.planners.task import Candidate, Status, Task


def solve_task(problem: Problem, task: Task) -> Candidate:
    """Plan a candidate; the same problem and task give the same path.

    OMPL's random numbers are seeded anew, for the whole process; its log is silent meanwhile. So
    tasks of several threads wait for each other.

    Args:
        problem: what to plan.
        task: by which planner, criterion, seed and budget.

    Returns:
        The candidate. An exception is no exception here but a candidate without a path, with the
        reason; only KeyboardInterrupt and the like pass through.
    """
    with ONE_AT_A_TIME:
        return _quietly(problem, task)


ONE_AT_A_TIME = threading.RLock()


def _quietly(problem: Problem, task: Task) -> Candidate:
    begin, log_level = time.monotonic(), ou.getLogLevel()
    ou.setLogLevel(ou.LOG_NONE)  # also hides the complaint about being seeded a second time
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TrapWarning)  # the path is checked here anyway
            return _solve(problem, task)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}".splitlines()[0]
        return Candidate(task, Status.FAILED, seconds=time.monotonic() - begin, reason=reason)
    finally:
        ou.setLogLevel(log_level)


def motion_cost(problem: Problem, risk: Risk | None) -> MotionCost:
    """Cost of straight motions: by `risk`, or their length; inf if one may not be flown."""
    gate = motion_model(problem.obstacles, Risk(speed=1.0))
    model = gate if risk is None else motion_model(problem.clearance, risk)

    def cost(a: FloatArray, b: FloatArray) -> float:
        gate.a[:], gate.b[:] = a, b
        if not gate.is_motion_free():
            return float("inf")
        if risk is None:
            return float(np.linalg.norm(b - a))
        model.a[:], model.b[:] = a, b
        return model.cost()

    return cost


def _solve(problem: Problem, task: Task) -> Candidate:
    ou.RNG.setSeed(task.seed)
    method, setup = task.method, _setup(problem, task)
    budget = Budget(math.inf if method.counts_itself else task.iterations, task.time_limit)
    corners = search_of(method).path(setup, problem, task, budget)
    used = task.iterations if method.counts_itself else budget.used - 1
    facts: dict[str, Any] = {"iterations": max(used, 0), "timed_out": budget.timed_out}
    if corners is None:
        reason = f"no path in {facts['iterations']} iterations"
        return Candidate(task, Status.NO_PATH, seconds=budget.seconds, reason=reason, **facts)
    cost = motion_cost(problem, task.criterion.risk(problem))
    if fault := _fault(corners, problem, cost):
        reason = f"the path that the planner calls a solution {fault}"
        return Candidate(task, Status.NO_PATH, seconds=budget.seconds, reason=reason, **facts)
    positions = shortcut(corners, cost)
    return Candidate(
        task,
        Status.SOLVED,
        positions=positions,
        length=float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum()),
        seconds=budget.seconds,
        **facts,
    )


def _fault(corners: FloatArray, problem: Problem, cost: MotionCost) -> str:
    """What is wrong with a path; nobody's word is taken for it."""
    if not (np.allclose(corners[0], problem.start) and np.allclose(corners[-1], problem.goal)):
        return "does not lead from the start to the goal"
    slack = 1e-9 * np.abs(problem.high - problem.low)
    if ((corners < problem.low - slack) | (corners > problem.high + slack)).any():
        return "leaves the box that paths may use"
    if not all(math.isfinite(cost(a, b)) for a, b in pairwise(corners)):
        return "is not free"
    return ""


def _setup(problem: Problem, task: Task) -> Any:
    space = ob.RealVectorStateSpace(3)
    bounds = ob.RealVectorBounds(3)
    for k in range(3):
        bounds.setLow(k, float(problem.low[k]))
        bounds.setHigh(k, float(problem.high[k]))
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, problem.obstacles))
    si.setMotionValidator(ClearanceMotionValidator(si, problem.obstacles))
    # OMPL warns about an objective that its planner does not look at, and a roadmap hangs on one
    blind = task.method.roadmap or task.heeds is not Heeds.CRITERION
    setup.setOptimizationObjective((Length() if blind else task.criterion).objective(si, problem))
    start: Any = si.allocState()
    goal: Any = si.allocState()
    start[0:3], goal[0:3] = problem.start.tolist(), problem.goal.tolist()
    setup.setStartAndGoalStates(start, goal)
    return setup
