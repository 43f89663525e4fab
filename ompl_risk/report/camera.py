"""A camera over the ground: where points come to lie in a picture, and which are hidden."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

SAMPLES = 192
"""Points of a line of sight at which it is compared with the ground."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera whose horizon is level.

    With S = diag(1, 1, exaggeration), forward, right and up of unit length in the space that is
    stretched by S, and r = S (p - position)::

        depth = r . forward
        (x, y) = (r . right, r . up) / depth

    so a length l across the line of sight at depth s has l / s in the picture.

    Args:
        position: where it is [m], shape (3,).
        target: what it looks at [m], shape (3,), not straight below or above.
        exaggeration: factor on the heights.
    """

    position: FloatArray
    target: FloatArray
    _: KW_ONLY
    exaggeration: float = 1.0

    @classmethod
    def from_afar(
        cls,
        target: FloatArray,
        *,
        azimuth: float,
        elevation: float,
        distance: float,
        exaggeration: float = 1.0,
    ) -> Camera:
        """A camera that stands off.

        Args:
            target: what it looks at [m], shape (3,).
            azimuth: direction from the target to the camera [rad], counterclockwise from east.
            elevation: of the camera above the horizon [rad], as it looks in the picture.
            distance: from the target [m], in the picture.
            exaggeration: factor on the heights.
        """
        away = np.array(
            [
                math.cos(elevation) * math.cos(azimuth),
                math.cos(elevation) * math.sin(azimuth),
                math.sin(elevation) / exaggeration,
            ]
        )
        return cls(target + distance * away, target, exaggeration=exaggeration)

    @property
    def stretch(self) -> FloatArray:
        """The diagonal of S, shape (3,)."""
        return np.array([1.0, 1.0, self.exaggeration])

    @cached_property
    def axes(self) -> FloatArray:
        """Right, up and forward in stretched space, the rows of shape (3, 3)."""
        forward = (self.target - self.position) * self.stretch
        forward = forward / np.linalg.norm(forward)
        right = np.array([forward[1], -forward[0], 0.0]) / math.hypot(forward[0], forward[1])
        return np.stack([right, np.cross(right, forward), forward])

    def project(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Where points are in the picture, shape (..., 2), and their depths [m], shape (...).

        Points that are not in front of the camera have NaN for a place.

        Args:
            points: [m], shape (..., 3).
        """
        turned = ((points - self.position) * self.stretch) @ self.axes.T
        depth = turned[..., 2]
        ahead = np.where(depth > 0.0, depth, np.nan)
        return turned[..., :2] / ahead[..., None], depth

    def sees(self, points: FloatArray, terrain: Terrain, slack: float = 1.0) -> NDArray[np.bool_]:
        """Whether no ground is between points and the camera.

        Stretching heights keeps straight lines straight, so exaggeration plays no part.

        Args:
            points: [m], shape (n, 3).
            terrain: the ground; beyond its extent nothing hides.
            slack: ground that reaches into a line of sight by less than this [m] does not hide.

        Returns:
            Shape (n,).
        """
        away = self.position - points
        with np.errstate(divide="ignore", invalid="ignore"):
            over = (float(terrain.heights.max()) - points[:, 2]) / away[:, 2]
        farthest = np.where(away[:, 2] > 0.0, np.clip(over, 0.0, 1.0), 1.0)
        share = np.linspace(0.0, 1.0, SAMPLES + 1)[1:]
        lines = points[:, None] + (farthest[:, None] * share)[..., None] * away[:, None]
        ground = ground_below(terrain, lines, outside=-np.inf)
        return np.all(ground <= lines[..., 2] + slack, axis=1)


def ground_below(terrain: Terrain, points: FloatArray, outside: float | None = None) -> FloatArray:
    """Heights of the ground under points, shape (..., 3) or (..., 2) [m].

    Args:
        terrain: the ground.
        points: [m].
        outside: what to return beyond the extent; that of its nearest edge if None.
    """
    xmin, xmax, ymin, ymax = terrain.extent
    x, y = points[..., 0], points[..., 1]
    heights = terrain.height(np.clip(x, xmin, xmax), np.clip(y, ymin, ymax))
    if outside is None:
        return heights
    inside = (x >= xmin) & (x <= xmax) & (y >= ymin) & (y <= ymax)
    return np.where(inside, heights, outside)
