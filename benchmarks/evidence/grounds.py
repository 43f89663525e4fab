"""The grounds that units are drawn from, by kind and seed, and which of them are for training."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from ompl_risk import TerrainClearance, terrains
from ompl_risk.terrains import Terrain

RADIUS = 5.0
"""Of the vehicle's sphere [m]."""

Range = tuple[float, float]


@dataclass(frozen=True)
class Kind:
    """One kind of ground.

    Attributes:
        split: "train" or "test".
        first: seed of the first terrain of the kind.
        ranges: within which each parameter of a terrain is drawn, uniformly and by its seed; those
            called "... / ..." are ratios of two parameters.
    """

    split: str
    first: int
    ranges: Mapping[str, Range]


KINDS: Mapping[str, Kind] = MappingProxyType(
    {
        "hills": Kind("train", 0, {"radius": (300.0, 900.0), "height / radius": (0.25, 0.6)}),
        "jacksboro": Kind("test", 1000, {}),
        "ridge_valley": Kind(
            "train",
            0,
            {
                "wavelength": (1000.0, 3000.0),
                "relief / wavelength": (0.1, 0.2),
                "azimuth": (0.0, 180.0),
                "passes": (0.3, 0.7),
            },
        ),
        "canyon": Kind(
            "test",
            1000,
            {
                "depth": (200.0, 600.0),
                "floor": (100.0, 400.0),
                "wall / depth": (0.8, 2.0),
                "meander": (600.0, 1500.0),
            },
        ),
        "fractal": Kind("test", 1000, {"hurst": (0.8, 1.0), "rms_slope": (0.2, 0.45)}),
    }
)
"""In the order in which units take their turns."""


def parameters(name: str, seed: int) -> dict[str, Any]:
    """What the terrain of that kind and seed is made with; nothing for a terrain from a file."""
    ranges = KINDS[name].ranges
    if not ranges:
        return {}
    random = np.random.default_rng([seed, list(KINDS).index(name)])
    drawn = {key: float(random.uniform(*limits)) for key, limits in ranges.items()}
    chosen: dict[str, Any] = {"seed": seed}
    for key, value in drawn.items():
        parameter, _, other = key.partition(" / ")
        chosen[parameter] = value * drawn[other] if other else value
    if name == "hills":  # as many of them that they cover the ground alike, whatever their size
        chosen["count"] = round(40 * (900.0 / chosen["radius"]) ** 2)
    if name == "ridge_valley":
        chosen["meander"] = 0.1 * chosen["wavelength"]
    return chosen


def terrain(name: str, seed: int) -> Terrain:
    """The terrain of that kind and seed; those from a file are the same whatever the seed."""
    return terrains.load(name, **parameters(name, seed))


@lru_cache(maxsize=len(KINDS))
def ground(name: str, seed: int) -> TerrainClearance:
    """The clearance over a terrain, made once for units that follow each other."""
    return TerrainClearance(terrain(name, seed), RADIUS, threads=1)
