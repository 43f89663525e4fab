"""Paths as curves, and a quick way to see that two are far apart."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.frechet import squared
from ompl_risk._kernels.jit import kernel


class Gates(NamedTuple):
    """Parallel planes that paths pass on their way, each the points x with x . across = level.

    A curve within r of another passes a gate where the other is within r, so within r of what the
    other covers in the slab of half-width r about the gate. Boxes around that tell most pairs of
    curves apart without going along them.

    Attributes:
        across: unit vector, shape (k,).
        levels: of the planes [m], shape (gates,).
        depth: half-width of the slabs [m], r and a step of a curve.
    """

    across: NDArray[np.float64]
    levels: NDArray[np.float64]
    depth: float


@kernel
def resample(points, path, out):
    """Points at equal arc lengths along a path, first and last included.

    Args:
        points: of the vertices, shape (n, k).
        path: vertices.
        out: shape (samples, k).
    """
    n = len(out) - 1
    length = 0.0
    for i in range(1, len(path)):
        length += _apart(points, path[i - 1], path[i])
    i, begin = 1, 0.0  # the piece that the sample is on, and the arc length where it begins
    piece = _apart(points, path[0], path[1]) if len(path) > 1 else 0.0
    for k in range(n + 1):
        s = length * k / n
        while i < len(path) - 1 and begin + piece < s:
            begin += piece
            i += 1
            piece = _apart(points, path[i - 1], path[i])
        t = min((s - begin) / piece, 1.0) if piece > 0.0 else 0.0
        for axis in range(points.shape[1]):
            a = points[path[max(i - 1, 0)], axis]
            out[k, axis] = a + t * (points[path[min(i, len(path) - 1)], axis] - a)


@kernel
def _apart(points, u, v):
    return math.sqrt(squared(points, u, points, v))


@kernel
def cover_gates(curve, gates, reach, low, high):
    """Write the boxes, larger by ``reach``, around what lies in the slab of each gate."""
    low[:] = math.inf
    high[:] = -math.inf
    for i in range(len(curve)):
        height = _height(curve, i, gates)
        for g in range(len(gates.levels)):
            if abs(height - gates.levels[g]) <= gates.depth:
                for axis in range(curve.shape[1]):
                    low[g, axis] = min(low[g, axis], curve[i, axis] - reach)
                    high[g, axis] = max(high[g, axis], curve[i, axis] + reach)


@kernel
def is_outside(at, low, high):
    """Whether a curve that passes the gates there is too far from the one in the boxes."""
    for g in range(at.shape[0]):
        for axis in range(at.shape[1]):
            if at[g, axis] < low[g, axis] or at[g, axis] > high[g, axis]:
                return True
    return False


@kernel
def _height(curve, i, gates):
    height = 0.0
    for axis in range(curve.shape[1]):
        height += curve[i, axis] * gates.across[axis]
    return height


@kernel
def pass_gates(curve, gates, at):
    """Write the first sample behind each gate; NaN, which is never outside, if there is none."""
    i = 0
    for g in range(len(gates.levels)):
        while i < len(curve) and _height(curve, i, gates) < gates.levels[g]:
            i += 1
        for axis in range(curve.shape[1]):
            at[g, axis] = curve[i, axis] if i < len(curve) else math.nan
