"""Share of a ball that lies in the ground."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import inside, signed_distance, surface_height, workspace

_in_any_order: Any = {"reassoc", "contract", "nsz"}
summing = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=_in_any_order)
"""As ``entry``, for sums of many terms whose order may change: only so does the compiler make
vector instructions of them. Infinities and not-a-number keep their meaning."""


@kernel
def _clamped(field, x, y):
    """The position, or the nearest one on the map: beyond its edge the ground goes on level."""
    ny, nx = field.heights.shape
    x0, y0, dx, dy = field.grid[0], field.grid[1], field.grid[2], field.grid[3]
    return min(max(x, x0), x0 + (nx - 1) * dx), min(max(y, y0), y0 + (ny - 1) * dy)


@kernel
def _grown_height(field, x, y, grown, low, high, stack, keys):
    """Height in [low, high] up to which a column lies within ``grown`` of the ground.

    The ground reaches down without end, and so does the ground grown by a sphere: the column is
    walked from its top by the distance, which cannot overshoot.
    """
    z = high
    resolution = 1e-9 * (1.0 + high - low)
    while z > low:
        d = signed_distance(field, x, y, z, math.inf, stack, keys) - grown
        if d <= resolution:
            return z
        z -= d
    return low


@summing
def quadrature(handle, points, radius, columns, d, out):
    """Share of the ball around each point that is ground, by two interleaved sets of columns.

    Written for the compiler to work on several columns at a time: no branch, no store and no
    division in the inner loop, which is ``height_at`` in units of cells. Several times quicker.

    Args:
        handle: of the height field.
        points: centres [m], shape (n, 3).
        radius: of the ball [m].
        columns: x, y, half height of a unit ball's columns, their weights in the first and in the
            second set, shape (5, m); the weights of each set sum up to 1 over full columns.
        d: distances to the ground [m], shape (n,); from the radius on, it is out of reach.
        out: estimates of both sets, shape (n, 2).
    """
    field = opened(handle)
    ny, nx = field.heights.shape
    heights = field.heights.reshape(ny * nx)
    x0, y0, dx, dy = field.grid[0], field.grid[1], field.grid[2], field.grid[3]
    east, north = np.float64(nx - 1), np.float64(ny - 1)
    last_i, last_j = np.int32(nx - 2), np.int32(ny - 2)  # the last post belongs to the last cell
    wide, long, row, one = radius / dx, radius / dy, np.uint64(nx), np.uint64(1)
    for k in range(len(points)):
        if d[k] >= radius:
            out[k, 0] = out[k, 1] = 0.0
            continue
        u0, v0, z = (points[k, 0] - x0) / dx, (points[k, 1] - y0) / dy, points[k, 2]
        first = second = 0.0
        for c in range(columns.shape[1]):
            u = min(max(u0 + wide * columns[0, c], 0.0), east)
            v = min(max(v0 + long * columns[1, c], 0.0), north)
            i, j = min(np.int32(u), last_i), min(np.int32(v), last_j)
            fx, fy = u - i, v - j
            sw = np.uint64(j) * row + np.uint64(i)
            most, least = max(fx, fy), min(fx, fy)
            beside = heights[sw + (one if fx >= fy else row)]
            top = (1.0 - most) * heights[sw] + (most - least) * beside
            top += least * heights[sw + row + one]
            half = radius * columns[2, c]
            filled = min(max(top - (z - half), 0.0), 2.0 * half)
            first += columns[3, c] * filled
            second += columns[4, c] * filled
        out[k, 0], out[k, 1] = first / radius, second / radius


@entry
def grown_quadrature(handle, points, radius, columns, d, grown, out):
    """The same for the ground grown by a distance [m], above 0; d is to the grown ground."""
    field, (stack, keys) = opened(handle), workspace()
    for k in range(len(points)):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        out[k, 0] = out[k, 1] = 0.0
        if d[k] >= radius:
            continue
        for c in range(columns.shape[1]):
            u, v = _clamped(field, x + radius * columns[0, c], y + radius * columns[1, c])
            half = radius * columns[2, c]
            top = _grown_height(field, u, v, grown, z - half, z + half, stack, keys)
            filled = min(max(top - (z - half), 0.0), 2.0 * half) / radius
            out[k, 0] += columns[3, c] * filled
            out[k, 1] += columns[4, c] * filled


@entry
def in_ground(handle, points, out):
    """``out[k]`` = whether a point lies in the ground, which goes on level beyond the map."""
    field = opened(handle)
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if not inside(field, x, y):
            x, y = _clamped(field, x, y)
        out[k] = points[k, 2] <= surface_height(field, x, y)
