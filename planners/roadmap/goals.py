"""Goal states from OMPL's goals."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from ompl import base as ob

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.roadmap.roadmap import Roadmap

FIRST = 16
"""States taken before planning starts."""

LATER = 4
"""States taken at a time while planning goes on."""

PAUSE = 0.05
"""Seconds between these."""

MOST = 256
"""States taken in all, from a region that could give any number."""


class GoalSource:
    """The states of a goal: one, several, or samples of a region.

    Args:
        problem: the ``ob.ProblemDefinition``.
        inputs: the planner's ``ob.PlannerInputStates``.
        numbers: reads a state.
    """

    def __init__(self, problem: Any, inputs: Any, numbers: Callable[[Any], FloatArray]) -> None:
        self._goal, self.inputs, self._numbers = problem.getGoal(), inputs, numbers
        self._last = time.monotonic()

    @property
    def _has_states(self) -> bool:
        return isinstance(self._goal, ob.GoalSampleableRegion)

    @property
    def status(self) -> Any:
        """The planner's status if there is no goal state."""
        if self._has_states:
            return ob.PlannerStatus.INVALID_GOAL
        return ob.PlannerStatus.UNRECOGNIZED_GOAL_TYPE

    @property
    def reason(self) -> str:
        """Why there is no goal state."""
        if self._has_states:
            return "no goal state that is within the bounds and free"
        kind = type(self._goal).__name__
        return (
            f"the goal, {kind}, gives no states: use GoalState, GoalStates or a sampleable region"
        )

    def first(self, until: Callable[[], bool]) -> list[FloatArray]:
        """The states to begin with: all of several, some of a region.

        Args:
            until: whether to give up, while a region has given none that is free.
        """
        if not self._has_states:
            return []
        found = self._next(MOST if isinstance(self._goal, ob.GoalStates) else FIRST)
        while not found and self.inputs.haveMoreGoalStates() and not until():
            found = self._next(1)
        return found

    def later(self) -> list[FloatArray]:
        """Further states, if it is time for some."""
        if not self._has_states or time.monotonic() < self._last + PAUSE:
            return []
        self._last = time.monotonic()
        return self._next(LATER) if self.inputs.getSampledGoalsCount() < MOST else []

    def _next(self, most: int) -> list[FloatArray]:
        """At most so many states, from as many attempts: some may not be free."""
        found: list[FloatArray] = []
        for _ in range(most):
            if not self.inputs.haveMoreGoalStates():
                break
            state = self.inputs.nextGoal()
            if state is not None:
                found.append(self._numbers(state))
        return found


class Ends:
    """New starts and goals of a problem, on their way into a roadmap."""

    def __init__(self) -> None:
        self._starts: list[FloatArray] = []
        self._goals: list[FloatArray] = []

    def add_to(
        self,
        roadmap: Roadmap,
        goals: GoalSource,
        row: Callable[[Any], FloatArray],
        until: Callable[[], bool],
    ) -> tuple[Any, str] | None:
        """Take in starts and goals; the status to return if there is none, and why.

        Args:
            roadmap: what they are added to.
            goals: of the problem.
            row: reads a state.
            until: whether to give up, while a region has given no goal that is free.
        """
        while (state := goals.inputs.nextStart()) is not None:
            self._starts.append(row(state))
        self._goals += goals.first(until)
        # Kept until they have been taken in: a clearance may raise, and OMPL gives each only once.
        if self._starts:
            roadmap.add_starts(np.array(self._starts))
            self._starts = []
        if self._goals:
            roadmap.add_goals(np.array(self._goals))
            self._goals = []
        if not roadmap.starts:
            reason = "no start state that is within the bounds and free"
            return ob.PlannerStatus.INVALID_START, reason
        return None if roadmap.goals else (goals.status, goals.reason)
