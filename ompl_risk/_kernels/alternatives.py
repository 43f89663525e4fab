"""Which of many paths differ from each other."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.curves import cover_gates, is_outside, pass_gates, resample
from ompl_risk._kernels.frechet import are_near, squared_frechet, squared_greedy
from ompl_risk._kernels.jit import entry, kernel

SPARSE = 8
"""Every so many points of two curves are looked at before all of them."""


class Paths(NamedTuple):
    """Paths, one after the other.

    Attributes:
        first: path k has the vertices first[k] to first[k + 1], shape (p + 1,).
        vertices: of all paths.
        side: number of the side on which each passes, shape (p,).
    """

    first: NDArray[np.int64]
    vertices: NDArray[np.int32]
    side: NDArray[np.int32]


class Kept(NamedTuple):
    """Curves that others are compared with.

    Attributes:
        curves: shape (room, samples, k).
        low: least coordinates of each where it is near a gate, shape (room, gates, k).
        high: greatest coordinates likewise, shape (room, gates, k).
        side: number of their sides, shape (room,).
        recent: their numbers, in the order in which they are tried, shape (room,).
    """

    curves: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    side: NDArray[np.int32]
    recent: NDArray[np.int32]


@entry
def next_different(points, paths, order, place, kept, count, gates, bound):
    """The first path, from a place in an order, that differs from all those kept.

    Two paths differ if their sides do, or if the squared discrete Frechet distance of their curves
    is ``bound`` or more.

    Args:
        points: of the vertices, shape (n, k).
        paths: the paths.
        order: of the paths, shape (p,).
        place: in the order.
        kept: the paths kept, with room for one more, where the curve of the one found is put.
        count: how many are kept.
        gates: planes that paths pass.
        bound: squared.

    Returns:
        its place, the length of the order if there is none.
    """
    curve = kept.curves[count]
    row, at = np.empty(len(curve)), np.empty((len(gates.levels), points.shape[1]))
    while place < len(order):
        k = order[place]
        resample(points, paths.vertices[paths.first[k] : paths.first[k + 1]], curve)
        pass_gates(curve, gates, at)
        if not _is_known(curve, at, paths.side[k], kept, count, bound, row):
            break
        place += 1
    return place


@kernel
def _is_known(curve, at, side, kept, count, bound, row):
    for r in range(count):
        q = kept.recent[r]
        if kept.side[q] != side or is_outside(at, kept.low[q], kept.high[q]):
            continue
        other = kept.curves[q]
        if are_near(curve, other, SPARSE, bound) and (
            squared_greedy(curve, other, bound) < bound
            or squared_frechet(curve, other, bound, row) < bound
        ):
            _to_front(kept.recent, r)
            return True
    return False


@kernel
def _to_front(items, place):
    item = items[place]
    for i in range(place, 0, -1):
        items[i] = items[i - 1]
    items[0] = item


@entry
def keep(q, side, kept, gates, bound):
    """Keep the path found: note where its curve is near the gates.

    Args:
        q: how many were kept before.
        side: number of its side.
        kept: the paths kept.
        gates: planes that paths pass.
        bound: as in ``next_different``.
    """
    cover_gates(kept.curves[q], gates, math.sqrt(bound), kept.low[q], kept.high[q])
    kept.side[q] = side
    kept.recent[q] = q
    _to_front(kept.recent, q)


@entry
def farthest_first(curves, side, given, order):
    """Fill ``order``: those given, then new sides first, then the farthest from those before.

    Distances to those before are looked up only for the curve that is farthest by what is known:
    they can only fall.

    Args:
        curves: shape (p, samples, k).
        side: number of the side of each, shape (p,).
        given: curves to begin with, shape (g,), g at most count.
        order: out, shape (count,), count at most p.
    """
    nearest, compared = np.full(len(curves), math.inf), np.zeros(len(curves), np.int64)
    taken, known = np.zeros(len(curves), np.bool_), np.zeros(side.max() + 1, np.bool_)
    row = np.empty(curves.shape[1])
    for n in range(len(order)):
        best = given[min(n, len(given) - 1)]
        while n >= len(given):
            best = -1
            for i in range(len(curves)):
                if not taken[i] and (
                    best < 0
                    or known[side[i]] < known[side[best]]
                    or (known[side[i]] == known[side[best]] and nearest[i] > nearest[best])
                ):
                    best = i
            if compared[best] == n:
                break
            a, b = curves[best], curves[order[compared[best]]]
            bound = min(nearest[best], squared_greedy(a, b, nearest[best]))
            nearest[best] = min(bound, squared_frechet(a, b, bound, row))
            compared[best] += 1
        order[n], taken[best], known[side[best]] = best, True, True
