"""Many tasks in worker processes, their candidates as they arrive."""

from __future__ import annotations

import pickle
import signal
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from ompl_risk.errors import ArgumentError
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.task import Candidate, Status, Task

OnDone = Callable[[Candidate], object]


def candidates(
    problem: Problem,
    tasks: Sequence[Task],
    *,
    workers: int = 1,
    on_done: OnDone | None = None,
) -> list[Candidate]:
    """Run all tasks.

    A task that raises gives a candidate that tells so. A worker process that dies does too, and
    the other tasks go on in a new one. After Ctrl-C the workers are stopped, and what `on_done` has
    been called with is what there is.

    Args:
        problem: what to plan; sent to every worker once.
        tasks: what to run.
        workers: number of processes; 1 plans in this process, where a crash of OMPL ends it.
        on_done: called with each candidate as it arrives, in this process.

    Returns:
        A candidate for each task, in the order of `tasks`, whatever the order of arrival.

    Raises:
        ArgumentError: less than one worker.
    """
    if workers < 1:
        raise ArgumentError("workers", workers, "a whole number of at least 1")
    arriving = _here(problem, tasks) if workers == 1 else _elsewhere(problem, tasks, workers)
    found: dict[int, Candidate] = {}
    for index, candidate in arriving:
        found[index] = candidate
        if on_done is not None:
            on_done(candidate)
    return [found[index] for index in range(len(tasks))]


def _here(problem: Problem, tasks: Sequence[Task]) -> Iterator[tuple[int, Candidate]]:
    from ompl_risk.planners.solving import solve_task

    for index, task in enumerate(tasks):
        yield index, solve_task(problem, task)


def _elsewhere(
    problem: Problem, tasks: Sequence[Task], workers: int
) -> Iterator[tuple[int, Candidate]]:
    """As `_here`, in processes; survives their death.

    When a worker dies, joblib gives up and does not say over which task. Those that may have been
    running are then tried one at a time, which finds the culprit; the others go on as before.
    """
    with tempfile.TemporaryDirectory(prefix="ompl-risk-") as folder:
        path = Path(folder) / "problem.pickle"
        path.write_bytes(pickle.dumps(problem))
        left = dict(enumerate(tasks))
        suspects: list[int] = []
        while left:
            batch = [suspects.pop(0)] if suspects else list(left)
            alone = len(batch) == 1
            try:
                for index, candidate in _parallel(path, {i: left[i] for i in batch}, workers):
                    del left[index]
                    yield index, candidate
            except _worker_died() as error:
                if alone:
                    yield batch[0], _dead(left.pop(batch[0]), error)
                else:
                    suspects = [i for i in batch if i in left][: 2 * workers]


def _parallel(path: Path, tasks: dict[int, Task], workers: int) -> Iterator[tuple[int, Candidate]]:
    from joblib import Parallel, delayed, parallel_config

    options: dict[str, Any] = {"batch_size": 1, "pre_dispatch": workers}
    # "loky" starts fresh interpreters: a forked OMPL would share its state with this process.
    with parallel_config(backend="loky", inner_max_num_threads=1):
        pool = Parallel(
            n_jobs=max(2, workers),  # with 1 joblib would plan in this process
            return_as="generator_unordered",
            **options,
        )
        jobs = (delayed(_work)(str(path), index, task) for index, task in tasks.items())
        results: Any = pool(jobs)
        yield from results


def _work(path: str, index: int, task: Task) -> tuple[int, Candidate]:
    from ompl_risk.planners.solving import solve_task

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's business
    return index, solve_task(_problem(path), task)


@lru_cache(maxsize=1)
def _problem(path: str) -> Problem:
    """The problem, which a worker reads once: a large terrain takes seconds to prepare."""
    return pickle.loads(Path(path).read_bytes())


def _worker_died() -> type[Exception]:
    from joblib.externals.loky.process_executor import BrokenProcessPool

    return BrokenProcessPool


def _dead(task: Task, error: Exception) -> Candidate:
    return Candidate(task, Status.FAILED, reason=f"the worker process died: {_first(error)}")


def _first(error: Exception) -> str:
    """The first sentence of joblib's explanation, which goes on for a paragraph."""
    return str(error).strip().split(". ")[0].splitlines()[0]
