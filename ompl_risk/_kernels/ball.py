"""Share of a ball that lies in the ground."""

from __future__ import annotations

import math

from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import inside, signed_distance, surface_height, workspace


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


@entry
def quadrature(handle, points, radius, columns, grown, out):
    """Share of the ball around each point that is ground, by two interleaved sets of columns.

    Args:
        handle: of the height field.
        points: centres [m], shape (n, 3).
        radius: of the ball [m].
        columns: x, y, half height of a unit ball's columns, weight, set (0 or 1), shape (m, 5);
            the weights of each set sum up to 1 over full columns.
        grown: distance by which the ground is grown [m].
        out: estimates of both sets, shape (n, 2).
    """
    field, (stack, keys) = opened(handle), workspace()
    for k in range(len(points)):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        out[k, 0] = out[k, 1] = 0.0
        for c in range(len(columns)):
            u, v = _clamped(field, x + radius * columns[c, 0], y + radius * columns[c, 1])
            half = radius * columns[c, 2]
            if grown > 0.0:
                top = _grown_height(field, u, v, grown, z - half, z + half, stack, keys)
            else:
                top = surface_height(field, u, v)
            filled = min(max(top - (z - half), 0.0), 2.0 * half) / radius
            out[k, int(columns[c, 4])] += columns[c, 3] * filled


@entry
def in_ground(handle, points, out):
    """``out[k]`` = whether a point lies in the ground, which goes on level beyond the map."""
    field = opened(handle)
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if not inside(field, x, y):
            x, y = _clamped(field, x, y)
        out[k] = points[k, 2] <= surface_height(field, x, y)
