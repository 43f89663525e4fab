"""Where the benchmarks measure: positions over a terrain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk.terrains import Terrain


def above_ground(
    terrain: Terrain,
    n: int,
    rng: np.random.Generator,
    *,
    low: float,
    high: float,
    margin: float = 0.0,
) -> NDArray[np.float64]:
    """Random positions all over a terrain, in random order, so that no query helps the next.

    Args:
        terrain: the ground.
        n: number of positions.
        rng: source of randomness.
        low: least height above the ground [m].
        high: greatest height above the ground [m].
        margin: distance from the edges of the map [m].

    Returns:
        Positions [m], shape (n, 3).
    """
    xmin, xmax, ymin, ymax = terrain.extent
    x = rng.uniform(xmin + margin, xmax - margin, n)
    y = rng.uniform(ymin + margin, ymax - margin, n)
    return np.column_stack([x, y, terrain.height(x, y) + rng.uniform(low, high, n)])
