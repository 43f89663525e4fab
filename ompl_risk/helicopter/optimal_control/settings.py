"""The settings of a library of one's own, as a TOML file."""

from __future__ import annotations

import dataclasses
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.optimal_control.grid import Grid
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle
from ompl_risk.helicopter.parameters import Helicopter, Limits

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pyright: ignore[reportMissingImports]

DEGREES = "banks"  # of the grid: written in degrees
TABLES = {"helicopter": Helicopter, "limits": Limits, "grid": Grid}
MANOEUVRES = ("height", "reserve", "dt")


class Settings(NamedTuple):
    """What a library is made for, and what it has."""

    vehicle: Vehicle
    grid: Grid


def read_settings(path: Path) -> Settings:
    """Settings from a TOML file with the tables helicopter, limits, grid and manoeuvres.

    Their keys are the arguments of `Helicopter`, `Limits`, `Grid` (banks in degrees) and, for
    manoeuvres, height, reserve and dt of `Vehicle`; what is left out has its default.

    Raises:
        FileError: the file cannot be read, is no TOML, or has a key or value that is not allowed.
    """
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileError(path, f"is no TOML: {error}") from None
    allowed = {name: [f.name for f in dataclasses.fields(kind)] for name, kind in TABLES.items()}
    _check_names(path, tables, {**allowed, "manoeuvres": list(MANOEUVRES)})
    try:
        made = {name: kind(**_values(tables, name)) for name, kind in TABLES.items()}
        vehicle = Vehicle(made["helicopter"], made["limits"], **_values(tables, "manoeuvres"))
        return Settings(vehicle, made["grid"])
    except ArgumentError as error:
        raise FileError(path, str(error)) from None
    except TypeError as error:
        raise FileError(path, f"has a value of the wrong kind: {error}") from None


def default_settings() -> str:
    """The defaults as a TOML file, to start from."""
    tables: dict[str, dict[str, Any]] = {
        name: dataclasses.asdict(kind()) for name, kind in TABLES.items()
    }
    banks = [round(math.degrees(bank), 9) for bank in tables["grid"][DEGREES]]
    tables["grid"][DEGREES] = banks
    vehicle = Vehicle()
    tables["manoeuvres"] = {name: getattr(vehicle, name) for name in MANOEUVRES}
    blocks = [
        f"[{name}]\n" + "".join(f"{key} = {_written(v)}\n" for key, v in values.items())
        for name, values in tables.items()
    ]
    return "# SI units, angles in radians but for banks, which are in degrees\n" + "\n".join(blocks)


def _check_names(path: Path, tables: Mapping[str, Any], allowed: Mapping[str, list[str]]) -> None:
    for name, values in tables.items():
        if name not in allowed:
            raise FileError(path, f"has {name!r}", f"allowed are the tables {', '.join(allowed)}")
        if not isinstance(values, dict):
            raise FileError(path, f"{name} is no table", f"write [{name}] above its keys")
        for key in values:
            if key not in allowed[name]:
                there = ", ".join(allowed[name])
                raise FileError(path, f"[{name}] has {key!r}", f"allowed are {there}")


def _values(tables: Mapping[str, Mapping[str, Any]], name: str) -> dict[str, Any]:
    values = dict(tables.get(name, {}))
    if name == "grid" and DEGREES in values:
        values[DEGREES] = [math.radians(bank) for bank in values[DEGREES]]
    return values


def _written(value: Any) -> str:
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(repr, value)) + "]"
    return repr(value)
