"""Exact distance from a point to a triangulated height field.

A search descends the pyramid of ``height_field``, nearest block first, and leaves out every block
whose lower bound is not below the best distance so far. Positions inside are relative to the
south-west post of the map.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.cells import nearest_in_cells
from ompl_risk._kernels.height_field import BASE, opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.prefetch import prefetch
from ompl_risk._kernels.surface import height_at

STACK = 128
"""Entries that a search can hold: three siblings for each of up to 28 levels, and room to spare."""

SCRATCH = STACK - 16
"""Where a family's bounds stand among the keys."""


@kernel
def surface_height(field, x, y):
    """Height of the surface [m] at a position inside the extent."""
    grid = field.grid
    return height_at(field.heights, grid[0], grid[1], grid[2], grid[3], x, y)


@kernel
def _bounds(blocks, family, south, west, wide, long, north, east, z, below, out):
    """Lower bounds for the squared distances to the surface in the four blocks of a family.

    The minimum of u^2 + v^2 + (over - a u - b v)^2 over each block's rectangle, (u, v) counted from
    the position. It is convex: either its free minimum lies inside, or the minimum lies on one of
    the sides that are visible from there; the two candidates below cover every case. Without
    branches, so that the compiler does all four at once. The bound is good only on the side of the
    plane on which the position is; else what remains is the distance to the rectangle.

    Args:
        blocks, family: whose planes.
        south, west: corner of the first block [m], from the position.
        wide, long: extent of a block along x and y [m].
        north, east: edges of the map [m], from the position.
        z: height of the position [m].
        below: 0 for the upper planes, 1 for the lower ones.
        out: bounds in 0 to 3; in 4 to 7 whether the position was on the plane's side.
    """
    sign = 1.0 - 2.0 * below
    for c in range(4):
        # not float(): numba keeps that in single precision, and a bound could then exceed the truth
        a, b = np.float64(blocks[family, c]), np.float64(blocks[family, 4 + c])
        offset = np.float64(blocks[family, 8 + 4 * below + c])
        u0, v0 = west + wide * (c & 1), south + long * (c >> 1)
        over = z + a * (u0 + 0.5 * wide) + b * (v0 + 0.5 * long) - offset
        u1, v1 = min(u0 + wide, east), min(v0 + long, north)
        aa, bb = 1.0 + a * a, 1.0 + b * b
        n = over / (aa + b * b)
        u = min(max(a * n, u0), u1)
        v = min(max(b * ((over - a * u) / bb), v0), v1)
        r1 = over - a * u - b * v
        q1 = u * u + v * v + r1 * r1
        v = min(max(b * n, v0), v1)
        u = min(max(a * ((over - b * v) / aa), u0), u1)
        r2 = over - a * u - b * v
        q2 = u * u + v * v + r2 * r2
        u, v = max(u0, -u1, 0.0), max(v0, -v1, 0.0)
        residual = sign * (r1 if q1 <= q2 else r2)
        out[c] = min(q1, q2) if residual >= 0.0 else u * u + v * v
        out[4 + c] = residual


@kernel
def nearest(field, x, y, z, bound, stack, keys):
    """Nearest surface point to a position inside the extent.

    Args:
        field: the terrain.
        x, y, z: position [m].
        bound: farther surface does not matter [m].
        stack, keys: work space, shapes (STACK, 3) int64 and (STACK,) float64.

    Returns:
        Squared distance (``bound ** 2`` if nothing is nearer) and the nearest point.
    """
    heights, levels = field.heights, field.levels
    ny, nx = heights.shape
    x0, y0, dx, dy = field.grid[0], field.grid[1], field.grid[2], field.grid[3]
    x, y = x - x0, y - y0
    jp, ip = min(max(int(x / dx), 0), nx - 2), min(max(int(y / dy), 0), ny - 2)
    best, qx, qy, qz = bound * bound, math.nan, math.nan, math.nan
    best, qx, qy, qz = nearest_in_cells(
        heights, ip, ip + 1, jp, jp + 1, -1, dx, dy, x, y, z, best, qx, qy, qz
    )
    reach = math.sqrt(best)
    j0, j1 = max(int((x - reach) / dx), 0), min(int((x + reach) / dx), nx - 2)
    i0, i1 = max(int((y - reach) / dy), 0), min(int((y + reach) / dy), ny - 2)
    if (j1 - j0 + 1) * (i1 - i0 + 1) <= 16:
        best, qx, qy, qz = nearest_in_cells(
            heights, i0, i1 + 1, j0, j1 + 1, ip * nx + jp, dx, dy, x, y, z, best, qx, qy, qz
        )
        return best, x0 + qx, y0 + qy, qz
    level, size = 0, 2 * BASE
    while (j1 // size != j0 // size or i1 // size != i0 // size) and level < len(levels) - 1:
        level += 1
        size *= 2
    top = _open(field, level, i0 // size, j0 // size, x, y, z, best, stack, keys, 0)
    while top > 0:
        top -= 1
        if keys[top] >= best:
            continue
        level, i, j = stack[top, 0], stack[top, 1], stack[top, 2]
        if level > 0:
            top = _open(field, level - 1, i, j, x, y, z, best, stack, keys, top)
            continue
        south, west = i * BASE, j * BASE
        north, east = min(south + BASE, ny - 1), min(west + BASE, nx - 1)
        best, qx, qy, qz = nearest_in_cells(
            heights, south, north, west, east, ip * nx + jp, dx, dy, x, y, z, best, qx, qy, qz
        )
    return best, x0 + qx, y0 + qy, qz


@kernel
def _open(field, level, i, j, x, y, z, best, stack, keys, top):
    """Put those blocks of family (i, j) of a level on the stack that may be near enough."""
    heights, blocks, levels = field.heights, field.blocks, field.levels
    ny, nx = heights.shape
    dx, dy = field.grid[2], field.grid[3]
    rows, columns = levels[level, 0], levels[level, 1]
    family = levels[level, 2] + i * levels[level, 3] + j
    wide, long = (BASE << level) * dx, (BASE << level) * dy
    west, south = 2 * j * wide - x, 2 * i * long - y
    east, north = (nx - 1) * dx - x, (ny - 1) * dy - y
    out = keys[SCRATCH:]
    _bounds(blocks, family, south, west, wide, long, north, east, z, 0, out)
    if min(out[4], out[5], out[6], out[7]) < 0.0:
        other = keys[SCRATCH + 8 :]
        _bounds(blocks, family, south, west, wide, long, north, east, z, 1, other)
        for c in range(4):
            out[c] = max(out[c], other[c])
    low = top
    for c in range(4):
        row, column = 2 * i + (c >> 1), 2 * j + (c & 1)
        if out[c] < best and row < rows and column < columns:
            _fetch(heights, blocks, levels, level, row, column)
            top = _push(stack, keys, low, top, out[c], level, row, column)
    return top


@kernel
def _fetch(heights, blocks, levels, level, i, j):
    """Start loading what a visit to the block will read: most of a search is waiting for memory."""
    if level > 0:
        prefetch(blocks, levels[level - 1, 2] + i * levels[level - 1, 3] + j, 0)
    else:
        for row in range(i * BASE, min((i + 1) * BASE + 1, len(heights))):
            prefetch(heights, row, j * BASE)


@kernel
def _push(stack, keys, low, top, key, level, i, j):
    """Insert into the entries from ``low`` to ``top``, farthest first."""
    k = top
    while k > low and keys[k - 1] < key:
        keys[k] = keys[k - 1]
        stack[k, 0], stack[k, 1], stack[k, 2] = stack[k - 1, 0], stack[k - 1, 1], stack[k - 1, 2]
        k -= 1
    keys[k] = key
    stack[k, 0], stack[k, 1], stack[k, 2] = level, i, j
    return top + 1


@kernel
def inside(field, x, y):
    """Whether a position lies within the map; false for NaN."""
    ny, nx = field.heights.shape
    x0, y0, dx, dy = field.grid[0], field.grid[1], field.grid[2], field.grid[3]
    # the very expressions of Terrain.extent: its corners are inside whatever the rounding
    return x >= x0 and y >= y0 and x <= x0 + (nx - 1) * dx and y <= y0 + (ny - 1) * dy


@kernel
def signed_distance(field, x, y, z, bound, stack, keys):
    """Distance to the surface [m], negative below it, -inf outside the map, at most ``bound``."""
    if not inside(field, x, y):
        return -math.inf
    if z >= surface_height(field, x, y):
        return math.sqrt(nearest(field, x, y, z, bound, stack, keys)[0])
    return -math.sqrt(nearest(field, x, y, z, math.inf, stack, keys)[0])


@entry
def workspace():
    """Work space of a search; one per thread."""
    return np.empty((STACK, 3), np.int64), np.empty(STACK, np.float64)


@entry
def signed_distances(handle, points, radius, bound, out):
    """``out[k]`` = clearance of a sphere of ``radius`` [m] at ``points[k]``, at most ``bound``."""
    field, (stack, keys) = opened(handle), workspace()
    for k in range(len(points)):
        d = signed_distance(
            field, points[k, 0], points[k, 1], points[k, 2], bound + radius, stack, keys
        )
        out[k] = d - radius


@entry
def nearest_points(handle, points, out):
    """``out[k]`` = nearest surface point to ``points[k]``; NaN outside the map."""
    field, (stack, keys) = opened(handle), workspace()
    for k in range(len(points)):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        if inside(field, x, y):
            _, out[k, 0], out[k, 1], out[k, 2] = nearest(field, x, y, z, math.inf, stack, keys)
        else:
            out[k] = math.nan
