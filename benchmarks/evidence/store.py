"""One Parquet file for each unit, kept whatever happens to the rest, and all of them in one."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pyarrow as pa

from benchmarks import environment
from benchmarks.evidence import schema
from benchmarks.evidence.settings import Settings, levels
from benchmarks.evidence.unit import Done
from benchmarks.procedures import differences
from ompl_risk.errors import ArgumentError, FileError

NAME = "evidence.parquet"


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


def path_of(folder: Path, unit: int) -> Path:
    """The file of a unit."""
    return folder / "units" / f"{unit:05d}.parquet"


def keep(folder: Path, done: Done) -> None:
    """Write a unit's file in one go: a reader never sees half of one."""
    path = path_of(folder, done.unit)
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_suffix(".part")
    with draft.open("wb") as file:
        file.write(done.content)
        file.flush()
        os.fsync(file.fileno())
    draft.replace(path)


def kept(
    folder: Path,
    settings: Settings,
    count: int | None = None,
    *,
    say: Callable[[str], object] = lambda _message: None,
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
    for unit in _numbers(folder, count):
        try:
            content, facts = read(folder, unit)
        except (OSError, ValueError) as error:
            path = path_of(folder, unit)
            say(f"{path} is no result of unit {unit} ({error}): the unit counts as not done")
            continue
        _check(folder, unit, facts, settings)
        first = content.slice(0, 1).to_pylist()[0]
        found[unit] = Kept(first["status"], first["reason"], facts["code"])
    return found


def read(folder: Path, unit: int) -> tuple[pa.Table, dict[str, Any]]:
    """A unit's rows, and the facts about them.

    Raises:
        OSError: there is no such file, or it is damaged.
        ValueError: says what the file is not, or lacks.
    """
    content = schema.read(path_of(folder, unit))
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
    for unit in kept(folder, settings):
        content, known = read(folder, unit)
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


def _numbers(folder: Path, count: int | None) -> list[int]:
    """Of the units that have a file, in order."""
    stems = [path.stem for path in (folder / "units").glob("*.parquet")]
    found = sorted(int(stem) for stem in stems if stem.isdecimal())
    return [unit for unit in found if count is None or unit < count]


def _check(folder: Path, unit: int, facts: Mapping[str, Any], settings: Settings) -> None:
    what = list(differences(facts["procedure"], settings.fingerprint))
    if what:
        some = " and ".join(what[:3]) + (f" and {len(what) - 3} more" if len(what) > 3 else "")
        allowed = "another folder, as this one holds units of another seed or procedure"
        name = path_of(folder, unit).name
        raise ArgumentError("output", str(folder), f"{allowed} ({name}: {some})")
