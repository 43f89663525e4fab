"""One unit from its number to its rows: draw, plan, fly in a closed loop, sample."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks import environment
from benchmarks.evidence import procedure, schema
from benchmarks.evidence.profiles import profile
from benchmarks.evidence.schema import Row
from benchmarks.evidence.settings import Settings, code
from benchmarks.progress import FAILED
from ompl_risk import TerrainClearance
from ompl_risk.helicopter.flight import Flight
from ompl_risk.simulation.closed_loop import closed_loop_probability
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.estimate import CollisionEstimate
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan

COMPLETE, FEW = "complete", "few"
PACKAGES = ("python", "ompl-risk", "numpy", "numba", "scipy")


@dataclass(frozen=True)
class Done:
    """What came of a unit.

    Attributes:
        unit: its number.
        status: "complete", "few" or "failed".
        reason: of anything but "complete".
        content: of its Parquet file.
    """

    unit: int
    status: str
    reason: str
    content: bytes


def evaluate(settings: Settings, unit: int) -> Done:
    """Work on a unit; a failure is a result too."""
    begin = time.perf_counter()
    known: Row = {}
    try:
        rows = _rows(settings, unit, known)
    except Exception as error:  # the others go on
        return failed(settings, unit, f"{type(error).__name__}: {error}", known)
    return _done(settings, unit, rows, time.perf_counter() - begin)


def failed(
    settings: Settings, unit: int, reason: str, known: Mapping[str, Any] | None = None
) -> Done:
    """A unit that has no other result than why.

    Args:
        settings: of the campaign.
        unit: its number.
        reason: why.
        known: columns that are known all the same.
    """
    row = {**_place(unit), **(known or {}), "status": FAILED, "reason": reason}
    return _done(settings, unit, [row], 0.0)


def draw_seed(settings: Settings, unit: int) -> int:
    """Of the unit's disturbances."""
    random = np.random.SeedSequence([settings.seed, unit, 1])
    return int(random.generate_state(1, np.uint64)[0] >> np.uint64(1))


def _rows(settings: Settings, unit: int, known: Row) -> list[Row]:
    """A row for each flight, or one that says that they are too few; ``known`` is filled in."""
    ends = procedure.pair(settings.seed, unit)
    known |= {**_place(unit), "start": list(ends.start), "goal": list(ends.goal)}
    flights = procedure.flights(unit, ends, places=settings.places)
    if len(flights) < procedure.FLIGHTS:
        return [{**known, "status": FEW, "reason": f"{len(flights)} flights"}]
    clearance = procedure.ground(*procedure.place(unit)[1:])
    flown = _flown(settings, unit, flights, clearance)
    columns = [
        profile(flight, clearance, step=procedure.STEP, radius=procedure.FAR) for flight in flights
    ]
    return [
        {
            **known,
            "status": COMPLETE,
            "reason": "",
            "flight": k,
            "duration": flight.duration,
            "length": flight.length,
            "step": procedure.STEP,
            **columns[k],
            **flown[k],
        }
        for k, flight in enumerate(flights)
    ]


def _flown(
    settings: Settings, unit: int, flights: Sequence[Flight], clearance: TerrainClearance
) -> list[Row]:
    """The columns of every level, for each flight."""
    plans = [HelicopterPlan(flight, name=f"{k}") for k, flight in enumerate(flights)]
    rows: list[Row] = [{} for _ in plans]
    for level in procedure.LEVELS:
        estimates = closed_loop_probability(
            plans,
            clearance,
            Disturbances.level(level),
            rollouts=settings.rollouts,
            seed=draw_seed(settings, unit),
            threads=1,
        )
        for row, estimate in zip(rows, estimates, strict=True):
            row |= {f"{level}_{name}": value for name, value in _columns(estimate).items()}
    return rows


def _columns(estimate: CollisionEstimate) -> Row:
    return {
        "hits": estimate.hits,
        "rollouts": estimate.rollouts,
        "bits": np.packbits(estimate.collides).tobytes(),
        "least": estimate.quantiles().astype(np.float32),
    }


def _place(unit: int) -> Row:
    return {"unit": unit, **procedure.place(unit)._asdict()}


def _done(settings: Settings, unit: int, rows: list[Row], seconds: float) -> Done:
    machine, versions = environment.machine(), environment.versions()
    facts = {
        "procedure": settings.fingerprint,
        "unit": unit,
        "code": code(),
        "processor": machine["processor"],
        "versions": {name: versions[name] for name in PACKAGES},
        "seconds": round(seconds, 2),
    }
    content = schema.packed(schema.table(rows, facts))
    return Done(unit, rows[0]["status"], rows[0]["reason"], content)
