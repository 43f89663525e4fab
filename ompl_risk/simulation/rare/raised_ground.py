"""How far the ground would have to rise for a plan to touch it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.clearance import TerrainClearance
from ompl_risk.simulation.loop.clearance_parts import grounds

PRECISION = 0.01
"""Of a lift [m]."""


def lifts(clearance: Any, points: FloatArray, most: float) -> NDArray[np.float64]:
    """Least constant error of the map with which the vehicle would touch the ground.

    ::

        lift(x, y, z) = min { c >= 0 : d(x, y, z - c) <= 0 }

    By sphere tracing downwards: d is 1-Lipschitz, so a step of d never goes too far.

    Args:
        clearance: over the ground.
        points: positions [m], shape (n, 3).
        most: lifts above it need not be told apart [m].

    Returns:
        Lifts [m], shape (n,), at most ``most``; 0 off the map.
    """
    found = np.full(len(points), most)
    for ground in grounds(clearance):
        np.minimum(found, _lifts(ground, points, most), out=found)
    return found


def _lifts(ground: TerrainClearance, points: FloatArray, most: float) -> NDArray[np.float64]:
    lift, active = np.zeros(len(points)), np.arange(len(points))
    while len(active):
        lowered = points[active]
        lowered[:, 2] -= lift[active]
        d = ground(lowered)
        lift[active] += np.maximum(d, 0.0)
        active = active[(d > PRECISION) & (lift[active] < most)]
    return np.minimum(lift, most)
