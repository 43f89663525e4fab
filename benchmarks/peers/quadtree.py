"""Distance to a terrain with a plain quadtree of least and greatest heights.

The usual way to search a height field, here as the peer on terrains that are too large for a mesh
library, and as a second exact answer: it shares no code with the library's own search.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numpy.typing import NDArray

from ompl_risk.terrains import Terrain

LEAF = 2
"""Cells along the edge of a leaf; quicker than 1, 4 and 8."""

compiled = numba.njit(cache=True, error_model="numpy")


class QuadtreeGround:
    """Exact unsigned distances to a terrain.

    Args:
        terrain: the ground.
    """

    def __init__(self, terrain: Terrain) -> None:
        self._heights = terrain.heights
        self._grid = np.array([*terrain.origin, *terrain.spacing])
        low, high = _leaves(terrain.heights)
        lows, highs = [low.ravel()], [high.ravel()]
        shapes = [low.shape]
        while low.size > 1:
            low, high = _halved(low, np.minimum, math.inf), _halved(high, np.maximum, -math.inf)
            lows.append(low.ravel())
            highs.append(high.ravel())
            shapes.append(low.shape)
        starts = np.cumsum([0, *(level.size for level in lows[:-1])])
        self._levels = np.column_stack([np.array(shapes), starts]).astype(np.int64)
        self._low, self._high = np.concatenate(lows), np.concatenate(highs)

    @property
    def nbytes(self) -> int:
        """Memory besides the heights."""
        return self._low.nbytes + self._high.nbytes + self._levels.nbytes + self._grid.nbytes

    def distances(
        self, points: NDArray[np.float64], bound: float = math.inf
    ) -> NDArray[np.float64]:
        """Distance [m] from points (n, 3) to the surface, or ``bound`` where it is not nearer."""
        tree = self._low, self._high, self._levels
        found = np.empty(len(points))
        _search_all(self._heights, *tree, self._grid, points, bound * bound, found)
        return found


@compiled
def _leaves(heights):
    """Least and greatest height in each leaf."""
    ny, nx = heights.shape
    rows, columns = -(-(ny - 1) // LEAF), -(-(nx - 1) // LEAF)
    low, high = np.full((rows, columns), np.inf), np.full((rows, columns), -np.inf)
    for i in range(rows):
        for j in range(columns):
            for row in range(i * LEAF, min(i * LEAF + LEAF, ny - 1) + 1):
                for column in range(j * LEAF, min(j * LEAF + LEAF, nx - 1) + 1):
                    low[i, j] = min(low[i, j], heights[row, column])
                    high[i, j] = max(high[i, j], heights[row, column])
    return low, high


def _halved(level: NDArray[np.float64], combine: np.ufunc, blank: float) -> NDArray[np.float64]:
    """The next coarser level: 2 x 2 blocks combined."""
    rows, columns = -(-level.shape[0] // 2), -(-level.shape[1] // 2)
    padded = np.full((2 * rows, 2 * columns), blank)
    padded[: level.shape[0], : level.shape[1]] = level
    return combine.reduce(padded.reshape(rows, 2, columns, 2), axis=(1, 3))


@compiled
def _search_all(heights, low, high, levels, grid, points, limit, found):
    stack, keys = np.empty((4 * len(levels) + 4, 3), np.int64), np.empty(4 * len(levels) + 4)
    for k in range(len(points)):
        x, y, z = points[k, 0] - grid[0], points[k, 1] - grid[1], points[k, 2]
        found[k] = _search(
            heights, low, high, levels, grid[2], grid[3], x, y, z, limit, stack, keys
        )


@compiled
def _search(heights, low, high, levels, dx, dy, x, y, z, limit, stack, keys):
    """Depth first, nearest box first."""
    under = min(int(y / dy), heights.shape[0] - 2), min(int(x / dx), heights.shape[1] - 2)
    best = _cell(heights, under[0], under[1], dx, dy, x, y, z, limit)
    stack[0, 0], stack[0, 1], stack[0, 2], keys[0] = len(levels) - 1, 0, 0, 0.0
    top = 1
    while top > 0:
        top -= 1
        if keys[top] >= best:
            continue
        level, i, j = stack[top]
        if level == 0:
            for row in range(i * LEAF, min(i * LEAF + LEAF, heights.shape[0] - 1)):
                for column in range(j * LEAF, min(j * LEAF + LEAF, heights.shape[1] - 1)):
                    best = _cell(heights, row, column, dx, dy, x, y, z, best)
            continue
        level, bottom = level - 1, top
        size = LEAF << level
        for row in range(2 * i, min(2 * i + 2, levels[level, 0])):
            for column in range(2 * j, min(2 * j + 2, levels[level, 1])):
                block = levels[level, 2] + row * levels[level, 1] + column
                key = _box(
                    x - column * size * dx, y - row * size * dy, z,
                    size * dx, size * dy, low[block], high[block],
                )  # fmt: skip
                if key < best:
                    at = top
                    while at > bottom and keys[at - 1] < key:
                        keys[at], stack[at] = keys[at - 1], stack[at - 1]
                        at -= 1
                    keys[at] = key
                    stack[at, 0], stack[at, 1], stack[at, 2] = level, row, column
                    top += 1
    return math.sqrt(best)


@compiled
def _box(x, y, z, width, depth, low, high):
    """Squared distance from a point to a box with its south-west corner at the origin."""
    u, v = max(-x, x - width, 0.0), max(-y, y - depth, 0.0)
    w = max(low - z, z - high, 0.0)
    return u * u + v * v + w * w


@compiled
def _cell(heights, i, j, dx, dy, x, y, z, best):
    """Least of ``best`` and the squared distance to the two triangles of a cell."""
    u, v = x - j * dx, y - i * dy
    sw, se = heights[i, j] - z, heights[i, j + 1] - z
    nw, ne = heights[i + 1, j] - z, heights[i + 1, j + 1] - z
    if _box(u, v, 0.0, dx, dy, min(sw, se, nw, ne), max(sw, se, nw, ne)) >= best:
        return best
    best = min(best, _triangle(-u, -v, sw, dx, 0.0, se - sw, dx, dy, ne - sw))
    return min(best, _triangle(-u, -v, sw, dx, dy, ne - sw, 0.0, dy, nw - sw))


@compiled
def _triangle(ax, ay, az, ux, uy, uz, vx, vy, vz):
    """Squared distance from the origin to the triangle a, a + u, a + v.

    Reference: Ericson, Real-Time Collision Detection (2005), section 5.1.5.
    """
    d1, d2 = -(ax * ux + ay * uy + az * uz), -(ax * vx + ay * vy + az * vz)
    if d1 <= 0.0 and d2 <= 0.0:
        return ax * ax + ay * ay + az * az
    uu, uv, vv = (
        ux * ux + uy * uy + uz * uz,
        ux * vx + uy * vy + uz * vz,
        vx * vx + vy * vy + vz * vz,
    )
    d3, d4 = d1 - uu, d2 - uv
    d5, d6 = d1 - uv, d2 - vv
    if d3 >= 0.0 and d4 <= d3:
        s, t = 1.0, 0.0
    elif d6 >= 0.0 and d5 <= d6:
        s, t = 0.0, 1.0
    else:
        a, b, c = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
        if c <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
            s, t = d1 / uu, 0.0
        elif b <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
            s, t = 0.0, d2 / vv
        elif a <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
            t = (d4 - d3) / ((d4 - d3) + (d5 - d6))
            s = 1.0 - t
        else:
            s, t = b / (a + b + c), c / (a + b + c)
    px, py, pz = ax + s * ux + t * vx, ay + s * uy + t * vy, az + s * uz + t * vz
    return px * px + py * py + pz * pz
