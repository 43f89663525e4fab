"""All runs as flat rows, in CSV and Parquet."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks.campaign.execution import Status
from benchmarks.campaign.metrics import BOUNDS, METRICS
from benchmarks.campaign.objectives import OBJECTIVES
from benchmarks.campaign.store import Record

Row = dict[str, Any]

NUMBERS = {
    "seconds": "s",
    "wall seconds": "s",
    "memory": "MiB",
    "cost": "",
    "length": "m",
}
ABOUT = {
    "key": "name of the run's whole configuration, which runs.jsonl holds",
    "budget": "processor time that the planner was given",
    "status": "solved; unsound: a path that is not free; no path; failed: an exception or a crash",
    "value": "the planner's cost as its objective is meant: the root of a norm's power",
    "seconds": "processor time that the planner took",
    "wall seconds": "time on the wall; more than that if the machine was busy",
    "memory": "greatest memory of the process",
    "cost": "the planner's cost of its path",
    "length": "length of the path",
    "code": "fingerprint of the source; rows that differ in it come from different code",
}


def row(record: Record) -> Row:
    """A record as a flat row; metrics are None unless the path is sound."""
    facts, result = record["configuration"], record["result"]
    sound = result["status"] == Status.SOLVED
    found = result.get("metrics", {}) if sound else {}
    numbers = {name: _number(result.get(name)) for name in NUMBERS}
    cost, objective = numbers["cost"], OBJECTIVES[facts["objective"]]
    value = None if cost is None else objective.value(cost, facts["objective recipe"])
    return {
        **{name: facts[name] for name in ("scene", "objective", "planner", "seed")},
        "budget": facts["seconds"],
        "status": result["status"],
        "reason": result.get("reason", ""),
        **numbers,
        "value": value,
        **{name: _number(found.get(name)) for name in (*METRICS, *BOUNDS)},
        "finished": record["finished"],
        "code": record["code"],
        "key": record["key"],
    }


def curve_rows(records: Iterable[Record]) -> list[Row]:
    """The curves of all runs, a row for each improvement."""
    return [
        {
            **{k: record["configuration"][k] for k in ("scene", "objective", "planner", "seed")},
            "seconds": t,
            "cost": cost,
            "value": OBJECTIVES[record["configuration"]["objective"]].value(
                cost, record["configuration"]["objective recipe"]
            ),
        }
        for record in records
        for t, cost in record["result"].get("curve", [])
    ]


def columns() -> list[Row]:
    """What the columns of the runs mean."""
    units = {**NUMBERS, "budget": "s"} | {name: metric.unit for name, metric in METRICS.items()}
    about = ABOUT | {name: metric.about for name, metric in METRICS.items()}
    about |= dict.fromkeys(BOUNDS, "bound: estimated error of the quadrature, or 95 % interval")
    units |= {name: METRICS[name.rsplit(" ", 1)[0]].unit for name in BOUNDS}
    return [
        {"column": name, "unit": units.get(name, ""), "about": text} for name, text in about.items()
    ]


def write_csv(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Rows with the same names, the names first; None is empty."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]) if rows else [])
        writer.writeheader()
        writer.writerows(rows)


def write_parquet(path: Path, rows: Sequence[Mapping[str, Any]]) -> bool:
    """The same as Parquet.

    Returns:
        False if pyarrow is not installed, so that nothing was written.
    """
    try:
        import pyarrow  # pyright: ignore[reportMissingImports]
        import pyarrow.parquet  # pyright: ignore[reportMissingImports]
    except ImportError:
        return False
    names = list(rows[0]) if rows else []
    table = pyarrow.table({name: [each[name] for each in rows] for name in names})
    pyarrow.parquet.write_table(table, path)
    return True


def _number(value: Any) -> float | None:
    """Infinities are written as words in the store."""
    return None if value is None else float(value)
