"""Hillshade: how bright each post is under a distant sun."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ompl_risk.terrains.checks import Pair, number


def hillshade(
    heights: NDArray[np.float64],
    spacing: Pair,
    azimuth: float,
    altitude: float,
    exaggeration: float,
) -> NDArray[np.float64]:
    """Lambert's law max(0, n . s) at each post, see `Terrain.hillshade`.

    With p, q the slopes eastwards and northwards times the exaggeration, n = (-p, -q, 1) / |.|
    and s = (sin az cos alt, cos az cos alt, sin alt).
    """
    az = math.radians(number("azimuth", azimuth))
    alt = math.radians(number("altitude", altitude, least=0.0, most=90.0))
    factor = number("exaggeration", exaggeration, above=0.0)
    q, p = np.gradient(heights, spacing[1], spacing[0])
    p *= factor
    q *= factor
    towards = math.sin(alt) - math.cos(alt) * (math.sin(az) * p + math.cos(az) * q)
    return np.clip(towards / np.sqrt(1.0 + p * p + q * q), 0.0, 1.0)
