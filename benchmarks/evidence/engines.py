"""Where units are worked on: in processes of this machine, or on a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks import working
from benchmarks.evidence.settings import code
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.engines import imported

WAIT = 60.0
"""Seconds in which a cluster must have a worker."""

Say = Callable[[str], object]
Work = Callable[[int], Any]


@dataclass(frozen=True)
class Lost:
    """A unit that has no result, though the cluster goes on.

    Attributes:
        reason: what the cluster says.
    """

    reason: str


class ClusterLostError(working.WorkersGoneError):
    """The cluster has gone, with units that are left."""


class Engine(ABC):
    """Runs work somewhere; results come back here, so no disk need be shared."""

    @abstractmethod
    def run(self, work: Work, units: Sequence[int], say: Say) -> Iterator[tuple[int, Any]]:
        """Units and what work(unit) returned, or a `Lost`, as they come.

        Args:
            work: importable by name; catches what it can.
            units: their numbers.
            say: called with messages.
        """


class Local(Engine):
    """Processes of this machine, by joblib.

    A process that dies is replaced, and what it was at is started again.

    Args:
        workers: how many; 1 works in this process.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers

    def run(self, work: Work, units: Sequence[int], say: Say) -> Iterator[tuple[int, Any]]:
        """See `working.finished`, also for what it raises."""
        return working.finished(work, units, workers=self.workers, say=say, what="units")


class Dask(Engine):
    """A Dask cluster, whose workers must have this very code.

    Dask tries a unit again whose worker died, on another worker and as often as its setting
    ``distributed.scheduler.allowed-failures`` says. It then counts as lost, unless it gets done
    when it is tried once more at the end, with no other unit beside it.

    Args:
        workers: of a local cluster.
        scheduler: address of a running one, such as "tcp://host:8786"; None starts a local one.

    Raises:
        ExtraError: dask or distributed is not installed.
    """

    def __init__(self, workers: int, scheduler: str | None = None) -> None:
        self._distributed = imported("distributed", "dask")
        self.workers, self.scheduler = workers, scheduler

    def run(self, work: Work, units: Sequence[int], say: Say) -> Iterator[tuple[int, Any]]:
        """As they come from the cluster.

        Raises:
            ArgumentError: no such scheduler, no workers, or workers with other code.
            ClusterLostError: the scheduler has gone.
        """
        if not units:
            return
        with self._client() as client:
            self._check(client)
            say(f"{sum(client.ncores().values())} threads of a Dask cluster at work")
            killed = []
            for unit, future in self._coming(client, work, units):
                if self._is_killed(future):
                    killed.append(unit)
                else:
                    yield unit, self._result(future)
            for unit in killed:  # alone: it may only have stood next to one that kills
                for _, future in self._coming(client, work, [unit], "alone"):
                    yield unit, self._result(future)

    def _coming(
        self, client: Any, work: Work, units: Sequence[int], how: str = "unit"
    ) -> Iterator[tuple[int, Any]]:
        """Units and their futures, as they are done."""
        futures = [client.submit(work, unit, key=f"{how}-{unit}", pure=False) for unit in units]
        numbers = {future.key: unit for future, unit in zip(futures, units, strict=True)}
        coming = self._distributed.as_completed(futures, loop=client.loop)
        del futures  # the cluster keeps a result as long as somebody holds its future
        for future in coming:
            yield numbers[future.key], future

    def _is_killed(self, future: Any) -> bool:
        """Whether workers died while they had it."""
        killed = self._distributed.scheduler.KilledWorker
        return future.status == "error" and isinstance(future.exception(), killed)

    def _result(self, future: Any) -> Any:
        if future.status == "finished":
            return future.result()
        if future.status == "cancelled":
            raise ClusterLostError("the Dask cluster has gone")
        error = future.exception()
        return Lost(f"{type(error).__name__}: {error}")

    def _check(self, client: Any) -> None:
        """Workers are there, and have the code that is here."""
        given = self.scheduler or "of this machine"
        try:
            client.wait_for_workers(1, timeout=WAIT)
        except TimeoutError as error:
            allowed = f"a cluster with workers: it had none in {WAIT:g} s"
            raise ArgumentError("scheduler", given, allowed) from error
        try:
            codes = set(client.run(code).values())
        except ImportError as error:
            allowed = f"a cluster whose workers can import what is here ({error})"
            raise ArgumentError("scheduler", given, allowed) from error
        if other := codes - {code()}:
            allowed = f"a cluster whose workers have the code {code()} of here"
            raise ArgumentError("scheduler", given, f"{allowed}, not {', '.join(sorted(other))}")

    @contextlib.contextmanager
    def _client(self) -> Iterator[Any]:
        with contextlib.ExitStack() as stack:
            address = self.scheduler or stack.enter_context(self._cluster())
            try:
                client = self._distributed.Client(address, set_as_default=False)
            except (OSError, ValueError) as error:
                allowed = f"the address of a running Dask scheduler; {error}"
                raise ArgumentError("scheduler", address, allowed) from error
            yield stack.enter_context(client)

    def _cluster(self) -> Any:
        return self._distributed.LocalCluster(
            n_workers=self.workers,
            threads_per_worker=1,
            memory_limit=0,
            silence_logs=logging.CRITICAL,  # what goes wrong is told in the results
            dashboard_address=":0",  # any free port: another cluster may have the usual one
        )
