"""Ray clusters to run tasks on; they share no disk with this machine."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any
from uuid import uuid4

from ompl_risk.planners.engines import Crew, Engine, JoblibCrew, imported
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.working import GRACE, BytesParcel, Parcel, packed


class Ray(Engine):
    """A Ray cluster: the one that `ray.init` has connected to, else one of this machine.

    Args:
        workers: number of processes; as many as the cluster has processors if left out.
        grace: see `Engine`.
        options: of Ray's joblib backend, such as `ray_remote_args`.

    Raises:
        ExtraError: ray is not installed.
    """

    def __init__(self, workers: int | None = None, *, grace: float = GRACE, **options: Any) -> None:
        self._ray = imported("ray", "ray")
        self.workers, self.grace, self.options = workers, grace, options
        errors = importlib.import_module("ray.exceptions")
        self.deaths = (errors.RayActorError, errors.WorkerCrashedError)

    @contextlib.contextmanager
    def crew(self, problem: Problem) -> Iterator[Crew]:
        """The cluster's workers, which take the problem from Ray's object store."""
        data = packed(problem)
        importlib.import_module("ray.util.joblib").register_ray()
        with self._started():
            yield JoblibCrew(
                backend="ray",
                parcel=_RayParcel(uuid4().hex, self._ray.put(data)),
                workers=self.workers,
                grace=self.grace,
                options=self.options,
            )

    @contextlib.contextmanager
    def _started(self) -> Iterator[None]:
        """A cluster of our own for the while, unless there is one."""
        if self._ray.is_initialized():
            yield
            return
        self._ray.init(include_dashboard=False, log_to_driver=False, logging_level="ERROR")
        try:
            yield
        finally:
            self._ray.shutdown()


@dataclass(frozen=True)
class _RayParcel(Parcel):
    """A problem in Ray's object store."""

    key: str
    reference: Any = field(compare=False, repr=False)

    def open(self) -> Problem:
        """Fetch and unpack it."""
        data = importlib.import_module("ray").get(self.reference)
        return BytesParcel(self.key, data).open()
