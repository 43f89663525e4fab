"""Runs of planners that record when they reached which cost."""

from __future__ import annotations

import math
import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from benchmarks.planning import Problem, as_state
from ompl_risk import (
    ClearanceMotionValidator,
    ClearanceValidityChecker,
    InverseDistance,
    RiskObjective,
    Sobolev,
    TerrainClearance,
    Trajectory,
    terrains,
)

Floats = NDArray[np.float64]
Name = Literal["RiskRoadmap", "RRTstar", "BITstar"]


@dataclass(frozen=True)
class Run:
    """What a planner reached, and when.

    Attributes:
        history: seconds and cost of every better path, in this order, shape (n, 2).
        corners: of the last path [m], shape (k, 3); empty without one.
    """

    history: Floats
    corners: Floats

    @property
    def cost(self) -> float:
        """Of the last path, by the planner's own account; inf without one."""
        return float(self.history[-1, 1]) if len(self.history) else math.inf

    def seconds_to(self, cost: float) -> float:
        """When a cost was reached, or a better one; inf if never."""
        reached = self.history[self.history[:, 1] <= cost, 0]
        return float(reached[0]) if len(reached) else math.inf


class Recording(RiskObjective):
    """``RiskObjective`` that writes down when OMPL shows it a better path.

    Planners ask ``isSatisfied`` about every better path; never satisfied, they go on.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.start()

    def start(self) -> float:
        """Forget what was written down, and count from now; what the clock says."""
        self.rows: list[tuple[float, float]] = []
        self.begin = time.thread_time()
        return self.begin

    def isSatisfied(self, cost: ob.Cost) -> bool:
        """Write the cost down; no."""
        value = cost.value()
        if value < (self.rows[-1][1] if self.rows else math.inf):
            self.rows.append((time.thread_time() - self.begin, value))
        return False


def run(name: Name, problem: Problem, seconds: float, seed: int) -> Run:
    """Run a planner on a problem, everything made anew.

    OMPL's planners get seconds of processor time, so that they have all of it on a busy machine;
    ``RiskRoadmap`` uses several threads and gets seconds on the wall.
    """
    ou.setLogLevel(ou.LOG_NONE)
    ou.RNG.setSeed(seed + 1)  # OMPL refuses 0
    terrain = terrains.load(problem.terrain)
    setup = og.SimpleSetup(problem.space(terrain))
    si = setup.getSpaceInformation()
    clearance = TerrainClearance(terrain, problem.radius)
    setup.setStateValidityChecker(ClearanceValidityChecker(si, clearance))
    si.setMotionValidator(ClearanceMotionValidator(si, clearance))
    start, goal = (as_state(si, end) for end in problem.ends(terrain))
    setup.setStartAndGoalStates(start, goal)
    given = si, clearance, InverseDistance(problem.d0), Sobolev(1)
    if name == "RiskRoadmap":
        history = _roadmap(setup, RiskObjective(*given, speed=problem.speed), seconds, seed)
    else:
        objective = Recording(*given, speed=problem.speed)
        _ = objective.motionCost(start, goal), si.checkMotion(start, goal)  # compiles
        history = _ompl(name, setup, objective, seconds)
    definition = setup.getProblemDefinition()
    corners = np.empty((0, 3))
    if definition.hasExactSolution():
        path = definition.getSolutionPath()
        corners = np.array(Trajectory.from_path(path, speed=problem.speed).positions)
    return Run(history, corners)


def in_process(name: Name, problem: Problem, seconds: float, seed: int) -> Run:
    """The same in a process of its own, as fresh as can be."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(run, name, problem, seconds, seed).result()


def _ompl(name: Name, setup: og.SimpleSetup, objective: Any, seconds: float) -> Floats:
    setup.setOptimizationObjective(objective)
    planner: Any = getattr(og, name)(setup.getSpaceInformation())
    setup.setPlanner(planner)
    setup.setup()
    begin = objective.start()
    setup.solve(ob.PlannerTerminationCondition(lambda: time.thread_time() - begin >= seconds))
    return _table([row for row in objective.rows if math.isfinite(row[1])])


def _roadmap(setup: og.SimpleSetup, objective: Any, seconds: float, seed: int) -> Floats:
    from ompl_risk.planners.roadmap.planner import RiskRoadmap

    setup.setOptimizationObjective(objective)
    planner = RiskRoadmap(setup.getSpaceInformation(), seed=seed)
    setup.setPlanner(planner)
    setup.setup()  # compiles
    setup.solve(seconds)
    return _table([(row.seconds, row.cost) for row in planner.history])


def _table(rows: list[tuple[float, float]]) -> Floats:
    return np.array(rows, dtype=np.float64).reshape(-1, 2)
