"""Points in cubic buckets by their position, for searches in a metric that also counts the rest.

A point is a row of ``MARK`` numbers: position, quaternion, velocity in the world, angular velocity.
Every bucket is a list, linked in both directions through ``after`` and ``before``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.propagation import world_velocity

MARK = 13
"""Numbers in a mark."""

NONE = -1
"""No point."""


class Buckets(NamedTuple):
    """Where the points are.

    Attributes:
        low: corner of the first bucket [m], and the edge of a bucket [m], shape (4,).
        first: first point in each bucket, shape (nx, ny, nz).
        after, before: neighbours in the list, shapes (n,).
    """

    low: NDArray[np.float64]
    first: NDArray[np.int32]
    after: NDArray[np.int32]
    before: NDArray[np.int32]


@kernel
def set_row(rows, i, values):
    """``rows[i] = values``, for which numba would allocate."""
    for k in range(len(values)):
        rows[i, k] = values[k]


@kernel
def write_mark(state, mark):
    """The mark of a state: as it is, but with its velocity in the world."""
    for k in range(MARK):
        mark[k] = state[k]
    mark[7], mark[8], mark[9] = world_velocity(state)


@kernel
def apart(a, i, b, weights, bound):
    """Squared distance of mark ``a[i]`` from mark b; farther than ``bound``, something above that.

    ::

        |dp|^2 + w0 |du|^2 + w1 (2 sin(angle / 2))^2 + w2 |domega|^2

    Args:
        a: marks, shape (n, MARK).
        i: which.
        b: a mark.
        weights: w0 [s^2], w1 [m^2], w2 [m^2 s^2].
        bound: squared distance that matters [m^2].
    """
    p = u = o = q = 0.0
    for k in range(3):
        p += (a[i, k] - b[k]) ** 2
    if p > bound:
        return p
    for k in range(3):
        u += (a[i, 7 + k] - b[7 + k]) ** 2
        o += (a[i, 10 + k] - b[10 + k]) ** 2
    for k in range(3, 7):
        q += a[i, k] * b[k]
    return p + weights[0] * u + weights[1] * 4.0 * max(1.0 - q * q, 0.0) + weights[2] * o


@kernel
def place(buckets, value, axis):
    """Number of the bucket at a coordinate [m]; what is outside belongs to the nearest."""
    k = math.floor((value - buckets.low[axis]) / buckets.low[3])
    return min(max(k, 0), buckets.first.shape[axis] - 1)


@kernel
def places(buckets, mark, aside):
    """Numbers of the bucket of a position, moved by ``aside`` along each axis [m]."""
    return (
        place(buckets, mark[0] + aside, 0),
        place(buckets, mark[1] + aside, 1),
        place(buckets, mark[2] + aside, 2),
    )


@kernel
def put(buckets, i, mark):
    """Put point i into its bucket."""
    x, y, z = places(buckets, mark, 0.0)
    head = buckets.first[x, y, z]
    buckets.after[i], buckets.before[i] = head, NONE
    if head != NONE:
        buckets.before[head] = i
    buckets.first[x, y, z] = i


@kernel
def take(buckets, i, mark):
    """Take point i out of its bucket."""
    left, right = buckets.before[i], buckets.after[i]
    if right != NONE:
        buckets.before[right] = left
    if left != NONE:
        buckets.after[left] = right
    else:
        x, y, z = places(buckets, mark, 0.0)
        buckets.first[x, y, z] = right


@kernel
def nearest_within(buckets, marks, mark, radius, weights):
    """The point nearest to a mark, if it is within a radius; else NONE."""
    found, best = NONE, radius * radius
    x0, y0, z0 = places(buckets, mark, -radius)
    x1, y1, z1 = places(buckets, mark, radius)
    for x in range(x0, x1 + 1):
        for y in range(y0, y1 + 1):
            for z in range(z0, z1 + 1):
                i = buckets.first[x, y, z]
                while i != NONE:
                    d = apart(marks, i, mark, weights, best)
                    if d < best or (found == NONE and d <= best):
                        best, found = d, i
                    i = buckets.after[i]
    return found


@kernel
def least_near(buckets, marks, costs, mark, radius, weights):
    """The point of least cost within a radius of a mark, or else the nearest of all."""
    nx, ny, nz = buckets.first.shape
    cx, cy, cz = places(buckets, mark, 0.0)
    cheapest, least = NONE, math.inf
    nearest, best, near = NONE, math.inf, radius * radius
    for shell in range(max(nx, ny, nz)):
        reach = radius if cheapest != NONE else max(radius, math.sqrt(best))
        if (shell - 1) * buckets.low[3] >= reach:
            break
        x0, x1 = max(cx - shell, 0), min(cx + shell, nx - 1)
        y0, y1 = max(cy - shell, 0), min(cy + shell, ny - 1)
        z0, z1 = max(cz - shell, 0), min(cz + shell, nz - 1)
        for x in range(x0, x1 + 1):
            for y in range(y0, y1 + 1):
                inner = abs(x - cx) < shell and abs(y - cy) < shell
                z = z0
                while z <= z1:
                    if inner and abs(z - cz) < shell:
                        z = cz + shell  # the inside has been searched
                        continue
                    i = buckets.first[x, y, z]
                    while i != NONE:
                        if costs[i] < least:  # else it is not what is looked for
                            d = apart(marks, i, mark, weights, max(best, near))
                            if d <= near:
                                cheapest, least = i, costs[i]
                            elif d < best:
                                nearest, best = i, d
                        i = buckets.after[i]
                    z += 1
    return nearest if cheapest == NONE else cheapest
