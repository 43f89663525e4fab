"""The committed figures that the gate compares with: ``baseline.json``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, get_args

from benchmarks.metric import Better, Tolerance
from benchmarks.readings import Reading, Readings
from benchmarks.running import Mode

FORMAT = 1
"""Version of the file's layout."""

FILE = Path(__file__).with_name("baseline.json")


class BaselineError(Exception):
    """A baseline that cannot be used, or must not be written."""


@dataclass(frozen=True)
class Baseline:
    """Figures of an earlier run.

    Attributes:
        mode: "full" or "quick".
        seed: of all random numbers.
        readings: by "benchmark: figure".
        facts: machine, versions and time, for people.
    """

    mode: Mode
    seed: int
    readings: Readings
    facts: Mapping[str, Any] = field(default_factory=dict)


def load(path: Path) -> Baseline:
    """Read a baseline.

    Raises:
        BaselineError: no such file, another version of the layout, or content that is no baseline.
    """
    try:
        whole = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise BaselineError(f"{path}: no such file; --update-baseline writes it") from None
    except OSError as error:
        raise BaselineError(f"{path}: {error.strerror}") from None
    except ValueError as error:
        raise BaselineError(f"{path}: no JSON: {error}") from None
    found = whole.get("format") if isinstance(whole, dict) else None
    if found != FORMAT or isinstance(found, bool):
        raise BaselineError(
            f"{path}: format {found!r}, but this program reads {FORMAT}; --update-baseline anew"
        )
    try:
        metrics = whole["metrics"]
        found_readings = {name: _reading(name, each) for name, each in metrics.items()}
        if whole["mode"] not in get_args(Mode) or type(whole["seed"]) is not int:
            raise ValueError(f"mode {whole['mode']!r}, seed {whole['seed']!r}")
        return Baseline(whole["mode"], whole["seed"], found_readings, whole.get("facts", {}))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise BaselineError(f"{path}: not as this program writes it: {error!r}") from None


def save(path: Path, baseline: Baseline) -> None:
    """Write a baseline.

    Raises:
        BaselineError: nothing measured, a figure that is not a number, or a path that cannot be
            written.
    """
    if not baseline.readings:
        raise BaselineError("nothing was measured, so there is no baseline")
    wrong = [name for name, each in baseline.readings.items() if math.isnan(each.value)]
    if wrong:
        raise BaselineError(f"not a number, so it is no baseline: {'; '.join(wrong)}")
    whole = {
        "format": FORMAT,
        "mode": baseline.mode,
        "seed": baseline.seed,
        "facts": dict(baseline.facts),
        "metrics": {name: _portable(asdict(each)) for name, each in baseline.readings.items()},
    }
    text = json.dumps(whole, indent=1, allow_nan=False) + "\n"
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BaselineError(f"{path}: {error.strerror}") from None


def _portable(row: dict[str, Any]) -> dict[str, Any]:
    """Six digits, and the infinities that JSON does not have as strings."""
    for key, value in row.items():
        if isinstance(value, dict):
            row[key] = _portable(value)
        elif isinstance(value, float):
            row[key] = float(f"{value:.6g}") if math.isfinite(value) else str(value)
    return row


def _reading(name: str, row: Mapping[str, Any]) -> Reading:
    tolerance = row["tolerance"]
    of = tolerance["of"]
    if row["better"] not in get_args(Better) or of not in ("value", "advantage", "yardstick"):
        raise ValueError(f"{name}: better {row['better']!r}, tolerance of {of!r}")
    numbers = [float(each) for each in (tolerance["relative"], tolerance["absolute"])]
    value = float(row["value"])
    if math.isnan(value) or any(math.isnan(each) or each < 0.0 for each in numbers):
        raise ValueError(f"{name}: value {value}, tolerance {numbers}")
    return Reading(
        value, str(row["unit"]), row["better"], Tolerance(numbers[0], absolute=numbers[1], of=of)
    )
