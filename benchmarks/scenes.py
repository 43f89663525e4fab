"""Where the benchmarks measure: positions over a terrain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk import Trajectory
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


def weaving(
    terrain: Terrain,
    n: int,
    states: int,
    rng: np.random.Generator,
    *,
    start: tuple[float, float] = (10000.0, 16000.0),
    goal: tuple[float, float] = (22000.0, 25000.0),
    duration: float = 500.0,
    low: float = 15.0,
    high: float = 60.0,
) -> list[Trajectory]:
    """Random smooth trajectories of equal duration between two places, near the ground.

    Args:
        terrain: the ground.
        n: number of trajectories.
        states: in each of them.
        rng: source of randomness.
        start: (x, y) [m].
        goal: (x, y) [m].
        duration: of each [s].
        low: least height above the ground [m].
        high: usual height above the ground [m].
    """
    s, ends = np.linspace(0.0, 1.0, states), np.array([start, goal])
    along = ends[1] - ends[0]
    left = np.array([-along[1], along[0]]) / np.hypot(*along)
    modes = np.sin(np.pi * np.outer(np.arange(1, 9), s))
    fall = 1.0 / np.arange(1, 9)
    found = []
    for k in range(n):
        aside = (900.0 * fall**1.2 * rng.standard_normal(8)) @ modes
        xy = ends[0] + s[:, None] * along + aside[:, None] * left
        up = high + (0.6 * high * fall * rng.standard_normal(8)) @ modes
        z = terrain.height(xy[:, 0], xy[:, 1]) + np.maximum(up, low)
        positions = np.column_stack([xy, z])
        walked = np.cumsum(np.linalg.norm(np.diff(positions, axis=0), axis=1))
        t = np.concatenate([[0.0], walked * (duration / walked[-1])])
        found.append(Trajectory(t, positions, name=f"T{k}"))
    return found
