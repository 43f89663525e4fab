"""The guarded version of ``ot.Benchmark``, which runs planners where no ``solve`` is seen.

A benchmark does not tell which SimpleSetup and planners it holds, and its objects take neither
attributes nor weak references. So each benchmark gets a :class:`Watch` as its pre-run event: the
benchmark owns the watch, the watch knows the rest, and both disappear together.
"""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from typing import Any

from ompl_risk.bridge import faults, traps
from ompl_risk.bridge.guarded import Method, make_disposable, refuse, refuse_or_warn, warn
from ompl_risk.bridge.inspection import Attempt, is_risk


class Watch:
    """What a benchmark was given, and OMPL's call before each run.

    Args:
        setup: the SimpleSetup of the benchmark.
    """

    def __init__(self, setup: Any) -> None:
        self.setup = setup
        self.planners: list[Any] = []
        self.event: Callable[[Any], object] | None = None
        self.deferral: faults.Deferral | None = None

    def __call__(self, planner: Any) -> None:
        """Leave the benchmark if a callback failed in the run before; else the user's event."""
        if self.deferral is not None:
            self.deferral.release()  # no C++ thread runs here: raising is safe
        if self.event is not None:
            self.event(planner)

    def allocated(self, allocate: Callable[[Any], Any]) -> Callable[[Any], Any]:
        """A planner allocator that records the planner."""

        def record(space: Any) -> Any:
            self.planners.append(allocate(space))
            return self.planners[-1]

        return record


_watches: weakref.WeakValueDictionary[int, Watch] = weakref.WeakValueDictionary()


def guarded_init(original: Method, set_event: Method) -> Method:
    """Wrap ``ot.Benchmark.__init__``; ``set_event`` is OMPL's own ``setPreRunEvent``."""

    @functools.wraps(original)
    def __init__(self: Any, setup: Any, *args: Any, **kwargs: Any) -> None:  # noqa: N807
        original(self, setup, *args, **kwargs)
        watch = Watch(setup)
        set_event(self, watch)
        _watches[id(self)] = watch

    return __init__


def guarded_event(original: Method) -> Method:
    """Wrap ``ot.Benchmark.setPreRunEvent``: the watch calls the user's event."""

    @functools.wraps(original)
    def setPreRunEvent(self: Any, event: Callable[[Any], object]) -> None:
        watch = _watches.get(id(self))
        if watch is None:
            original(self, event)
        else:
            watch.event = event

    return setPreRunEvent


def guarded_add(original: Method) -> Method:
    """Wrap ``ot.Benchmark.addPlanner``."""

    @functools.wraps(original)
    def addPlanner(self: Any, planner: Any) -> None:
        original(self, planner)
        if (watch := _watches.get(id(self))) is not None:
            watch.planners.append(planner)

    return addPlanner


def guarded_allocate(original: Method) -> Method:
    """Wrap ``ot.Benchmark.addPlannerAllocator``."""

    @functools.wraps(original)
    def addPlannerAllocator(self: Any, allocate: Callable[[Any], Any]) -> None:
        watch = _watches.get(id(self))
        original(self, allocate if watch is None else watch.allocated(allocate))

    return addPlannerAllocator


def guarded_clear(original: Method) -> Method:
    """Wrap ``ot.Benchmark.clearPlanners``."""

    @functools.wraps(original)
    def clearPlanners(self: Any) -> None:
        original(self)
        if (watch := _watches.get(id(self))) is not None:
            watch.planners.clear()

    return clearPlanners


def guarded_benchmark(original: Method) -> Method:
    """Wrap ``ot.Benchmark.benchmark``: all planners are judged before the first one runs."""

    @functools.wraps(original)
    def benchmark(self: Any, req: Any) -> None:
        watch = _watches.get(id(self))
        if watch is None:
            original(self, req)
            return
        _judge(watch, req)
        with faults.deferred() as watch.deferral:
            original(self, req)

    return benchmark


def _judge(watch: Watch, request: Any) -> None:
    problem = watch.setup.getProblemDefinition()
    for planner in watch.planners:
        make_disposable(planner)
    for planner in watch.planners:
        refuse_or_warn(Attempt(planner, problem))
        if isinstance(planner, traps.LENGTH_ONLY) and request.runCount > 1:
            refuse(
                planner,
                f"a benchmark of {request.runCount} runs with {type(planner).__name__}",
                "hangs or crashes in the second run: the planner does not survive clear()",
                "ask for one run, or leave this planner out",
            )
    if request.simplify and is_risk(problem.getOptimizationObjective()):
        warn(
            "Request(simplify=True), the default, replaces each path by a shorter one of more risk"
            " before post-run events see it; pass simplify=False"
        )
