"""One file for each pair: what was found, kept whatever happens to the rest."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from benchmarks import blind_flights, procedures
from benchmarks.pieces import Pieces, Say
from benchmarks.scenario import procedure
from benchmarks.scenario.findings import REFERENCE, claims
from benchmarks.scenario.fingerprint import differences, fingerprint

Record = dict[str, Any]

PAIRS = Pieces("pair", "record", digits=4, suffix=".json")
ALWAYS = ("seed", "pair", "status")
CONTENTS = {
    "judged": ("durations", "norms", "pc norms", "orders", "pc orders", "tau", "claims"),
    "fewer": ("flights",),
    "failed": ("reason",),
}
"""What every record has, and what it has besides by its status."""


def evaluate(seed: int, number: int, places: int = procedure.PLACES) -> Record:
    """Plan, fly and judge a pair; a failure is a record too."""
    begin = time.perf_counter()
    record: Record = {
        "seed": seed,
        "pair": number,
        "procedure": fingerprint(places),
        "code": procedures.code(Path(__file__).parent, Path(blind_flights.__file__)),
    }
    try:
        ends = procedure.pair(seed, number)
        record |= {"start": list(ends.start), "goal": list(ends.goal)}
        record |= _found(procedure.flights(ends, number + 1, places=places))
    except Exception as error:  # the others go on
        record |= {"status": "failed", "reason": f"{type(error).__name__}: {error}"}
    return {**record, "seconds": round(time.perf_counter() - begin, 2)}


def _found(trajectories: list[Any]) -> Record:
    if len(trajectories) < procedure.FLIGHTS:
        return {"status": "fewer", "flights": len(trajectories)}
    ranking = procedure.judged(trajectories).ranking
    agreement = ranking.pc_agreement
    if agreement is None:
        raise RuntimeError("a ranking without probabilities")
    orders = {label: list(order) for label, order in ranking.orders.items()}
    pc_orders = {label: list(order) for label, order in ranking.pc_orders.items()}
    return {
        "status": "judged",
        "durations": {a.name: a.duration for a in ranking.assessments},
        "least clearances": {a.name: a.min_clearance for a in ranking.assessments},
        "norms": {a.name: dict(a.norms) for a in ranking.assessments},
        "pc norms": {a.name: dict(a.pc_norms) for a in ranking.assessments},
        "orders": orders,
        "pc orders": pc_orders,
        "tau": {label: agreement[label, REFERENCE] for label in orders},
        "claims": claims(orders, pc_orders),
    }


def keep(folder: Path, record: Record) -> None:
    """Write a record in one go: a reader never sees half of one."""
    PAIRS.keep(folder, record["pair"], (json.dumps(record, indent=1) + "\n").encode())


def kept(
    folder: Path,
    seed: int,
    count: int,
    places: int = procedure.PLACES,
    *,
    say: Say = lambda _message: None,
) -> dict[int, Record]:
    """Records of the first pairs that are there.

    Args:
        folder: where.
        seed: of the pairs.
        count: how many of them are of interest.
        places: of the roadmaps.
        say: called with a message for each file that is no record of its pair; the pair counts as
            not done.

    Raises:
        ArgumentError: a record of another seed or procedure. It is neither counted with the others
            nor written over.
    """

    def differing(record: Record) -> Iterator[str]:
        return differences(record, seed, places)

    return dict(PAIRS.kept(folder, read, differing, count=count, say=say))


def read(folder: Path, number: int) -> Record:
    """The record of a pair.

    Raises:
        OSError: there is none that can be read.
        ValueError: says what the file is not, or lacks.
    """
    record = json.loads(PAIRS.path(folder, number).read_text(encoding="utf-8"))
    if not isinstance(record, dict):
        raise ValueError("no object")
    status = str(record.get("status"))
    if missing := sorted({*ALWAYS, *CONTENTS.get(status, ())} - record.keys()):
        raise ValueError(f"without {', '.join(missing)}")
    if record["pair"] != number or status not in CONTENTS:
        raise ValueError(f"pair {record['pair']!r}, status {status!r}")
    return record
