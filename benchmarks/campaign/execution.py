"""Carry out one run: OMPL in, a record's result out."""

from __future__ import annotations

import math
import resource
import sys
import warnings
from enum import Enum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from benchmarks.campaign.curve import Watch
from benchmarks.campaign.metrics import judge
from benchmarks.campaign.objectives import OBJECTIVES
from benchmarks.campaign.planners import PLANNERS
from benchmarks.campaign.run import Run, prepared
from ompl_risk import ClearanceMotionValidator, ClearanceValidityChecker, Trajectory
from ompl_risk.errors import TrapWarning
from ompl_risk.planners import Problem

REHEARSAL = 0.3
"""Processor seconds of planning before the clock starts: no run pays for imports or compilation."""


class Status(str, Enum):
    """How a run ended."""

    SOLVED = "solved"
    UNSOUND = "unsound"  # the planner's path is not free, or leads elsewhere
    NO_PATH = "no path"
    FAILED = "failed"  # an exception, or the death of the process


class Solved(NamedTuple):
    """What is left of a planner that has run."""

    corners: NDArray[np.float64]
    cost: float
    seconds: float
    wall_seconds: float
    curve: list[tuple[float, float]]


def execute(run: Run) -> dict[str, Any]:
    """Plan and judge, in this process.

    Returns:
        A result fit for JSON: status, reason, processor seconds of the planner and those on the
        wall, the process's memory [MiB], cost of its path and the path, metrics, and the curve.
    """
    try:
        found = _plan(run, REHEARSAL) and _plan(run, run.seconds)
        return result(run, found)
    except Exception as error:
        return failure(f"{type(error).__name__}: {error}".splitlines()[0])


def failure(reason: str) -> dict[str, Any]:
    """The result of a run that came to nothing."""
    return {"status": Status.FAILED.value, "reason": reason}


def result(run: Run, found: Solved) -> dict[str, Any]:
    """The result of a planner that ran, with its path judged."""
    facts: dict[str, Any] = {
        "seconds": round(found.seconds, 4),
        "wall seconds": round(found.wall_seconds, 4),
        "memory": round(_memory(), 1),
        "curve": [(round(t, 4), cost) for t, cost in found.curve if math.isfinite(cost)],
    }
    if not len(found.corners):
        return {"status": Status.NO_PATH.value, "reason": "no exact solution in time", **facts}
    sound, values = judge(prepared(run.scene), found.corners)
    return {
        "status": (Status.SOLVED if sound else Status.UNSOUND).value,
        "reason": ""
        if sound
        else "not free of collision by the exact check, or not from start to goal within the box",
        **facts,
        "cost": found.cost,
        "length": float(np.linalg.norm(np.diff(found.corners, axis=0), axis=1).sum()),
        "metrics": values,
        "path": found.corners.tolist(),
    }


def _plan(run: Run, seconds: float) -> Solved:
    """Run the planner on everything made anew."""
    ou.setLogLevel(ou.LOG_NONE)  # also hides the complaint about being seeded a second time
    ou.RNG.setSeed(run.seed)
    problem, planner = prepared(run.scene).problem, PLANNERS[run.planner]
    setup = _setup(problem)
    si = setup.getSpaceInformation()
    objective = OBJECTIVES[run.objective].build(si, problem)
    setup.setOptimizationObjective(objective)
    solver = planner.build(si, run.seed)
    setup.setPlanner(solver)
    setup.setup()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrapWarning)  # the path is judged here anyway
        watch = Watch(seconds, lambda: planner.best(solver))
        setup.solve(ob.PlannerTerminationCondition(watch))
    wall, took = watch.read()
    curve = planner.curve(solver, watch)
    definition = setup.getProblemDefinition()
    if not definition.hasExactSolution():
        return Solved(np.empty((0, 3)), math.inf, took, wall, curve)
    path = definition.getSolutionPath()
    cost = path.cost(objective).value()
    if not curve or cost < curve[-1][1] * (1.0 - 1e-9):  # else it is the last one, added up anew
        curve.append((took, cost))
    corners = np.array(Trajectory.from_path(path, speed=problem.speed).positions)
    return Solved(corners, cost, took, wall, curve)


def _setup(problem: Problem) -> Any:
    space, bounds = ob.RealVectorStateSpace(3), ob.RealVectorBounds(3)
    for k in range(3):
        bounds.setLow(k, float(problem.low[k]))
        bounds.setHigh(k, float(problem.high[k]))
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, problem.obstacles))
    si.setMotionValidator(ClearanceMotionValidator(si, problem.obstacles))
    start: Any = si.allocState()
    goal: Any = si.allocState()
    start[0:3], goal[0:3] = problem.start.tolist(), problem.goal.tolist()
    setup.setStartAndGoalStates(start, goal)
    return setup


def _memory() -> float:
    """Greatest memory of this process so far [MiB]."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (2**20 if sys.platform == "darwin" else 2**10)
