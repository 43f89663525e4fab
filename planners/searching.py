"""Let an OMPL planner search: a budget in, a path out."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from ompl import base as ob

from ompl_risk._arrays import FloatArray
from ompl_risk.motion import motion_batch
from ompl_risk.planners.methods import Method
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.task import Task
from ompl_risk.trajectory import Trajectory


class Budget:
    """Counts how often a planner asks whether to stop, which it does once an iteration.

    Args:
        iterations: questions after which to stop; inf for a planner that counts them itself.
        time_limit: seconds after which to stop [s].
    """

    CLOCK_EVERY = 64  # reading the clock each time would cost more than some iterations

    def __init__(self, iterations: float, time_limit: float) -> None:
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


class Search(ABC):
    """How the path comes out of a planner."""

    @abstractmethod
    def path(self, setup: Any, problem: Problem, task: Task, budget: Budget) -> FloatArray | None:
        """Corners of the path found [m], shape (n, 3); None if none is found.

        Args:
            setup: an `og.SimpleSetup` with everything but the planner.
            problem: what is planned.
            task: by which planner and criterion.
            budget: when to stop.
        """


class Solve(Search):
    """By the planner's `solve`."""

    def path(self, setup: Any, problem: Problem, task: Task, budget: Budget) -> FloatArray | None:
        """As OMPL's own; an approximate solution is none."""
        si = setup.getSpaceInformation()
        setup.setPlanner(task.method.planner(si, task.seed, task.iterations))
        setup.solve(ob.PlannerTerminationCondition(budget))
        if not setup.haveExactSolutionPath():
            return None
        return Trajectory.from_path(setup.getSolutionPath(), speed=problem.speed).positions


class Grow(Search):
    """By a roadmap that OMPL grows and that is searched here.

    PRM's `solve` looks for paths in a second thread, which hangs if anything is written in Python,
    and which makes the outcome a matter of timing. Growing has neither fault, and the criterion
    needs to be known only afterwards.
    """

    def path(self, setup: Any, problem: Problem, task: Task, budget: Budget) -> FloatArray | None:
        """The best path through the roadmap."""
        si = setup.getSpaceInformation()
        planner = task.method.planner(si, task.seed, task.iterations)
        setup.setPlanner(planner)
        setup.setup()
        planner.solve(ob.plannerAlwaysTerminatingCondition())  # makes milestones of start and goal
        planner.growRoadmapPtc(ob.PlannerTerminationCondition(budget))
        data = ob.PlannerData(si)
        planner.getPlannerData(data)
        return best_path(data, problem, task)


def search_of(method: Method) -> Search:
    """The way to run a planner."""
    return Grow() if method.roadmap else Solve()


def best_path(data: Any, problem: Problem, task: Task) -> FloatArray | None:
    """The best path by a task's criterion through OMPL's `ob.PlannerData`; None if there is none.

    All its edges may be flown: OMPL has checked them.
    """
    n = data.numVertices()
    places = np.array([data.getVertex(v).getState()[0:3] for v in range(n)])
    pairs = [(v, w) for v in range(n) for w in data.getEdges(v) if v < w]
    if not pairs or not data.numStartVertices() or not data.numGoalVertices():
        return None
    ends = np.array(pairs)
    a, b = places[ends[:, 0]], places[ends[:, 1]]
    weight = _costs(a, b, problem, task)
    graph = Graph.of_edges(n, ends, np.zeros(len(ends)), np.linalg.norm(b - a, axis=1))
    way = graph.tree(data.getStartIndex(0), weight).vertices(data.getGoalIndex(0))
    return places[way] if len(way) else None


def _costs(a: FloatArray, b: FloatArray, problem: Problem, task: Task) -> FloatArray:
    risk = task.criterion.risk(problem)
    if risk is None:
        return np.linalg.norm(b - a, axis=1)
    return motion_batch(problem.clearance, risk).costs(a, b)
