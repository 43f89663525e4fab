"""Dask clusters to run tasks on; they share no disk with this machine."""

from __future__ import annotations

import contextlib
import importlib
import logging
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any
from uuid import uuid4

from ompl_risk.errors import ArgumentError
from ompl_risk.planners.engines import Crew, Death, Engine, JoblibCrew, imported, processors
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.working import GRACE, BytesParcel, packed


class Dask(Engine):
    """A Dask cluster.

    The scheduler keeps the problem, so a worker that dies does not take it along. Dask itself tries
    a task again whose worker died, on another worker and as often as its setting
    `distributed.scheduler.allowed-failures` says; only then is the task given up. A cluster
    whose workers are all gone is waited for, as Dask does, until new ones come.

    Args:
        workers: most tasks at a time, or the processes of a local cluster; as many as the cluster,
            or this machine, has processors if left out.
        scheduler: address of a running scheduler, such as "tcp://host:8786".
        client: a `distributed.Client` to use; it stays open. With neither, the current client of
            this process is used if there is one, else a local cluster is started and stopped.
        grace: see `Engine`.
        options: of joblib's backend, such as `wait_for_workers_timeout`, or of `client.submit`.

    Raises:
        ExtraError: dask or distributed is not installed.
        ArgumentError: both a scheduler and a client.
    """

    def __init__(
        self,
        workers: int | None = None,
        *,
        scheduler: str | None = None,
        client: Any = None,
        grace: float = GRACE,
        **options: Any,
    ) -> None:
        self._distributed = imported("distributed", "dask")
        if scheduler is not None and client is not None:
            raise ArgumentError("scheduler", scheduler, "left out where client is given")
        self.workers, self.grace, self.options = workers, grace, options
        self._scheduler, self._client = scheduler, client
        scheduling = importlib.import_module("distributed.scheduler")
        clients = importlib.import_module("distributed.client")
        self.deaths = (scheduling.KilledWorker, clients.FutureCancelledError)

    @contextlib.contextmanager
    def crew(self, problem: Problem) -> Iterator[Crew]:
        """The cluster's workers, which get the problem from each other."""
        data = packed(problem)
        with contextlib.ExitStack() as stack:
            client = stack.enter_context(self._connected())
            with warnings.catch_warnings():
                warnings.filterwarnings("ignore", message="Sending large graph")
                # a task rather than scattered data: what is lost with a worker is computed anew
                parcel = client.submit(BytesParcel, uuid4().hex, data, pure=False)
            yield JoblibCrew(
                backend=partial(_dask_backend, client, self.options),
                parcel=parcel,
                workers=self.workers or sum(client.ncores().values()) or None,
                grace=self.grace,
            )

    @contextlib.contextmanager
    def _connected(self) -> Iterator[Any]:
        if self._client is not None:
            yield self._client
        elif self._scheduler is not None:
            with self._reached(self._scheduler) as client:
                yield client
        elif (current := self._current()) is not None:
            yield current
        else:
            with self._local() as client:
                yield client

    def _reached(self, address: str) -> Any:
        try:
            return self._distributed.Client(address, set_as_default=False)
        except (OSError, ValueError) as error:
            allowed = f"the address of a running Dask scheduler; {error}"
            raise ArgumentError("scheduler", address, allowed) from error

    def _current(self) -> Any:
        try:
            return self._distributed.get_client()
        except ValueError:
            return None

    @contextlib.contextmanager
    def _local(self) -> Iterator[Any]:
        """A cluster of our own, in which a death is told at once rather than tried again."""
        import dask.config  # type: ignore[import-not-found]

        with (
            dask.config.set({"distributed.scheduler.allowed-failures": 0}),
            self._distributed.LocalCluster(
                n_workers=self.workers or processors(),
                threads_per_worker=1,
                memory_limit=0,
                silence_logs=logging.CRITICAL,  # a death is told in the candidate
                dashboard_address=":0",  # any free port: another cluster may have the usual one
            ) as cluster,
            self._distributed.Client(cluster, set_as_default=False) as client,
        ):
            yield client


def _dask_backend(client: Any, options: Mapping[str, Any]) -> Any:
    """Joblib's backend for Dask, with two things mended that joblib 1.6 does when workers die.

    It calls nobody when a task ends in an error of Dask's own, and waits for ever: here such a task
    yields a `Death`, and the others go on. And while one worker is left, it would run the tasks in
    this process.
    """
    from joblib._dask import DaskDistributedBackend

    class Mended(DaskDistributedBackend):
        def effective_n_jobs(self, n_jobs: int = 1) -> int:
            return max(2, super().effective_n_jobs(n_jobs))

        def submit(self, func: Any, callback: Any = None) -> Any:
            ((_work, (_parcel, index, *_), _options),) = func.items  # batches of one
            told = _Once(callback)
            future = super().submit(func, told)

            def tell(done: Any) -> None:
                if error := done.exception():
                    told([(index, Death(error))])

            future.add_done_callback(tell)
            return future

    return Mended(client=client, **options)


class _Once:
    """A callback that heeds its first call alone."""

    def __init__(self, callback: Callable[[Any], object]) -> None:
        self._callback, self._called = callback, False

    def __call__(self, result: Any) -> None:
        if not self._called:
            self._called = True
            self._callback(result)
