"""The ground as coloured faces: a block of it, or all around the vehicle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import map_coordinates

from ompl_risk._arrays import FloatArray
from ompl_risk.report.camera import ground_below
from ompl_risk.report.faces import Faces

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

LOW, HIGH = np.array([0.84, 0.88, 0.78]), np.array([0.97, 0.93, 0.86])
"""Tints of the lowest and of the highest ground, in full light."""
WALL = np.array([0.62, 0.58, 0.53])
MOST = 24_000
"""Faces of a block at most; larger ones are drawn with every second post, or every third."""
RINGS, ACROSS = 7, 44
"""Sizes of cells around the vehicle, and cells of a size from side to side, a multiple of 4."""


class Paint:
    """Colours of a terrain's ground: a hillshade, tinted by height.

    Args:
        terrain: the ground.
    """

    def __init__(self, terrain: Terrain) -> None:
        self._terrain = terrain
        self._light = terrain.hillshade()
        self._low, self._high = float(terrain.heights.min()), float(terrain.heights.max())

    def colours(self, points: FloatArray) -> FloatArray:
        """Red, green, blue at points on the ground [m], shape (n, 3)."""
        (x0, y0), (dx, dy) = self._terrain.origin, self._terrain.spacing
        where = np.stack([(points[:, 1] - y0) / dy, (points[:, 0] - x0) / dx])
        light = map_coordinates(self._light, where, order=1, mode="nearest")
        bright = np.clip((light + 1.0) / 2.0, 0.0, 1.0)  # as the map from above has it
        share = np.clip((points[:, 2] - self._low) / max(self._high - self._low, 1e-9), 0.0, 1.0)
        return bright[:, None] * (LOW + share[:, None] * (HIGH - LOW))


def block(terrain: Terrain, base: float) -> Faces:
    """The whole of a terrain with walls down to a base [m]."""
    ny, nx = terrain.shape
    stride = math.ceil(math.sqrt((nx - 1) * (ny - 1) / MOST))
    chosen = [np.union1d(np.arange(0, n, stride), n - 1) for n in (ny, nx)]
    heights = terrain.heights[np.ix_(*chosen)]
    x, y = (a.start + a.step * c for a, c in zip(terrain.axes, chosen[::-1], strict=True))
    points = np.stack([*np.meshgrid(x, y), heights], axis=-1)
    top = _cells(points)
    rims = [points[0], points[-1], points[:, 0], points[:, -1]]
    walls = np.concatenate([_wall(rim, base) for rim in rims])
    colours = [Paint(terrain).colours(top.mean(axis=1)), np.tile(WALL, (len(walls), 1))]
    return Faces.quads(np.concatenate([top, walls]), np.concatenate(colours))


def around(terrain: Terrain, paint: Paint, centre: FloatArray, cell: float) -> Faces:
    """The ground around a place: small cells near it, each ring outwards of twice the size.

    Cells lie on a lattice that is fixed to the ground, so pictures of a moving vehicle show the
    same cells again. Every cell has a shade of its own by which movement is seen.

    Args:
        terrain: the ground; nothing is drawn beyond it.
        paint: its colours.
        centre: x, y [m].
        cell: size of the smallest cells [m].
    """
    corners: list[FloatArray] = []
    inner: tuple[float, float, float, float] | None = None
    for ring in range(RINGS):
        size = cell * 2.0**ring
        snapped = np.round(np.asarray(centre[:2]) / (2.0 * size)) * 2.0 * size
        reach = 0.5 * ACROSS * size
        cells = _lattice(terrain, snapped, size, inner)
        if len(cells):
            corners.append(cells)
        inner = (
            snapped[0] - reach, snapped[0] + reach, snapped[1] - reach, snapped[1] + reach
        )  # fmt: skip
    quads = np.concatenate(corners)
    middle = quads.mean(axis=1)
    shades = paint.colours(middle) * _patchwork(middle, cell)[:, None]
    return Faces.quads(quads, np.clip(shades, 0.0, 1.0))


def _lattice(
    terrain: Terrain,
    middle: FloatArray,
    size: float,
    inner: tuple[float, float, float, float] | None,
) -> FloatArray:
    """Cells around the middle and outside the inner box, within the terrain; shape (n, 4, 3)."""
    k = np.arange(-ACROSS // 2, ACROSS // 2 + 1) * size
    xmin, xmax, ymin, ymax = terrain.extent
    x, y = np.clip(middle[0] + k, xmin, xmax), np.clip(middle[1] + k, ymin, ymax)
    flat = np.stack(np.meshgrid(x, y), axis=-1)
    cells = _cells(np.concatenate([flat, ground_below(terrain, flat)[..., None]], axis=-1))
    centres = cells.mean(axis=1)
    keep = (np.ptp(cells[..., 0], axis=1) > 0) & (np.ptp(cells[..., 1], axis=1) > 0)
    if inner is not None:
        west, east, south, north = inner
        keep &= ~(
            (centres[:, 0] > west)
            & (centres[:, 0] < east)
            & (centres[:, 1] > south)
            & (centres[:, 1] < north)
        )
    return cells[keep]


def _patchwork(points: FloatArray, cell: float) -> FloatArray:
    """A factor near 1 for each field of the ground, about four of the smallest cells wide."""
    i, j = np.floor(points[:, :2] / (4.0 * cell)).T
    noise = np.sin(12.9898 * i + 78.233 * j) * 43758.5453
    return 0.955 + 0.07 * (noise - np.floor(noise))


def _cells(points: FloatArray) -> FloatArray:
    """The cells of a grid of points (rows, columns, 3), shape (n, 4, 3)."""
    corners = [points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]]
    return np.stack([c.reshape(-1, 3) for c in corners], axis=1)


def _wall(rim: FloatArray, base: float) -> FloatArray:
    """Faces from a rim down to a base, shape (n, 4, 3)."""
    foot = rim.copy()
    foot[:, 2] = base
    return np.stack([rim[:-1], rim[1:], foot[1:], foot[:-1]], axis=1)
