"""The ground and the flights that every view of them shows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.report.faces import Faces
from ompl_risk.report.ground import block
from ompl_risk.report.helicopter_glyph import LENGTH
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

MARGIN = 0.08
"""Ground around the flights, as a part of their extent."""
POINTS = 500
"""Points of a drawn curve, at equal times."""
GLYPH = 0.1
"""Length of a helicopter, as a part of the ground's longer side."""


@dataclass(frozen=True, eq=False)
class Scene:
    """What every view shows.

    Args:
        ground: the terrain below and around the flights.
        faces: the same as faces.
        curves: points of the flights [m].
        exaggeration: factor on the heights.
        scale: how many times its size a helicopter is drawn.
    """

    ground: Terrain
    faces: Faces
    curves: Sequence[FloatArray]
    exaggeration: float
    scale: float

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest corner of the ground [m]."""
        west, east, south, north = self.ground.extent
        heights = self.ground.heights
        return np.array([west, south, heights.min()]), np.array([east, north, heights.max()])


def scene_of(trajectories: Sequence[Trajectory], terrain: Terrain, exaggeration: float) -> Scene:
    """The ground around flights and their curves, and a size for helicopters.

    Raises:
        ExtentError: a flight leaves the terrain.
    """
    curves = [_curve(trajectory) for trajectory in trajectories]
    points = np.concatenate(curves)
    terrain.height(points[:, 0], points[:, 1])  # refuses flights that leave it
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    size = float((high - low).max())
    room = np.maximum(MARGIN * size, 0.25 * size - 0.5 * (high - low))  # no narrow strips
    xmin, xmax, ymin, ymax = terrain.extent
    west, south = np.maximum(low - room - 1.0, [xmin, ymin])
    east, north = np.minimum(high + room + 1.0, [xmax, ymax])
    ground = terrain.window((west, south, east, north))
    longer = max(east - west, north - south)
    base = float(ground.heights.min()) - 0.03 * longer / exaggeration
    scale = nice(GLYPH * longer / LENGTH)
    return Scene(ground, block(ground, base), curves, exaggeration, scale)


def nice(value: float) -> float:
    """The nearest round number (1, 2, 3, 5 or 7 times a power of ten), but not below 1."""
    value = max(value, 1.0)
    power = 10.0 ** math.floor(math.log10(value))
    return min((power * k for k in (1, 2, 3, 5, 7, 10)), key=lambda n: abs(math.log(n / value)))


def _curve(trajectory: Trajectory) -> FloatArray:
    times = np.linspace(trajectory.t[0], trajectory.t[-1], POINTS)
    return trajectory.resample(times).positions
