"""Guards around the calls by which OMPL is entered: ``solve``, ``simplifySolution``, ``Benchmark``.

Some combinations of an OMPL planner and a problem written in Python hang, crash or ignore the
objective (``ompl_risk.bridge.traps``). With the guards in place the caller gets a TrapError or a
TrapWarning that names the way round, and an exception in a callback, Ctrl-C included, surfaces
after ``solve`` instead of aborting the process (``ompl_risk.bridge.faults``).

**This module replaces methods of OMPL's classes**, which this library does nowhere else. The
reason: a plain ``ss.solve(1.0)`` must not hang, and nothing but that call sees planner and
objective together before C++ takes over. An objective cannot know which planner it will meet, and
a ``solve`` of our own would protect only those who already know that they need protection.

The act is explicit and can be undone:

- importing ``ompl_risk.bridge`` calls :func:`install`; :func:`remove` puts OMPL's methods back;
- with the environment variable ``OMPL_RISK_GUARDS=0`` nothing is ever replaced;
- what is refused is limited to what was observed to hang, crash or mislead, and what concerns a
  quality of the path only to this library's own objectives; everything else passes unchanged.

Not seen, hence not guarded: an ``og.PathSimplifier`` used by itself (it does not tell its
objective), a second ``solve`` of the same ``og.AORRTC``, and user functions that raise without
:func:`ompl_risk.bridge.faults.keep`. ``ompl-risk doctor`` lists all traps.
"""

from __future__ import annotations

import atexit
import os
from collections.abc import Callable, Iterator
from typing import NamedTuple

from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og
from ompl import tools as ot

from ompl_risk.bridge import conditions, guarded, guarded_benchmark
from ompl_risk.bridge.guarded import Method

SWITCH = "OMPL_RISK_GUARDS"


class _Patch(NamedTuple):
    """A method of an OMPL class and what takes its place."""

    owner: type
    name: str
    original: Method
    replacement: Method


_patches: list[_Patch] = []


def install() -> bool:
    """Put the guards in place; a second call changes nothing.

    Returns:
        Whether they are in place: False if ``OMPL_RISK_GUARDS=0`` forbids it.
    """
    if os.environ.get(SWITCH, "").strip() == "0":
        return installed()
    if not _patches:
        _patches.extend(_replacements())
        for patch in _patches:
            setattr(patch.owner, patch.name, patch.replacement)
        atexit.register(remove)  # OMPL's classes must not outlive the interpreter through ours
    return True


def remove() -> None:
    """Put OMPL's own methods back; a second call changes nothing.

    A method that someone else has replaced since is left as it is.
    """
    for patch in _patches:
        if vars(patch.owner).get(patch.name) is patch.replacement:
            setattr(patch.owner, patch.name, patch.original)
    _patches.clear()
    guarded.forget_warnings()
    atexit.unregister(remove)


def installed() -> bool:
    """Whether the guards are in place."""
    return bool(_patches)


def _replacements() -> Iterator[_Patch]:
    for owner in _planner_classes():
        yield _patch(owner, "solve", guarded.guarded_planner)
    for owner in (og.SimpleSetup, oc.SimpleSetup):
        yield _patch(owner, "solve", guarded.guarded_setup)
    yield _patch(og.SimpleSetup, "simplifySolution", guarded.guarded_simplification)
    yield _patch(ob.PlannerTerminationCondition, "__init__", conditions.guarded_condition)
    yield from _benchmark_replacements()


def _benchmark_replacements() -> Iterator[_Patch]:
    owner, set_event = ot.Benchmark, vars(ot.Benchmark)["setPreRunEvent"]
    yield _patch(owner, "__init__", lambda init: guarded_benchmark.guarded_init(init, set_event))
    yield _patch(owner, "setPreRunEvent", guarded_benchmark.guarded_event)
    yield _patch(owner, "addPlanner", guarded_benchmark.guarded_add)
    yield _patch(owner, "addPlannerAllocator", guarded_benchmark.guarded_allocate)
    yield _patch(owner, "clearPlanners", guarded_benchmark.guarded_clear)
    yield _patch(owner, "benchmark", guarded_benchmark.guarded_benchmark)


def _planner_classes() -> Iterator[type]:
    """The planner classes with a ``solve`` of their own; the others inherit a guarded one."""
    for module in (ob, og, oc):
        for owner in vars(module).values():
            if isinstance(owner, type) and issubclass(owner, ob.Planner) and "solve" in vars(owner):
                yield owner


def _patch(owner: type, name: str, wrap: Callable[[Method], Method]) -> _Patch:
    original = vars(owner)[name]
    return _Patch(owner, name, original, wrap(original))
