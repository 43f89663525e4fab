"""The guarded versions of OMPL's ``solve`` and ``simplifySolution``.

Each function takes OMPL's own method and returns the one to put in its place. What is put there
does three things: it looks at planner and problem for a known trap, runs OMPL's method with the
exceptions of callbacks deferred, and looks at the result. Arguments, return value and docstring
are those of OMPL.
"""

from __future__ import annotations

import functools
import math
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

from ompl import geometric as og

from ompl_risk.bridge import faults, traps
from ompl_risk.bridge.conditions import as_condition, calls_python
from ompl_risk.bridge.inspection import Attempt, is_risk
from ompl_risk.errors import TrapError, TrapWarning

Method = Callable[..., Any]

_warned: set[tuple[traps.Trap, type]] = set()
_HERE = f"{Path(__file__).parent}{os.sep}"


def guarded_planner(original: Method) -> Method:
    """Wrap the ``solve`` of a planner class."""

    @functools.wraps(original)
    def solve(self: Any, *args: Any, **kwargs: Any) -> Any:
        return _solve(original, self, self, self.getProblemDefinition(), args, kwargs)

    return solve


def guarded_setup(original: Method) -> Method:
    """Wrap the ``solve`` of a SimpleSetup, geometric or control."""

    @functools.wraps(original)
    def solve(self: Any, *args: Any, **kwargs: Any) -> Any:
        self.setup()  # OMPL's first act too: it chooses a planner where none is set
        problem = self.getProblemDefinition()
        return _solve(original, self, self.getPlanner(), problem, args, kwargs)

    return solve


def guarded_simplification(original: Method) -> Method:
    """Wrap ``og.SimpleSetup.simplifySolution``, which shortens the path whatever the risk."""

    @functools.wraps(original)
    def simplifySolution(self: Any, *args: Any, **kwargs: Any) -> Any:
        objective = self.getOptimizationObjective()
        if is_risk(objective):
            raise TrapError(
                f"simplifySolution() with {type(objective).__name__}",
                "raises the risk: it removes vertices without looking at the objective",
                "use og.PathSimplifier(si, goal, objective).partialShortcutPath(path), which looks "
                "at it, and compare objective.norm(path) before and after",
            )
        return original(self, *args, **kwargs)

    return simplifySolution


def refuse_or_warn(attempt: Attempt) -> None:
    """Act on the traps that an attempt would run into.

    Raises:
        TrapError: it would hang, crash or optimise something else.
    """
    for trap in traps.REFUSED:
        if trap.hits(attempt):
            refuse(attempt.planner, trap.name(attempt), trap.symptom, trap.instead)
    for trap in traps.WARNED:
        key = trap, type(attempt.planner)
        if key not in _warned and trap.hits(attempt):
            _warned.add(key)
            warn(f"{trap.name(attempt)} {trap.symptom}; {trap.instead}")


def refuse(planner: Any, what: str, symptom: str, instead: str) -> NoReturn:
    """Raise a TrapError instead of letting ``planner`` run."""
    make_disposable(planner)
    raise TrapError(what, symptom, instead)


def make_disposable(planner: Any) -> None:
    """Set an AORRTC up that will not run: its destructor crashes if nobody ever did."""
    if isinstance(planner, traps.LENGTH_ONLY):
        planner.setup()


def warn(message: str) -> None:
    """Issue a TrapWarning at the line that called OMPL."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_HERE):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, TrapWarning, stacklevel=level)


def forget_warnings() -> None:
    """Warn again about what was warned about before."""
    _warned.clear()


def _solve(
    original: Method,
    owner: Any,
    planner: Any,
    problem: Any,
    args: tuple[Any, ...],
    kwargs: dict[str, Any],
) -> Any:
    condition, (args, kwargs) = as_condition(args, kwargs)
    if planner is not None and problem is not None:  # else OMPL says what is missing
        refuse_or_warn(Attempt(planner, problem, python_condition=calls_python(condition)))
    with faults.deferred(None if condition is None else condition.terminate):
        status = original(owner, *args, **kwargs)
    if problem is not None:
        _warn_if_unusable(problem)
    return status


def _warn_if_unusable(problem: Any) -> None:
    """Compare the planner's word with the path: RRT* calls a path of infinite cost a solution.

    Control paths are left out: OMPL 2.0.1 does not compute their cost, and no control planner
    that it offers looks at the objective.
    """
    objective = problem.getOptimizationObjective()
    if not is_risk(objective) or not problem.hasSolution():
        return
    path = problem.getSolutionPath()
    if not isinstance(path, og.PathGeometric):
        return
    cost = path.cost(objective).value()
    if not math.isfinite(cost):
        warn(
            f"the solution path has cost {cost:g}: it collides, whatever the planner's status says;"
            " set ClearanceMotionValidator, allow more time, or move start or goal"
        )
