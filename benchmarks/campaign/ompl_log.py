"""The campaign as OMPL's own benchmark logs, one for each scene."""

from __future__ import annotations

import math
import socket
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks import environment
from benchmarks.campaign.metrics import BOUNDS, METRICS
from benchmarks.campaign.objectives import OBJECTIVES
from benchmarks.campaign.run import prepared
from benchmarks.campaign.store import Record
from benchmarks.campaign.summary import present
from benchmarks.campaign.table import Row, row

STATUS = (
    "Unknown status", "Invalid start", "Invalid goal", "Unrecognized goal type", "Timeout",
    "Approximate solution", "Exact solution", "Crash",
)  # fmt: skip
"""OMPL's `PlannerStatus`, in its order."""
OURS = {"solved": 6, "unsound": 6, "no path": 4, "failed": 7}
SAMPLES = 50
"""Rows of progress for each run, at equal steps, as OMPL's own benchmark writes them."""

# Names become columns of a database: letters, digits and spaces only.
RISK = {
    "duration": "duration",
    "L1": "risk L1",
    "L2": "risk L2",
    "L4": "risk L4",
    "Linf": "risk Linf",
    "H1(0.3)": "risk H1 tau 300 ms",
    "H1": "risk H1 tau 1 s",
    "H1(3)": "risk H1 tau 3 s",
    "clearance": "least clearance",
    "pc L2": "collision probability L2",
    "pc max": "collision probability max",
    "pc ever": "collision probability ever",
}
"""Our metrics as properties of a run."""


def write_logs(folder: Path, records: Sequence[Record], date: str) -> list[Path]:
    """Write the log of each scene.

    Args:
        folder: where.
        records: all runs.
        date: when the campaign began, such as "2026-01-31 12:00:00".
    """
    folder.mkdir(exist_ok=True)
    scenes = dict.fromkeys(record["configuration"]["scene"] for record in records)
    paths = []
    for scene in scenes:
        chosen = [each for each in records if each["configuration"]["scene"] == scene]
        path = folder / f"{scene}.log"
        path.write_text("\n".join(log_lines(scene, chosen, date)) + "\n", encoding="utf-8")
        paths.append(path)
    return paths


def log_lines(scene: str, records: Sequence[Record], date: str) -> Iterator[str]:
    """The lines of a log, in the format that `ot.Benchmark` writes and OMPL's script reads."""
    groups: dict[tuple[str, str, str], list[Record]] = {}
    for each in records:
        facts = each["configuration"]
        groups.setdefault((scene, facts["planner"], facts["objective"]), []).append(each)
    yield from _head(scene, records, date, max(map(len, groups.values())))
    yield f"{len(groups)} planners"
    for group in present(groups):
        yield from _planner(group[1], group[2], groups[group])


def properties(each: Row) -> dict[str, Any]:
    """Properties of a run by "name TYPE"; None and infinity are missing."""
    planned, sound = each["status"] in ("solved", "unsound"), each["status"] == "solved"
    return {
        "approximate solution BOOLEAN": 0,
        "correct solution BOOLEAN": int(sound),
        "solved BOOLEAN": int(planned),
        "status ENUM": OURS[each["status"]],
        "objective ENUM": list(OBJECTIVES).index(each["objective"]),
        "run seed INTEGER": each["seed"],
        "time REAL": each["seconds"],
        "wall time REAL": each["wall seconds"],
        "memory REAL": each["memory"],
        "best cost REAL": each["cost"],
        "solution length REAL": each["length"],
        **{f"{_column(name)} REAL": each[name] for name in (*METRICS, *BOUNDS)},
    }


def progress(curve: Sequence[Sequence[float]], seconds: float) -> list[tuple[float, float]]:
    """Time and best cost at equal steps; inf before there is a path."""
    times, costs = [t for t, _ in curve], [math.inf, *(cost for _, cost in curve)]
    grid = [seconds * (k + 1) / SAMPLES for k in range(SAMPLES)]
    return [(t, costs[bisect_right(times, t)]) for t in grid]


def _head(scene: str, records: Sequence[Record], date: str, runs: int) -> Iterator[str]:
    made = prepared(scene)
    problem, versions = made.problem, environment.versions()
    parameters: Mapping[str, float] = {
        "d0": problem.avoidance.d0,
        "speed": problem.speed,
        "distance": problem.distance,
        "required_clearance": problem.min_clearance,
        "error_radius": made.error,
    }
    yield f"OMPL version {versions['ompl']}"
    yield f"Experiment {scene}"
    yield f"{len(parameters)} experiment properties"
    yield from (f"{name} REAL = {value:.10g}" for name, value in parameters.items())
    yield f"Running on {socket.gethostname() or 'unknown'}"
    yield f"Starting at {date}"
    yield from ("<<<|", made.about, *(f"{k} = {v}" for k, v in made.recipe.items()), "|>>>")
    yield from ("<<<|", *(f"{k}: {v}" for k, v in environment.machine().items()), "|>>>")
    yield "1 is the random seed"
    yield f"{records[0]['configuration']['seconds']:g} seconds per run"
    yield "0 MB per run"
    yield f"{runs} runs per planner"
    spent = sum(each["result"].get("seconds", 0.0) for each in records)
    yield f"{spent:.6g} seconds spent to collect the data"
    yield "2 enum types"
    yield "|".join(("status", *STATUS))
    yield "|".join(("objective", *OBJECTIVES))


def _planner(name: str, objective: str, records: Sequence[Record]) -> Iterator[str]:
    settings = {"objective": objective} | records[0]["configuration"]["objective recipe"]
    ordered = sorted(records, key=lambda each: each["configuration"]["seed"])
    table = [properties(row(each)) for each in ordered]
    yield f"{name} for {objective}"
    yield f"{len(settings)} common properties"
    yield from (f"{key} = {value}" for key, value in settings.items())
    yield f"{len(table[0])} properties for each run"
    yield from table[0]
    yield f"{len(table)} runs"
    yield from ("".join(f"{_text(value)}; " for value in each.values()) for each in table)
    yield "2 progress properties for each run"
    yield from ("time REAL", "best cost REAL")
    yield f"{len(table)} runs"
    for each in ordered:
        rows = progress(each["result"].get("curve", []), each["configuration"]["seconds"])
        yield "".join(f"{_text(t)},{_text(cost)},;" for t, cost in rows)
    yield "."


def _column(name: str) -> str:
    for metric, column in RISK.items():
        for end in ("", " low", " high"):
            if name == metric + end:
                return column + end
    raise KeyError(name)


def _text(value: Any) -> str:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    return f"{value:.10g}" if isinstance(value, float) else str(value)
