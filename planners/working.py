"""What happens in a worker process: open the problem once, run tasks, never hang."""

from __future__ import annotations

import contextlib
import faulthandler
import pickle
import signal
import threading
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from uuid import uuid4

from ompl_risk.errors import ArgumentError
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.task import Candidate, Task

PROCESS = uuid4().hex
"""Tells this process from others, on whatever machine."""

GRACE = 60.0
"""Seconds past its time limit after which a task is held to hang: a fresh worker may have to
compile for the best part of a minute."""

FOREVER = 1e6
"""Seconds from which no watch is kept."""


class Parcel(ABC):
    """A problem on its way to a worker; hashable, so that a worker opens it once."""

    @abstractmethod
    def open(self) -> Problem:
        """The problem: a large terrain takes seconds to prepare."""


@dataclass(frozen=True)
class FileParcel(Parcel):
    """A problem in a file, for processes that share a disk.

    Args:
        path: of the file.
    """

    path: str

    def open(self) -> Problem:
        """Read it."""
        return pickle.loads(Path(self.path).read_bytes())


@dataclass(frozen=True)
class BytesParcel(Parcel):
    """A problem that travels with the task.

    Args:
        key: tells it from others.
        data: the problem, pickled.
    """

    key: str
    data: bytes = field(compare=False, repr=False)

    def open(self) -> Problem:
        """Unpack it."""
        return pickle.loads(self.data)


def packed(problem: Problem) -> bytes:
    """The problem pickled, with functions and classes that only this process knows.

    Raises:
        ArgumentError: it cannot be pickled.
    """
    from joblib.externals.loky.backend.reduction import dumps

    try:
        return bytes(dumps(problem))
    except Exception as error:
        allowed = f"picklable to travel to worker processes ({error}), or planned with workers=1"
        raise ArgumentError("problem", problem, allowed) from error


def work(parcel: Parcel, index: int, task: Task, grace: float, home: str) -> tuple[int, Candidate]:
    """Run a task in a worker.

    Args:
        parcel: the problem.
        index: of the task, handed back.
        task: what to run.
        grace: seconds past the task's time limit after which this process is ended.
        home: `PROCESS` of the process that asks. Some engines have threads for workers.
    """
    from ompl_risk.planners.solving import ONE_AT_A_TIME, solve_task

    away = home != PROCESS
    if away and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the asking process's business
    problem = _problem(parcel)
    with ONE_AT_A_TIME, _ended_after(task.time_limit + grace if away else FOREVER):
        return index, solve_task(problem, task)


@lru_cache(maxsize=1)
def _problem(parcel: Parcel) -> Problem:
    return parcel.open()


@contextlib.contextmanager
def _ended_after(seconds: float) -> Iterator[None]:
    """End this process if the block takes longer.

    A planner that hangs in C++ holds Python's interpreter lock, so nothing written in Python could
    end it. The watch of `faulthandler` is a thread in C that needs no lock.
    """
    if not seconds < FOREVER:
        yield
        return
    with Path("/dev/null").open("w") as nowhere:
        faulthandler.dump_traceback_later(seconds, exit=True, file=nowhere)
        try:
            yield
        finally:
            faulthandler.cancel_dump_traceback_later()
