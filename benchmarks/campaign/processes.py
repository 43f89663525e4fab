"""Runs in worker processes, each in a fresh one."""

from __future__ import annotations

import os
import re
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from benchmarks.campaign.execution import execute, failure
from benchmarks.campaign.run import Run

Result = dict[str, Any]
Work = Callable[[Run], Result]

ORPHANED = 0.5
"""Seconds between two looks of a worker at whether its campaign is still alive."""
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)
POLL = 0.5
"""Seconds after which overdue runs are looked for, at the latest."""


@dataclass(frozen=True)
class Started:
    """A run in its process, which is killed at the deadline (of `time.monotonic`)."""

    run: Run
    executor: Any
    deadline: float


def finished(
    runs: Sequence[Run], *, workers: int, grace: float, work: Work = execute
) -> Iterator[tuple[Run, Result]]:
    """Carry out runs, each in a fresh interpreter: none inherits another's memory or its crash.

    A process that dies, or does not answer in time, gives a result that says so, and the others
    go on. When the iterator is closed, as by Ctrl-C, the processes are killed; when this process
    is killed, they end by themselves.

    Args:
        runs: what to do.
        workers: how many at a time.
        grace: seconds beyond a run's own after which its process is killed; it has to start,
            compile and judge in them.
        work: what is done; importable by name.

    Yields:
        Each run with its result, as they finish.
    """
    left, active = list(reversed(runs)), dict[Future[Result], Started]()
    try:
        while left or active:
            while left and len(active) < workers:
                run = left.pop()
                future, executor = _start(work, run)
                deadline = time.monotonic() + run.seconds + grace
                active[future] = Started(run, executor, deadline)
            done, _ = wait(active, timeout=POLL, return_when=FIRST_COMPLETED)
            for future in done:
                started = active.pop(future)
                result = _result(future)
                started.executor.shutdown(kill_workers=True)
                yield started.run, result
            for future in [f for f, s in active.items() if time.monotonic() > s.deadline]:
                started = active.pop(future)
                started.executor.shutdown(kill_workers=True)
                limit = started.run.seconds + grace
                yield started.run, failure(f"no answer after {limit:.0f} s: killed")
    finally:
        for started in active.values():
            started.executor.shutdown(kill_workers=True)


def _start(work: Work, run: Run) -> tuple[Future[Result], Any]:
    # joblib brings loky, which starts fresh interpreters: a forked OMPL would share its state
    from joblib.externals.loky import ProcessPoolExecutor

    with _no_interrupt():
        executor = ProcessPoolExecutor(
            1, initializer=_end_with, initargs=(os.getpid(),), env=ONE_THREAD
        )
        return executor.submit(work, run), executor


def _end_with(parent: int) -> None:
    """End this process soon after its parent, which may have been killed; loky would wait on."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(ORPHANED)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _no_interrupt() -> Iterator[None]:
    """Hold SIGINT back; processes that start meanwhile never see one.

    Ctrl-C goes to all processes of a terminal. It is the parent's business alone, and it comes to
    the parent as soon as this ends.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _result(future: Future[Result]) -> Result:
    try:
        return future.result()
    except BrokenProcessPool as error:
        codes = re.search(r"exit codes of the workers are \{(.*?)\}", str(error))
        return failure(f"the worker process died: {codes[1] if codes else 'no exit code'}")
    except Exception as error:
        return failure(f"{type(error).__name__}: {error}".splitlines()[0])
