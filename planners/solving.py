"""Run a task: OMPL in, positions out."""

from __future__ import annotations

import math
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
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.shortcut import MotionCost, shortcut
from ompl_risk.planners.task import Candidate, Status, Task
from ompl_risk.trajectory import Trajectory


def solve_task(problem: Problem, task: Task) -> Candidate:
    """Plan a candidate; the same problem and task give the same path.

    OMPL's random numbers are seeded anew, for the whole process; its log is silent meanwhile.

    Args:
        problem: what to plan.
        task: by which planner, criterion, seed and budget.

    Returns:
        The candidate. An exception is no exception here but a candidate without a path, with the
        reason; only KeyboardInterrupt and the like pass through.
    """
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


class Budget:
    """Counts how often a planner asks whether to stop, which it does once an iteration."""

    CLOCK_EVERY = 64  # reading the clock each time would cost more than some iterations

    def __init__(self, iterations: int, time_limit: float) -> None:
        self.begin = time.monotonic()
        self.used, self.timed_out = 0, False
        self._iterations, self._end = iterations, self.begin + time_limit

    def __call__(self) -> bool:
        """Whether to stop."""
        self.used += 1
        if self.used % self.CLOCK_EVERY == 0 and time.monotonic() > self._end:
            self.timed_out = True
        return self.timed_out or self.used > self._iterations

    @property
    def seconds(self) -> float:
        """Time since the start [s]."""
        return time.monotonic() - self.begin


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
    setup = _setup(problem, task)
    budget = Budget(task.iterations, task.time_limit)
    setup.solve(ob.PlannerTerminationCondition(budget))
    facts: dict[str, Any] = {"iterations": budget.used - 1, "timed_out": budget.timed_out}
    if not setup.haveExactSolutionPath():
        reason = f"no path in {budget.used - 1} iterations"
        return Candidate(task, Status.NO_PATH, seconds=budget.seconds, reason=reason, **facts)
    path = Trajectory.from_path(setup.getSolutionPath(), speed=problem.speed)
    cost = motion_cost(problem, task.criterion.risk(problem))
    if not all(math.isfinite(cost(a, b)) for a, b in pairwise(path.positions)):
        reason = "the path that the planner calls a solution is not free"
        return Candidate(task, Status.NO_PATH, seconds=budget.seconds, reason=reason, **facts)
    positions = shortcut(path.positions, cost)
    return Candidate(
        task,
        Status.SOLVED,
        positions=positions,
        length=float(np.linalg.norm(np.diff(positions, axis=0), axis=1).sum()),
        seconds=budget.seconds,
        **facts,
    )


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
    setup.setOptimizationObjective(task.criterion.objective(si, problem))
    start: Any = si.allocState()
    goal: Any = si.allocState()
    start[0:3], goal[0:3] = problem.start.tolist(), problem.goal.tolist()
    setup.setStartAndGoalStates(start, goal)
    setup.setPlanner(getattr(og, task.planner)(si))
    return setup
