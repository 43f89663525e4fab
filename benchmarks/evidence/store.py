"""One Parquet file for each unit, kept whatever happens to the rest, and all of them in one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from benchmarks import environment
from benchmarks.evidence import schema
from benchmarks.evidence.settings import Settings, levels
from benchmarks.evidence.unit import Done
from benchmarks.pieces import Pieces, Say
from benchmarks.procedures import differences
from ompl_risk.errors import FileError

NAME = "evidence.parquet"
UNITS = Pieces("unit", "result", digits=5, suffix=".parquet")

Known = tuple[pa.Table, dict[str, Any]]
"""A unit's rows, and the facts about them."""


@dataclass(frozen=True)
class Kept:
    """What is known of a unit that is done.

    Attributes:
        status: "complete", "few" or "failed".
        reason: of anything but "complete".
        code: fingerprint of the code that made it.
    """

    status: str
    reason: str
    code: str


def keep(folder: Path, done: Done) -> None:
    """Write a unit's file in one go: a reader never sees half of one."""
    UNITS.keep(folder, done.unit, done.content)


def kept(
    folder: Path,
    settings: Settings,
    count: int | None = None,
    *,
    say: Say = lambda _message: None,
) -> dict[int, Kept]:
    """The units that are done.

    Args:
        folder: where.
        settings: of the campaign.
        count: how many units are of interest, the first ones; all if left out.
        say: called with a message for each file that is not what it should be; its unit counts as
            not done.

    Raises:
        ArgumentError: a unit of another seed or procedure. It is neither counted with the others
            nor written over.
    """
    found = {}
    for unit, (content, facts) in _read_all(folder, settings, count, say):
        first = content.slice(0, 1).to_pylist()[0]
        found[unit] = Kept(first["status"], first["reason"], facts["code"])
    return found


def _read_all(
    folder: Path, settings: Settings, count: int | None = None, say: Say = lambda _message: None
) -> Iterator[tuple[int, Known]]:
    here = settings.fingerprint

    def differing(known: Known) -> Iterator[str]:
        return differences(known[1]["procedure"], here)

    return UNITS.kept(folder, read, differing, count=count, say=say)


def read(folder: Path, unit: int) -> Known:
    """A unit's rows, and the facts about them.

    Raises:
        OSError: there is no such file, or it is damaged.
        ValueError: says what the file is not, or lacks.
    """
    content = schema.read(UNITS.path(folder, unit))
    facts = schema.facts_of(content.schema)
    if missing := {"procedure", "unit", "code", "versions", "processor", "seconds"} - facts.keys():
        raise ValueError(f"without {', '.join(sorted(missing))}")
    numbers = {facts["unit"], *content.column("unit").to_pylist()}
    if numbers != {unit}:
        raise ValueError(f"of unit {', '.join(map(str, sorted(numbers - {unit})))}")
    return content, facts


def compact(folder: Path, settings: Settings) -> Path:
    """Write all units that are done into one file.

    Returns:
        The file. Its metadata are the procedure, the levels in numbers, and how many units were
        made by which versions, code and processor.

    Raises:
        ArgumentError: see ``kept``.
        FileError: no unit is done.
    """
    parts, facts = [], []
    for _unit, (content, known) in _read_all(folder, settings):
        parts.append(content.replace_schema_metadata(None))
        facts.append(known)
    if not parts:
        raise FileError(folder, "holds no unit that is done", "let the campaign run first")
    path = folder / NAME
    draft = path.with_suffix(".part")
    schema.write(schema.with_facts(pa.concat_tables(parts), _summary(settings, facts)), draft)
    draft.replace(path)
    return path


def _summary(settings: Settings, facts: list[dict[str, Any]]) -> dict[str, Any]:
    """Facts about all units."""
    versions = [" ".join(f"{k} {v}" for k, v in each["versions"].items()) for each in facts]
    return {
        "procedure": settings.fingerprint,
        "levels": levels(),
        "seed": settings.seed,
        "rollouts": settings.rollouts,
        "units": len(facts),
        "seconds": round(sum(each["seconds"] for each in facts), 1),
        "versions": dict(Counter(versions)),
        "code": dict(Counter(each["code"] for each in facts)),
        "processors": dict(Counter(each["processor"] for each in facts)),
        "machine": environment.machine(),
    }
