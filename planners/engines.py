"""Where tasks run: in this process, in local processes, on a Dask or a Ray cluster."""

from __future__ import annotations

import contextlib
import os
import pickle
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from uuid import uuid4

from ompl_risk._arrays import real_number
from ompl_risk.errors import ArgumentError
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


def engine_of(engine: str | Engine, workers: int | None = None, **options: Any) -> Engine:
    """The engine of that name.

    Args:
        engine: "loky" for processes of this machine, "dask" or "ray" for clusters, the name of any
            other backend that is registered with joblib, or an engine.
        workers: number of processes; all processors, or the cluster's, if left out. With "loky", 1
            plans in this process.
        options: of the engine, such as `scheduler="tcp://host:8786"` for Dask; `grace` for all.

    Raises:
        ArgumentError: an unknown engine or option, one that would not survive the death of a
            worker, or less than one worker.
        ExtraError: the engine's package is not installed.
    """
    if workers is not None and (
        not isinstance(workers, int) or isinstance(workers, bool) or workers < 1
    ):
        raise ArgumentError("workers", workers, "a whole number of at least 1")
    if isinstance(engine, Engine):
        if options:
            raise ArgumentError("options", sorted(options), "left out: the engine is made already")
        return engine
    make = _makers().get(engine)
    if make is None:
        names = ", ".join(_makers())
        reason = f" ({why})" if (why := UNFIT.get(engine)) else ""
        raise ArgumentError("engine", engine, f"one of {names}{reason}")
    if real_number("grace", options.get("grace", GRACE), "a number of seconds, 0 or more") < 0.0:
        raise ArgumentError("grace", options["grace"], "a number of seconds, 0 or more")
    try:
        return make(workers, **options)
    except TypeError as error:
        raise ArgumentError("options", sorted(options), f"options of {engine}; {error}") from None


UNFIT = {
    "multiprocessing": "it forks OMPL together with its state, and waits for ever for a process "
    "that died; use loky",
    "threading": "OMPL's random numbers are those of the process, so its threads would wait for "
    "each other; use loky",
    "sequential": "use loky with workers=1",
}
"""Backends of joblib that do not do, and why."""


def _makers() -> dict[str, Any]:
    """The engines there are, by name."""
    from joblib.parallel import BACKENDS

    from ompl_risk.planners.clusters import Dask, Ray

    def local(workers: int | None, **options: Any) -> Engine:
        loky = Loky(workers, **options)
        return InProcess() if workers == 1 else loky

    makers: dict[str, Any] = {"loky": local, "dask": Dask, "ray": Ray}
    for name in BACKENDS:
        if name not in makers and name not in UNFIT:
            makers[name] = _registered(name)
    return makers


def _registered(name: str) -> Any:
    return lambda workers, **options: Registered(name, workers, **options)


def processors() -> int:
    """How many processors this process may use."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity else os.cpu_count() or 1
