"""Leaving out the corners of a fine path that it hardly needs."""

from __future__ import annotations

import numpy as np

from ompl_risk._arrays import FloatArray


def thinned(corners: FloatArray, off: float) -> FloatArray:
    """A path through some of the corners, off which no other lies by more than `off` [m].

    Args:
        corners: shape (n, 3) [m].
        off: tolerance [m].

    Reference: Douglas and Peucker, Cartographica 10 (1973).
    """
    keep = np.zeros(len(corners), dtype=np.bool_)
    keep[[0, -1]] = True
    open_ = [(0, len(corners) - 1)]
    while open_:
        i, j = open_.pop()
        if j - i < 2:
            continue
        distances = _distances(corners[i + 1 : j], corners[i], corners[j])
        k = int(distances.argmax())
        if distances[k] > off:
            keep[i + 1 + k] = True
            open_ += [(i, i + 1 + k), (i + 1 + k, j)]
    return corners[keep]


def _distances(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Distances of points from the segment between a and b."""
    chord, there = b - a, points - a
    square = float(chord @ chord)
    along = np.clip(there @ chord / square, 0.0, 1.0) if square > 0.0 else np.zeros(len(points))
    off = there - along[:, None] * chord
    return np.sqrt(np.einsum("ij,ij->i", off, off))
