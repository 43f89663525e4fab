"""Many tasks, their candidates as they arrive."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import replace
from pickle import PicklingError
from typing import Any

from ompl_risk._arrays import positive
from ompl_risk.planners.engine_choice import engine_of
from ompl_risk.planners.engines import Crew, Death, Engine, Jobs, Outcomes
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.task import Candidate, Status, Task

OnDone = Callable[[Candidate], object]

SUSPECTS = 2
"""Tasks for each worker that are tried alone after a death."""


def candidates(
    problem: Problem,
    tasks: Sequence[Task],
    *,
    workers: int | None = 1,
    engine: str | Engine = "loky",
    total_time: float | None = None,
    on_done: OnDone | None = None,
    **options: Any,
) -> list[Candidate]:
    """Run all tasks.

    A task that raises gives a candidate that tells so. A worker process that dies does too, and so
    does one that hangs, which is ended some time after the task's time limit; the other tasks go
    on. After Ctrl-C the workers are stopped, and what `on_done` has been called with is what there
    is.

    Args:
        problem: what to plan; sent to every worker once.
        tasks: what to run.
        workers: number of processes; 1 plans in this process, where a crash of OMPL ends it; None
            uses all processors.
        engine: where they run, see `engine_of`.
        total_time: seconds for all tasks together [s]. Once they are over those that run are
            stopped, and those left give candidates that say so. Makes the result depend on the
            machine.
        on_done: called with each candidate as it arrives, in this process.
        options: of the engine.

    Returns:
        A candidate for each task, in the order of `tasks`, whatever the order of arrival.

    Raises:
        ArgumentError: an unknown engine, a problem that cannot be sent to workers, or a number out
            of range.
        ExtraError: the engine's package is not installed.
    """
    crew = engine_of(engine, workers, **options)
    limit = math.inf if total_time is None else positive("total_time", total_time)
    clock = _Clock(time.monotonic() + limit, limit)
    found: dict[int, Candidate] = {}
    with closing(_surviving(crew, problem, tasks, clock)) as arriving:
        for index, candidate in arriving:
            found[index] = replace(candidate, task=tasks[index])
            if on_done is not None:
                on_done(found[index])
    return [found[index] for index in range(len(tasks))]


class _Clock:
    """The time for all tasks together."""

    def __init__(self, end: float, limit: float) -> None:
        self._end, self._limit = end, limit

    @property
    def left(self) -> float:
        """Seconds until it is over."""
        return self._end - time.monotonic()

    def jobs(self, tasks: dict[int, Task]) -> Jobs:
        """Tasks as long as there is time, none of them with more time than there is."""
        for index, task in tasks.items():
            if (left := self.left) <= 0.0:
                return
            yield index, task if task.time_limit <= left else replace(task, time_limit=left)

    def late(self, task: Task) -> Candidate:
        """What is said of a task that was not started."""
        reason = f"the {self._limit:g} s for all tasks were over"
        return Candidate(task, Status.NOT_STARTED, reason=reason, timed_out=True)


def _surviving(
    engine: Engine, problem: Problem, tasks: Sequence[Task], clock: _Clock
) -> Generator[tuple[int, Candidate], None, None]:
    """Candidates as they arrive, though workers die.

    A death may take along what else its worker had to do, and most engines give up and do not even
    say over which task. So those that may be to blame are tried again, one at a time, which finds
    the culprit; the others go on as before.
    """
    left = dict(enumerate(tasks))
    suspects: list[int] = []
    if not left:
        return
    with engine.crew(problem) as crew:
        while left and clock.left > 0.0:
            batch = {i: left[i] for i in ([suspects.pop(0)] if suspects else left)}
            begin = time.monotonic()
            with closing(_round(engine, crew, batch, clock)) as outcomes:
                for index, outcome in outcomes:
                    if isinstance(outcome, Candidate):
                        del left[index]
                        yield index, outcome
                    elif len(batch) == 1:
                        seconds = time.monotonic() - begin
                        yield index, _dead(left.pop(index), outcome.error, seconds, engine.grace)
                    else:
                        suspects.append(index)
    yield from ((index, clock.late(task)) for index, task in left.items())


def _round(engine: Engine, crew: Crew, tasks: dict[int, Task], clock: _Clock) -> Outcomes:
    """Candidates, and a `Death` for each task that may be to blame for one."""
    left = dict(tasks)
    try:
        with closing(crew.run(clock.jobs(tasks))) as outcomes:
            for index, outcome in outcomes:
                del left[index]
                yield index, outcome
    except engine.deaths as error:
        for index in list(left)[: SUSPECTS * crew.size]:
            yield index, Death(error)


def _dead(task: Task, error: BaseException, seconds: float, grace: float) -> Candidate:
    late = seconds > task.time_limit + grace
    reason = f"the worker process died: {_first(error)}"
    if isinstance(error, PicklingError):
        reason = f"the task cannot be sent to a worker: {_first(error)}"
    elif late:
        reason = f"it hung: its process was ended {grace:g} s after its time limit, or died by then"
    return Candidate(task, Status.FAILED, seconds=seconds, timed_out=late, reason=reason)


def _first(error: BaseException) -> str:
    """The first sentence of an explanation that may go on for a paragraph."""
    text = str(error).strip() or type(error).__name__
    return text.split(". ")[0].splitlines()[0]
