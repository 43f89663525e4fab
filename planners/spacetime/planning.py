"""Planning in OMPL's space-time: what ``RiskRoadmap`` does where obstacles move."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import geometric as og

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, read_path
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.bridge.timed import TimedReader
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.moving import moves
from ompl_risk.planners.roadmap.anytime import Progress
from ompl_risk.planners.roadmap.goals import FIRST as GOALS
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.roadmap.setting import bounds_of
from ompl_risk.planners.spacetime.earliest import RESOLUTION
from ompl_risk.planners.spacetime.growing import FIRST, TimedRoadmap
from ompl_risk.planners.spacetime.route import TimedRoute
from ompl_risk.planners.spacetime.stays import Hovering, Passing, Stays

CHECKER = (
    "a ClearanceValidityChecker(si, clearance) over a MovingClearance: the planner asks the "
    "clearance when places are free"
)

COARSE, FINEST = 32, 0.05
"""Bins of time in which the first search of a vehicle that cannot wait tells arrivals apart, and
the shortest bins that later ones come to [s]."""


class SpaceTimePlanning:
    """Plans the earliest arrival for a problem over ``ob.SpaceTimeStateSpace``.

    The vehicle flies at ``vMax`` of the space. It starts at the time of the start state and must
    arrive before the upper bound of the space's time; the time of a goal state is not looked at,
    as in OMPL's own planners for space-time.

    Args:
        si: over an ``ob.SpaceTimeStateSpace`` of R^3 with bounds in space and time.
        seed: of the samples.
        steering: none but the straight one can be had.
        can_wait: whether the vehicle can hover.
        threads: at most so many; None uses all processors.

    Raises:
        ArgumentError: another space, or a steering.

    Attributes:
        reason: why there is no path, in words.
        history: a row for each better path; its cost is the arrival [s].
    """

    def __init__(
        self,
        si: Any,
        *,
        seed: int,
        steering: Any = None,
        can_wait: bool = True,
        threads: int | None = None,
    ) -> None:
        self._space: Any = si.getStateSpace()
        TimedReader(self._space)
        if steering is not None:
            kind, allowed = type(steering).__name__, "left out in space-time: edges are straight"
            raise ArgumentError("steering", kind, allowed)
        self._si, self._seed, self._threads = si, seed, threads
        self._can_wait = bool(can_wait)
        self._buffer = Buffer(4)
        self.clear()

    def clear(self) -> None:
        """Forget the problem and what was found."""
        self._starts: list[FloatArray] = []
        self._goals: list[FloatArray] = []
        self._roadmap: TimedRoadmap | None = None
        self._path: Any = None
        self._seconds, self._latest = 0.0, math.inf
        self.reason = ""
        self.history: list[Progress] = []

    def warm_up(self) -> None:
        """Compile, so that ``solve`` spends its time on planning."""
        clearance, box = moving_clearance(self._si), self._box()
        a, b = box.low[None], box.high[None]
        clearance.approach(a, np.zeros(1), b, np.ones(1), tolerance=1.0)
        clearance.are_free(a, np.zeros(1), b, np.ones(1))
        clearance.free_intervals(a, 0.0, 1.0, resolution=1.0)

    @property
    def route(self) -> TimedRoute | None:
        """The route that arrives first so far."""
        return None if self._roadmap is None else self._roadmap.best

    def solve(
        self, problem: Any, inputs: Any, condition: Callable[[], bool], samples: int | None
    ) -> Any:
        """Plan until the condition holds, or nothing is left to gain; the planner's status.

        Args:
            problem: the ``ob.ProblemDefinition``.
            inputs: the planner's ``ob.PlannerInputStates``.
            condition: whether to stop.
            samples: places to sample at most; None for no limit.

        Raises:
            ArgumentError: no bounds, an objective, or a checker that is not this library's over a
                clearance that moves.
        """
        if problem.getOptimizationObjective() is not None:
            kind = type(problem.getOptimizationObjective()).__name__
            allowed = "left out: in space-time the earliest arrival is what is planned"
            raise ArgumentError("objective", kind, allowed)
        wrong = self._read_ends(problem, inputs)
        if wrong is not None:
            return ob.PlannerStatus(wrong)
        roadmap = self._opened()
        self.reason = self._impossible(roadmap)
        if self.reason:
            return ob.PlannerStatus(ob.PlannerStatus.INVALID_GOAL)
        most = roadmap.sampled + samples if samples is not None else None
        began = time.perf_counter()
        while not (condition() or roadmap.nothing_to_gain()):
            more = max(roadmap.n, FIRST)
            more = more if most is None else min(more, most - roadmap.sampled)
            if more <= 0:
                break
            roadmap.grow(more)
            for work in (roadmap.search, roadmap.improve):
                if work(condition):
                    seconds = self._seconds + time.perf_counter() - began
                    self._note(problem, roadmap, seconds)
        self._seconds += time.perf_counter() - began
        if roadmap.best is None:
            self.reason = _reason(roadmap)
        return ob.PlannerStatus(roadmap.best is not None, False)

    def _opened(self) -> TimedRoadmap:
        if self._roadmap is None:
            clock = self._space.getTimeComponent()
            if not clock.isBounded():
                allowed = "bounded: space.setTimeBounds(0, T)"
                raise ArgumentError("time of si.getStateSpace()", "without bounds", allowed)
            self._latest = float(clock.getMaxTimeBound())
            starts, goals = np.array(self._starts), np.array(self._goals)
            self._roadmap = TimedRoadmap(
                self._box(),
                moving_clearance(self._si),
                starts[:, :3],
                starts[:, 3],
                goals[:, :3],
                speed=float(self._space.getVMax()),
                latest=self._latest,
                stays=self._stays,
                seed=self._seed,
                threads=self._threads,
            )
        return self._roadmap

    def _impossible(self, roadmap: TimedRoadmap) -> str:
        """Why no roadmap, however large, could have a path; empty if it may."""
        if roadmap.earliest > self._latest:
            return (
                f"straight flight at vMax = {self._space.getVMax():g} m/s arrives at "
                f"t = {roadmap.earliest:.6g} s, but time ends at {self._latest:g} s"
            )
        goals, begin = np.array(self._goals)[:, :3], min(float(one[3]) for one in self._starts)
        spans = moving_clearance(self._si).free_intervals(
            goals, begin, self._latest, resolution=RESOLUTION
        )
        return "" if any(spans) else f"the goal is never free until t = {self._latest:g} s"

    def _box(self) -> Region:
        return Region(*bounds_of(self._space.getSpaceComponent()), seed=self._seed)

    def _stays(self, search: int) -> Stays:
        """Whether the vehicle may wait; if not, every search tells times apart more finely."""
        if self._can_wait:
            return Hovering()
        span = self._latest - min(float(start[3]) for start in self._starts)
        return Passing(max(span / COARSE / 2**search, FINEST))

    def _read_ends(self, problem: Any, inputs: Any) -> Any:
        """Take in starts and goals; the status to return if there is none, and say why."""
        while (state := inputs.nextStart()) is not None:
            self._starts.append(self._row(state))
        if not self._starts:
            self.reason = "no start state that is within the bounds and free at its time"
            return ob.PlannerStatus.INVALID_START
        goal = problem.getGoal()
        if not isinstance(goal, ob.GoalSampleableRegion):
            self.reason = f"the goal, {type(goal).__name__}, gives no states: use a GoalState"
            return ob.PlannerStatus.UNRECOGNIZED_GOAL_TYPE
        if not self._goals:
            self._goals = self._goal_states(goal)
        if not self._goals:
            self.reason = "no goal state that is within the bounds"
            return ob.PlannerStatus.INVALID_GOAL
        return None

    def _goal_states(self, goal: Any) -> list[FloatArray]:
        """Places of the goal: whether they are free depends on when the vehicle arrives."""
        state, found, box = self._si.allocState(), {}, self._box()
        for _ in range(min(int(goal.maxSampleCount()), GOALS)):
            goal.sampleGoal(state)
            row = self._row(state)
            if np.all((row[:3] >= box.low) & (row[:3] <= box.high)):
                found[tuple(row[:3])] = row
        return list(found.values())

    def _row(self, state: Any) -> FloatArray:
        self._space.serialize(self._buffer.capsule, state)
        return self._buffer.numbers.copy()

    def _note(self, problem: Any, roadmap: TimedRoadmap, seconds: float) -> None:
        """Keep the history, and make the best route OMPL's solution."""
        best = roadmap.best
        if best is None:
            return
        counts = roadmap.n, roadmap.edges, roadmap.evaluated
        self.history.append(Progress(seconds, best.arrival, *counts))
        self.reason = ""
        path = self.path(best)
        if problem.hasExactSolution():
            there = problem.getSolutionPath()
            if there is not self._path and read_path(there).t[-1] <= best.arrival:
                return
        problem.clearSolutionPaths()
        problem.addSolutionPath(path, False, -1.0, "RiskRoadmap")
        self._path = path

    def path(self, route: TimedRoute) -> og.PathGeometric:
        """A route as OMPL's path; a stay is two states at one place."""
        path = og.PathGeometric(self._si)
        for position, at in zip(route.positions, route.times, strict=True):
            state = self._si.allocState()
            self._buffer.numbers[:3], self._buffer.numbers[3] = position, at
            self._space.deserialize(state, self._buffer.capsule)
            path.append(state)
        return path


def _reason(roadmap: TimedRoadmap) -> str:
    outcome = roadmap.outcome
    if outcome is None or outcome.stopped:
        return f"no path found in time; {roadmap.n} places were sampled"
    return f"in a roadmap of {roadmap.n} places: {outcome.reason}"


def moving_clearance(si: Any) -> Any:
    """The moving clearance that OMPL's checker, and its motion validator, go by.

    Args:
        si: in space-time.

    Raises:
        ArgumentError: a checker or validator that is not this library's, or of another clearance.
    """
    checker, validator = si.getStateValidityChecker(), si.getMotionValidator()
    if type(checker) is not ClearanceValidityChecker or not moves(checker.obstacles):
        raise ArgumentError("si.getStateValidityChecker()", type(checker).__name__, CHECKER)
    if type(validator) is ClearanceMotionValidator:
        if validator.obstacles is not checker.obstacles:
            allowed = "one with the clearance of the validity checker"
            raise ArgumentError("si.getMotionValidator()", type(validator).__name__, allowed)
    elif type(validator) is not ob.MotionValidator:
        allowed = "OMPL's own, or a ClearanceMotionValidator"
        raise ArgumentError("si.getMotionValidator()", type(validator).__name__, allowed)
    return checker.obstacles
