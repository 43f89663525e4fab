"""Flights as OMPL's paths and solutions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from ompl import control as oc

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.helicopter.model import CONTROL, STATE
from ompl_risk.planners.sst.tree import Flight


class PathWriter:
    """Makes OMPL's paths.

    Args:
        si: an ``oc.SpaceInformation`` of the helicopter.
    """

    def __init__(self, si: Any) -> None:
        self._si, self._states, self._controls = si, si.getStateSpace(), si.getControlSpace()
        self._state, self._control = Buffer(STATE), Buffer(CONTROL)
        self._held = si.allocControl()  # leaks in OMPL 2.0.1: one for all

    def path(self, flight: Flight, hold: int, longest: int) -> oc.PathControl:
        """A flight as a path: one row for as long as an input is held.

        Args:
            flight: to be written.
            hold: steps for which every input is held.
            longest: steps for which an input may be held, a multiple of ``hold``.
        """
        path, dt = oc.PathControl(self._si), float(self._si.getPropagationStepSize())
        for first, last in runs(flight.controls, hold, longest):
            self._control.numbers[:] = flight.controls[first]
            self._controls.deserialize(self._held, self._control.capsule)
            path.append(self._new_state(flight.states[first]), self._held, (last - first) * dt)
        path.append(self._new_state(flight.states[-1]))
        return path

    def _new_state(self, numbers: FloatArray) -> Any:
        state = self._si.allocState()
        self._state.numbers[:] = numbers
        self._states.deserialize(state, self._state.capsule)
        return state

    def states(self, path: oc.PathControl) -> FloatArray:
        """The states of a path at every step, shape (n, 13)."""
        fine = oc.PathControl(path)
        fine.interpolate()
        rows = np.empty((fine.getStateCount(), STATE))
        for k, state in enumerate(fine.getStates()):
            self._states.serialize(self._state.capsule, state)
            rows[k] = self._state.numbers
        return rows


def runs(controls: FloatArray, hold: int, longest: int) -> list[tuple[int, int]]:
    """First and last step of each input, as long as it may be held.

    Args:
        controls: of every step, shape (n, 4); equal within each ``hold`` of them.
        hold: steps for which every input is held.
        longest: steps at most, a multiple of ``hold``.
    """
    found: list[tuple[int, int]] = []
    first = 0
    for k in range(hold, len(controls) + 1, hold):
        done = k == len(controls)
        if done or k - first >= longest or not np.array_equal(controls[k], controls[first]):
            found.append((first, k))
            first = k
    return found


def add_solution(
    problem: Any,
    path: oc.PathControl,
    cost: float,
    name: str,
    own: Any,
    cost_of: Callable[[Any], float],
) -> None:
    """Make a path the solution, unless a better one of another planner is there.

    Args:
        problem: the ``ob.ProblemDefinition``.
        path: to be added.
        cost: of the path.
        name: of the planner.
        own: path that the planner put in before; None if it has none.
        cost_of: the cost of a path of another planner.
    """
    there: Any = problem.getSolutionPath() if problem.hasExactSolution() else None
    foreign = there is not None and there is not own
    first = foreign and isinstance(there, oc.PathControl) and cost_of(there) < cost
    problem.clearSolutionPaths()
    if first:
        problem.addSolutionPath(there, False, -1.0, name)
    problem.addSolutionPath(path, first, 1.0 if first else -1.0, name)
