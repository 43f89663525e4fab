"""What norms are made of: distance, slope, curvature, speed and P_c at the samples of a flight."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk import TerrainClearance, collision_probability
from ompl_risk.helicopter.flight import Flight
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

COLUMNS = ("d", "up", "curvature", "speed", "pc")
REACH = 60.0
"""Half the length over which the ground's curvature is taken [m]."""
BITS = 13
"""Significant bits of what is stored: 4 significant digits, and files half as large."""

Floats = NDArray[np.float64]


def profile(
    flight: Flight, clearance: TerrainClearance, *, step: float, radius: float
) -> dict[str, NDArray[np.float32]]:
    """Columns of a flight, sampled every ``step`` and at its end.

    ::

        d           clearance of the vehicle's sphere [m]
        up          upward component of the gradient of d: 1 over flat ground
        curvature   half the Laplacian of the map at the nearest point, over +-60 m [1/m]:
                    positive in a bowl
        speed       [m/s]
        pc          P_c, the paper's probability of collision

    Args:
        flight: as planned.
        clearance: to the ground.
        step: [s].
        radius: r of P_c [m].
    """
    trajectory = flight.trajectory(step=step)
    points = np.ascontiguousarray(trajectory.positions)
    columns = {
        "d": clearance(points),
        "up": clearance.gradient(points)[:, 2],
        "curvature": curvature(clearance.terrain, clearance.nearest(points)[:, :2]),
        "speed": speeds(trajectory),
        "pc": collision_probability(trajectory, clearance, radius, max_step=None).p,
    }
    return {name: rounded(values) for name, values in columns.items()}


def speeds(trajectory: Trajectory) -> Floats:
    """[m/s], shape (n,)."""
    if trajectory.velocities is None:
        raise ValueError("a flight without velocities")
    return np.linalg.norm(trajectory.velocities, axis=1)


def curvature(terrain: Terrain, places: Floats) -> Floats:
    """Half the Laplacian of the map [1/m], by differences over ``REACH``.

    Args:
        terrain: the map; beyond its edge the ground goes on level.
        places: x, y [m], shape (n, 2).
    """
    xmin, xmax, ymin, ymax = terrain.extent
    low, high = np.array([xmin, ymin]), np.array([xmax, ymax])

    def height(dx: float, dy: float) -> Floats:
        return terrain.height(*np.clip(places + np.array([dx, dy]), low, high).T)

    across = height(REACH, 0.0) + height(-REACH, 0.0) + height(0.0, REACH) + height(0.0, -REACH)
    return 0.5 * (across - 4.0 * height(0.0, 0.0)) / REACH**2


def rounded(values: Floats) -> NDArray[np.float32]:
    """To ``BITS`` significant bits, to nearest."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(np.ldexp(mantissa, BITS)), exponent - BITS).astype(np.float32)
