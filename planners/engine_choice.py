"""Engines by their names."""

from __future__ import annotations

from typing import Any

from ompl_risk._arrays import real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.engines import Engine, InProcess, Loky, Registered
from ompl_risk.planners.working import GRACE


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

    from ompl_risk.planners.dask_engine import Dask
    from ompl_risk.planners.ray_engine import Ray

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
