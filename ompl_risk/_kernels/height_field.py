"""A height field and the pyramid of blocks that makes searching it quick.

The surface: posts on a regular grid, every cell split by the diagonal from its south-west to its
north-east post. A block covers a square of cells and stores one plane (slopes a, b) and two
offsets, so that all of its posts lie between ``a u + b v + lo`` and ``a u + b v + hi`` with (u, v)
counted from the block's centre. The distance to the half-space below the upper plane, within the
block's rectangle, is a lower bound for the distance to the surface in it, and on sloping ground a
far tighter one than the block's bounding box gives.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import carray  # pyright: ignore[reportPrivateImportUsage]
from numpy.typing import NDArray

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.pointers import float32_at, float64_at, int64_at

BASE = 2
"""Cells along the edge of a block on the finest level of the pyramid."""


class HeightField(NamedTuple):
    """What the kernels need to know of a terrain.

    Attributes:
        heights: posts [m], shape (ny, nx), row 0 in the south.
        blocks: four a, four b, four hi and four lo for the four children of a block, a family, in
            one cache line; shape (families, 16), level after level, finest first.
        levels: rows and columns of blocks, first family, columns of families of each level, shape
            (levels, 4).
        grid: x0, y0, dx, dy [m], shape (4,).
    """

    heights: NDArray[np.float64]
    blocks: NDArray[np.float32]
    levels: NDArray[np.int64]
    grid: NDArray[np.float64]


def handle(field: HeightField) -> NDArray[np.int64]:
    """Addresses and sizes of the arrays, for ``opened``; the caller keeps the arrays alive."""
    sizes = (*field.heights.shape, len(field.blocks), len(field.levels))
    addresses = (x.ctypes.data for x in field)
    return np.array([*addresses, *sizes], dtype=np.int64)


@entry
def opened(handle):
    """The height field behind a handle."""
    return HeightField(
        carray(float64_at(handle[0]), (handle[4], handle[5])),
        carray(float32_at(handle[1]), (handle[6], 16)),
        carray(int64_at(handle[2]), (handle[7], 4)),
        carray(float64_at(handle[3]), (4,)),
    )


def pyramid_shape(ny: int, nx: int) -> NDArray[np.int64]:
    """``HeightField.levels`` for a map of ny x nx posts, up to the level that is a single block."""
    levels, first, size = [], 0, BASE
    while True:
        rows, columns = -(-(ny - 1) // size), -(-(nx - 1) // size)
        families = (rows + 1) // 2, (columns + 1) // 2
        levels.append((rows, columns, first, families[1]))
        first += families[0] * families[1]
        if rows == columns == 1:
            return np.array(levels, dtype=np.int64)
        size *= 2


@entry
def fit_blocks(heights, dx, dy, size, columns, families, out, first, last):
    """Fill ``out``, one level of blocks, with the planes of block rows ``first`` to ``last``."""
    ny, nx = heights.shape
    for i in range(first, last):
        for j in range(columns):
            south, west = i * size, j * size
            north, east = min(south + size, ny - 1), min(west + size, nx - 1)
            a, b = _slopes(heights, south, north, west, east, dx, dy)
            a, b = np.float64(np.float32(a)), np.float64(np.float32(b))
            u0, v0 = -0.5 * size * dx, -0.5 * size * dy
            hi, lo = -math.inf, math.inf
            for row in range(south, north + 1):
                at = b * (v0 + (row - south) * dy) + a * u0
                for column in range(west, east + 1):
                    residual = heights[row, column] - (at + a * dx * (column - west))
                    hi = max(hi, residual)
                    lo = min(lo, residual)
            slack = 1e-9 * (abs(hi) + abs(lo)) + 1e-12
            family, child = (i >> 1) * families + (j >> 1), 2 * (i & 1) + (j & 1)
            out[family, child], out[family, 4 + child] = a, b
            out[family, 8 + child] = _round_up(hi + slack)
            out[family, 12 + child] = -_round_up(slack - lo)


@kernel
def _round_up(value):
    """Smallest float32 that is not below ``value``, or the next one."""
    return np.nextafter(np.float32(value), np.float32(np.inf))


@kernel
def _slopes(heights, south, north, west, east, dx, dy):
    """Least-squares slopes of the posts of a block."""
    rows, columns = north - south + 1, east - west + 1
    su = sv = 0.0
    for row in range(south, north + 1):
        total = 0.0
        moment = 0.0
        for column in range(west, east + 1):
            h = heights[row, column]
            total += h
            moment += h * (column - west)
        su += moment - 0.5 * (columns - 1) * total
        sv += total * (row - south - 0.5 * (rows - 1))
    # sum of (k - mean)^2 for k = 0 .. n-1 is n (n^2 - 1) / 12
    a = su / (rows * columns * (columns * columns - 1) / 12.0 * dx)
    b = sv / (columns * rows * (rows * rows - 1) / 12.0 * dy)
    return a, b
