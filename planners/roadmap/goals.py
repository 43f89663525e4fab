"""Goal states from OMPL's goals."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from ompl import base as ob

from ompl_risk._arrays import FloatArray

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
        self._goal, self._inputs, self._numbers = problem.getGoal(), inputs, numbers
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

    def first(self) -> list[FloatArray]:
        """The states to begin with."""
        return self._next(FIRST) if self._has_states else []

    def later(self) -> list[FloatArray]:
        """Further states, if it is time for some."""
        if time.monotonic() < self._last + PAUSE:
            return []
        self._last = time.monotonic()
        return self._next(LATER)

    def _next(self, most: int) -> list[FloatArray]:
        found: list[FloatArray] = []
        while len(found) < most and self._inputs.getSampledGoalsCount() < MOST:
            if not self._inputs.haveMoreGoalStates():
                break
            state = self._inputs.nextGoal()
            if state is None:
                break
            found.append(self._numbers(state))
        return found
