"""The terrains that come with the library, by name."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import parametric
from ompl_risk.terrains.terrain import Terrain


@dataclass(frozen=True)
class File:
    """A terrain that is stored with the library.

    Attributes:
        path: the file.
        source: where its heights come from, in words.
    """

    path: Path
    source: str


FILES: Mapping[str, File] = MappingProxyType(
    {
        "jacksboro": File(
            Path(__file__).parent / "data" / "jacksboro_fault.tif",
            "SRTM, 3 arc-seconds, Jacksboro fault (Tennessee), from matplotlib's sample data",
        )
    }
)
PARAMETRIC: Mapping[str, Callable[..., Terrain]] = MappingProxyType(
    {
        "canyon": parametric.canyon,
        "fractal": parametric.fractal,
        "hills": parametric.hills,
        "ridge_valley": parametric.ridge_valley,
    }
)


def names() -> tuple[str, ...]:
    """Return the names that `load` knows, sorted."""
    return tuple(sorted([*FILES, *PARAMETRIC]))


def make(name: str, parameters: Mapping[str, Any]) -> Terrain:
    """Return the parametric terrain `name`.

    Raises:
        ArgumentError: a parameter is unknown or has a value that is not allowed.
    """
    known = inspect.signature(PARAMETRIC[name]).parameters
    for parameter, value in parameters.items():
        if parameter not in known:
            raise ArgumentError(
                parameter, value, f"left out: the parameters of {name} are {', '.join(known)}"
            )
    return PARAMETRIC[name](**parameters)
