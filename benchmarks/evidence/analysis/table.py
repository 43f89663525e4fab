"""The campaign's Parquet as arrays: units of five flights, what flew them and what became of it."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from benchmarks.evidence.analysis.profiles import COLUMNS, Profiles
from ompl_risk.errors import FileError

FLIGHTS = 5
LEVELS = ("calm", "moderate", "severe")
SPLITS = ("train", "test")
STATUSES = ("complete", "few", "failed")
SCALARS = ("unit", "split", "terrain", "terrain_seed", "status", "reason", "flight", "duration",
           "step")  # fmt: skip
REMEDY = "make it with python -m benchmarks evidence"
CODES = 1 << FLIGHTS
MEMBERS = (np.arange(CODES)[:, None] >> np.arange(FLIGHTS)) & 1
"""Whether flight i collides in pattern c: bit i of c, shape (32, 5)."""


@dataclass(frozen=True, eq=False)
class Table:
    """U complete units; flight i of unit u is flight 5 u + i of the profiles.

    Rollout k draws the same disturbances for all five flights of a unit and a level, so what is
    counted is which of the five collide together.

    Args:
        path: where it was read.
        units: their numbers, shape (U,).
        split: "train" or "test", shape (U,).
        terrain: kind of terrain, shape (U,).
        terrain_seed: shape (U,).
        profiles: of 5 U flights.
        patterns: rollouts by which of the flights collided, see `MEMBERS`; shape (3, U, 32), by
            `LEVELS`.
        outcomes: number of units by split and status, incomplete ones too.
        reasons: number of incomplete units by reason.
        facts: the file's metadata.
    """

    path: Path
    units: NDArray[np.int64]
    split: NDArray[np.str_]
    terrain: NDArray[np.str_]
    terrain_seed: NDArray[np.int64]
    profiles: Profiles
    patterns: NDArray[np.int64]
    outcomes: dict[tuple[str, str], int]
    reasons: dict[str, int]
    facts: dict[str, Any]

    def __len__(self) -> int:
        return len(self.units)

    @property
    def hits(self) -> NDArray[np.int64]:
        """Collisions of each flight, shape (3, U, 5)."""
        return self.patterns @ MEMBERS

    @property
    def rollouts(self) -> NDArray[np.int64]:
        """Rollouts of each unit, shape (3, U)."""
        return self.patterns.sum(axis=-1)

    @property
    def places(self) -> NDArray[np.str_]:
        """The terrain that each unit flies over, kind and seed, shape (U,)."""
        seeds = self.terrain_seed.astype(str)
        return np.char.add(np.char.add(self.terrain, " "), seeds)

    def part(self, split: str) -> Table:
        """The units of a split."""
        return self.take(np.flatnonzero(self.split == split))

    def take(self, chosen: NDArray[np.intp]) -> Table:
        """Some of the units, in the order asked for."""
        flights = (FLIGHTS * chosen[:, None] + np.arange(FLIGHTS)).ravel()
        return replace(
            self,
            units=self.units[chosen],
            split=self.split[chosen],
            terrain=self.terrain[chosen],
            terrain_seed=self.terrain_seed[chosen],
            profiles=self.profiles.take(flights),
            patterns=self.patterns[:, chosen],
        )


def read(path: Path) -> Table:
    """Read and check a campaign's Parquet.

    Raises:
        FileError: no such file, or it is not what the campaign writes.
    """
    try:
        source = pq.read_table(path)
    except (OSError, pa.ArrowException) as error:
        raise FileError(path, f"cannot be read ({error})", REMEDY) from None
    measured = [f"{level}_{what}" for level in LEVELS for what in ("hits", "rollouts", "bits")]
    if missing := [n for n in (*SCALARS, *COLUMNS, *measured) if n not in source.column_names]:
        raise FileError(path, f"has no column {', '.join(missing)}", REMEDY)
    first, rows = _units(path, source)
    outcomes = Counter(zip(_texts(first, "split"), _texts(first, "status"), strict=True))
    reasons = Counter(
        reason or "no reason given"
        for status, reason in zip(_texts(first, "status"), _texts(first, "reason"), strict=True)
        if status != "complete"
    )
    units = rows.take(np.arange(0, len(rows), FLIGHTS))
    return Table(
        path,
        _numbers(units, "unit", np.int64),
        np.array(_texts(units, "split"), dtype=np.str_),
        np.array(_texts(units, "terrain"), dtype=np.str_),
        _numbers(units, "terrain_seed", np.int64),
        _profiles(path, rows),
        np.stack([_patterns(path, rows, level) for level in LEVELS]),
        dict(outcomes),
        dict(reasons.most_common()),
        _facts(source),
    )


def _units(path: Path, source: pa.Table) -> tuple[pa.Table, pa.Table]:
    """A row for each unit, and the rows of the complete ones in order."""
    for name, allowed in (("split", SPLITS), ("status", STATUSES)):
        if strange := {*_texts(source, name)} - {*allowed}:
            raise FileError(path, f"has {name} {sorted(map(str, strange))}", REMEDY)
    source = source.sort_by([("unit", "ascending"), ("flight", "ascending")])
    numbers = _numbers(source, "unit", np.int64)
    units, begins, counts = np.unique(numbers, return_index=True, return_counts=True)
    first = source.take(begins)
    complete = np.array([status == "complete" for status in _texts(first, "status")], dtype=bool)
    expected = np.where(complete, FLIGHTS, 1)
    for unit in units[counts != expected][:1]:
        raise FileError(path, f"has another number of rows for unit {unit} than it should", REMEDY)
    if not complete.any():
        raise FileError(path, "holds no complete unit", "let the campaign go on")
    rows = source.take(np.flatnonzero(np.repeat(complete, counts)))
    flights = _numbers(rows, "flight", np.int64).reshape(-1, FLIGHTS)
    if (flights != np.arange(FLIGHTS)).any() or {*_texts(rows, "status")} != {"complete"}:
        raise FileError(path, "has a complete unit whose flights are not 0 to 4", REMEDY)
    return first, rows


def _profiles(path: Path, rows: pa.Table) -> Profiles:
    columns = {name: rows.column(name).combine_chunks() for name in COLUMNS}
    lengths = columns["d"].value_lengths().to_numpy(zero_copy_only=False)
    for name, column in columns.items():
        same = np.array_equal(column.value_lengths().to_numpy(zero_copy_only=False), lengths)
        values = column.flatten().to_numpy(zero_copy_only=False).astype(np.float64)
        if not same or np.isnan(lengths).any() or not np.isfinite(values).all():
            raise FileError(path, f"has flights whose {name} is not finite, or too short", REMEDY)
        columns[name] = values
    if (columns["d"] <= 0.0).any():
        raise FileError(path, "has a planned flight that collides (d <= 0)", REMEDY)
    starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.intp)
    return Profiles(starts, _times(path, rows, np.diff(starts)), **columns)


def _times(path: Path, rows: pa.Table, lengths: NDArray[np.intp]) -> NDArray[np.float64]:
    """Sample k at k steps, the last one at the end."""
    step, duration = (_numbers(rows, name, np.float64) for name in ("step", "duration"))
    begins = np.cumsum(lengths) - lengths
    t = (np.arange(lengths.sum()) - np.repeat(begins, lengths)) * np.repeat(step, lengths)
    late, early = (lengths - 1) * step + 1e-6 * step, (lengths - 2) * step
    if (lengths < 2).any() or not ((early < duration) & (duration <= late)).all():
        raise FileError(path, "has flights whose samples do not fit their duration", REMEDY)
    t[begins + lengths - 1] = duration
    return t


def _patterns(path: Path, rows: pa.Table, level: str) -> NDArray[np.int64]:
    """Rollouts of each unit by which of its flights collided, shape (U, 32)."""
    hits, rollouts = (
        _numbers(rows, f"{level}_{name}", np.int64).reshape(-1, FLIGHTS)
        for name in ("hits", "rollouts")
    )
    bits = rows.column(f"{level}_bits").to_pylist()
    found = np.empty((len(hits), CODES), dtype=np.int64)
    for unit, count in enumerate(rollouts[:, 0]):
        five = bits[FLIGHTS * unit : FLIGHTS * (unit + 1)]
        if (rollouts[unit] != count).any() or count < 1 or {*map(len, five)} != {-(-count // 8)}:
            raise FileError(path, f"has other numbers of {level} bits than of rollouts", REMEDY)
        packed = np.array([np.frombuffer(each, dtype=np.uint8) for each in five])
        collided = np.unpackbits(packed, axis=1, count=int(count)).astype(np.intp)
        found[unit] = np.bincount((1 << np.arange(FLIGHTS)) @ collided, minlength=CODES)
    if not np.array_equal(found @ MEMBERS, hits):
        raise FileError(path, f"has {level} bits that are not its hits", REMEDY)
    return found


def _numbers(table: pa.Table, name: str, kind: Any) -> NDArray[Any]:
    return table.column(name).to_numpy().astype(kind)


def _texts(table: pa.Table, name: str) -> list[str]:
    return table.column(name).to_pylist()


def _facts(source: pa.Table) -> dict[str, Any]:
    """Metadata by name, decoded from JSON where it is."""
    found: dict[str, Any] = {}
    for key, value in (source.schema.metadata or {}).items():
        name, text = key.decode(), value.decode(errors="replace")
        if name.startswith(("ARROW:", "pandas")):
            continue
        try:
            found[name] = json.loads(text)
        except ValueError:
            found[name] = text
    return found
