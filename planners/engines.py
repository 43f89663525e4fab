"""Where tasks run: in this process, in local processes, on a Dask or a Ray cluster."""

from __future__ import annotations

import contextlib
import importlib
import os
import pickle
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from uuid import uuid4

from ompl_risk.errors import ExtraError
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.task import Candidate, Task
from ompl_risk.planners.working import GRACE, PROCESS, BytesParcel, FileParcel, packed, work

Jobs = Iterable[tuple[int, Task]]


@dataclass(frozen=True)
class Death:
    """The worker of a task died while the others go on.

    Args:
        error: what the engine says about it.
    """

    error: BaseException


Outcomes = Generator[tuple[int, "Candidate | Death"], None, None]


class Engine(ABC):
    """Runs tasks somewhere.

    The implementer's duties:

    1. `crew(problem)` is a context in which there are workers that can get at the problem; whatever
       it has started ends with it.
    2. If it knows whose worker died, it yields a `Death` for that task. Else it raises, and all
       that was running is over: `deaths` names the exceptions by which it tells that a worker died
       or that a task cannot get to one. Others pass through.
    3. No file of this machine may be needed on another.

    Attributes:
        deaths: classes of exceptions.
        grace: seconds past a task's time limit after which its process is ended as one that hangs.
    """

    deaths: tuple[type[Exception], ...] = ()
    grace: float = GRACE

    @abstractmethod
    def crew(self, problem: Problem) -> contextlib.AbstractContextManager[Crew]:
        """Workers for a problem."""


class Crew(ABC):
    """Workers that have a problem."""

    @property
    def size(self) -> int:
        """How many tasks may run at a time."""
        return 1

    @abstractmethod
    def run(self, jobs: Jobs) -> Outcomes:
        """Run tasks, take them one by one as workers get free, yield what arrives."""


class InProcess(Engine):
    """In this process, one task after the other. A crash of OMPL ends it."""

    @contextlib.contextmanager
    def crew(self, problem: Problem) -> Iterator[Crew]:
        """This process."""
        yield _Alone(problem)


@dataclass(frozen=True)
class _Alone(Crew):
    problem: Problem

    def run(self, jobs: Jobs) -> Outcomes:
        from ompl_risk.planners.solving import solve_task

        for index, task in jobs:
            yield index, solve_task(self.problem, task)


@dataclass(frozen=True, kw_only=True)
class JoblibCrew(Crew):
    """The workers of a joblib backend.

    Args:
        backend: its name, or what makes it.
        parcel: what `work` gets for the problem.
        workers: most tasks at a time; None leaves it to the backend.
        grace: see `Engine`.
        options: of the backend.
    """

    backend: str | Callable[[], Any]
    parcel: Any
    workers: int | None
    grace: float
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """The number of workers."""
        return self.workers or processors()

    def run(self, jobs: Jobs) -> Outcomes:
        """By joblib; a backend that cannot yield as results arrive yields all at the end."""
        from joblib import Parallel, delayed, parallel_config

        settings: dict[str, Any] = {
            "n_jobs": -1 if self.workers is None else self.workers,
            "batch_size": 1,
            "pre_dispatch": self.workers or "n_jobs",
        }
        # the context is left before the first result: it would reach into the caller's own code
        backend = self.backend if isinstance(self.backend, str) else self.backend()
        with parallel_config(backend=backend, **self.options):
            try:
                pool = Parallel(return_as="generator_unordered", **settings)
            except ValueError:
                pool = Parallel(**settings)
        calls = (delayed(work)(self.parcel, i, t, self.grace, PROCESS) for i, t in jobs)
        results: Any = pool(calls)
        yield from results


class Loky(Engine):
    """Processes of this machine, by joblib's own backend.

    They are fresh interpreters: a forked OMPL would share its state with this process.

    Args:
        workers: number of processes; all processors if left out.
        grace: see `Engine`.
    """

    def __init__(self, workers: int | None = None, *, grace: float = GRACE) -> None:
        from joblib.externals.loky.process_executor import BrokenProcessPool

        self.workers, self.grace = processors() if workers is None else workers, grace
        self.deaths = (BrokenProcessPool, pickle.PicklingError)

    @contextlib.contextmanager
    def crew(self, problem: Problem) -> Iterator[Crew]:
        """Processes that read the problem from a file, once each."""
        with tempfile.TemporaryDirectory(prefix="ompl-risk-") as folder:
            path = Path(folder) / "problem.pickle"
            path.write_bytes(packed(problem))
            yield JoblibCrew(
                backend="loky",
                parcel=FileParcel(str(path)),
                workers=max(2, self.workers),  # with 1 joblib would plan in this process
                grace=self.grace,
                options={"inner_max_num_threads": 1},
            )


class Registered(Engine):
    """Any other backend that is registered with joblib; the problem travels with every task.

    Args:
        name: of the backend.
        workers: most tasks at a time; left to the backend if left out.
        grace: see `Engine`.
        options: of the backend.
    """

    def __init__(
        self, name: str, workers: int | None = None, *, grace: float = GRACE, **options: Any
    ) -> None:
        self.name, self.workers, self.grace, self.options = name, workers, grace, options
        self.deaths = (Exception,)  # each backend has its own, and tasks catch what they raise

    @contextlib.contextmanager
    def crew(self, problem: Problem) -> Iterator[Crew]:
        """The backend's workers."""
        yield JoblibCrew(
            backend=self.name,
            parcel=BytesParcel(uuid4().hex, packed(problem)),
            workers=self.workers,
            grace=self.grace,
            options=self.options,
        )


def processors() -> int:
    """How many processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def imported(package: str, extra: str) -> Any:
    """An optional package.

    Raises:
        ExtraError: it is not installed.
    """
    try:
        return importlib.import_module(package)
    except ImportError:
        raise ExtraError(package, extra) from None
