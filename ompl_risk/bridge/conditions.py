"""Termination conditions: how long a planner may run, and whether answering that calls Python."""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from numbers import Real
from typing import Any

from ompl import base as ob

from ompl_risk.errors import TrapError

Arguments = tuple[tuple[Any, ...], dict[str, Any]]

_SECONDS = ("time", "solveTime")  # what OMPL's overloads call a number of seconds

_functions: weakref.WeakValueDictionary[int, functools.partial[bool]] = (
    weakref.WeakValueDictionary()
)
"""The function behind each condition made in Python, by the condition's identity.

OMPL's objects take neither attributes nor weak references. The ``partial`` is owned by the
condition alone, so its entry disappears with the condition.
"""


def after(seconds: float) -> Any:
    """The condition that OMPL itself makes of a number of seconds (``Planner::solve(double)``).

    From 1 s on the clock is read by a timer thread, every 100th of the time but at least every
    0.1 s. That thread is harmless: it never calls Python.
    """
    if seconds < 1.0:
        return ob.timedPlannerTerminationCondition(seconds)
    return ob.timedPlannerTerminationCondition(seconds, min(seconds / 100.0, 0.1))


def calls_python(condition: object) -> bool:
    """Whether ``condition`` was made of a Python function while the guards were in place."""
    return id(condition) in _functions


def as_condition(args: tuple[Any, ...], kwargs: dict[str, Any]) -> tuple[Any, Arguments]:
    """Turn the arguments of a ``solve`` into a condition that can be told to terminate.

    Args:
        args: positional arguments of ``solve``, without the planner.
        kwargs: keyword arguments of ``solve``.

    Returns:
        The condition, or None where OMPL has to judge the arguments (none, or wrong ones), and
        the arguments for OMPL's own ``solve``.
    """
    given = (*args, *kwargs.values())
    if len(given) == 1:
        if isinstance(given[0], ob.PlannerTerminationCondition):
            return given[0], (args, kwargs)
        if isinstance(given[0], Real) and (args or kwargs.keys() <= set(_SECONDS)):
            condition = after(float(given[0]))
            return condition, ((condition,), {})
    if len(args) in (1, 2) and callable(args[0]) and not kwargs.keys() - {"checkInterval"}:
        condition = ob.PlannerTerminationCondition(*given)  # refused there if it is periodic
        return condition, ((condition,), {})
    return None, (args, kwargs)


def guarded_condition(original: Callable[..., None]) -> Callable[..., None]:
    """Wrap ``ob.PlannerTerminationCondition.__init__``.

    A period starts a C++ thread that calls the function: it waits for Python as long as OMPL runs
    C++ code, and whoever waits for that thread then waits for ever.
    """

    @functools.wraps(original)
    def __init__(self: Any, fn: Callable[[], bool], period: float = 0.0) -> None:  # noqa: N807
        if not callable(fn) or not isinstance(period, Real):
            original(self, fn, period)  # OMPL says what is wrong
        elif period > 0.0:
            raise TrapError(
                f"a termination condition that calls Python every {float(period):g} s",
                "hangs, sooner or later, with every planner: its thread cannot run Python in solve",
                "leave the period out: ob.PlannerTerminationCondition(fn)",
            )
        else:
            function = functools.partial(fn)
            original(self, function)
            _functions[id(self)] = function

    return __init__
