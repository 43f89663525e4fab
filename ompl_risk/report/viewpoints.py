"""From where a flight is best seen."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.report.camera import Camera

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

ELEVATION = math.radians(42.0)
CANDIDATES = 24
"""Directions that are tried."""
APART = math.radians(44.0)
"""Least difference of the directions of two views, while others are left."""
_COMPASS = (
    "east",
    "north-east",
    "north",
    "north-west",
    "west",
    "south-west",
    "south",
    "south-east",
)


def viewpoints(curves: Sequence[FloatArray], terrain: Terrain, exaggeration: float) -> list[float]:
    """A direction for each curve from which much of it is seen, and spread out.

    ::

        score = share of the curve that no ground hides x its extent across the line of sight

    The curves choose in their order; each leaves out directions that are near to ones taken.

    Args:
        curves: points [m], shape (n, 3) each.
        terrain: the ground.
        exaggeration: factor on the heights in the picture.

    Returns:
        Directions to the camera [rad], counterclockwise from east, 0 to 2 pi.
    """
    directions = 2.0 * math.pi * np.arange(CANDIDATES) / CANDIDATES
    taken: list[float] = []
    for curve in curves:
        scores = np.array([_score(curve, terrain, a, exaggeration) for a in directions])
        free = [all(_angle(a, b) >= APART for b in taken) for a in directions]
        if any(free):
            scores[~np.array(free)] = -1.0
        taken.append(float(directions[int(np.argmax(scores))]))
    return taken


def camera_towards(
    box: tuple[FloatArray, FloatArray], azimuth: float, exaggeration: float
) -> Camera:
    """A camera far off that looks at the middle of a box, (lowest, highest corner) [m]."""
    low, high = box
    return Camera.from_afar(
        0.5 * (low + high),
        azimuth=azimuth,
        elevation=ELEVATION,
        distance=4.0 * float(np.linalg.norm(high[:2] - low[:2])),
        exaggeration=exaggeration,
    )


def named(azimuth: float) -> str:
    """The nearest of the eight points of the compass."""
    return _COMPASS[round(azimuth / (0.25 * math.pi)) % 8]


def _score(curve: FloatArray, terrain: Terrain, azimuth: float, exaggeration: float) -> float:
    camera = camera_towards((curve.min(axis=0), curve.max(axis=0)), azimuth, exaggeration)
    places, _ = camera.project(curve)
    return float(camera.sees(curve, terrain).mean()) * float(np.ptp(places[:, 0]))


def _angle(a: float, b: float) -> float:
    return abs(math.remainder(a - b, 2.0 * math.pi))
