"""Dropping and cutting corners of a path, many candidate motions at a time."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.improve.judge import FINE, Judge

SPAN = 6
"""Most legs that one straight motion replaces at a time."""

MARGIN = 4.0 * FINE
"""Share of the risk that a change has to save, so that no error of the norms makes it a loss. A
maximum need not fall: it often stays that of a corner."""

WORTH = 2e-5
"""Share of the path's risk and duration, added up, that a further corner has to save."""

CUTS = np.array([0.5, 0.25, 0.125, 0.03125])
"""How much of the legs at a corner is cut off, at most half: neighbours may be cut at a time."""

STRAIGHT = 1e-12
"""Corners nearer than this to a straight line [m, for each metre of coordinates] lie on it."""


class Shortcuts(NamedTuple):
    """Straight motions that may replace several legs of a path.

    Attributes:
        first, last: the corners between which they lead, shape (k,).
        powers: what they add to the p-th power of the norm, shape (k,).
    """

    first: NDArray[np.int64]
    last: NDArray[np.int64]
    powers: FloatArray


class Prices:
    """Shares of a path's risk and of its duration, added up; for p = inf of the duration alone.

    Args:
        judge: measures motions.
        corners: the path.
    """

    def __init__(self, judge: Judge, corners: FloatArray) -> None:
        self._judge = judge
        self.legs = judge.powers(corners[:-1], corners[1:])
        risk = self.legs.sum()
        additive = risk > 0.0 and not math.isinf(judge.risk.exponent)
        self._per_risk = 1.0 / float(risk) if additive else 0.0
        self._per_second = 1.0 / judge.duration(corners)

    def of(self, a: FloatArray, b: FloatArray, powers: FloatArray) -> FloatArray:
        """Prices of the motions from a[k] to b[k], whose powers are known."""
        risk = powers * self._per_risk if self._per_risk else 0.0  # not inf times 0
        return risk + self._judge.durations(a, b) * self._per_second


def drop_corners(corners: FloatArray, judge: Judge) -> FloatArray:
    """Replace runs of legs by straight motions, none of which raises the risk of its run.

    Of all ways to do so the cheapest by `Prices`, found by dynamic programming.
    """
    n = len(corners)
    prices = Prices(judge, corners)
    ways = _shortcuts(corners, prices.legs, judge)
    costs = prices.of(corners[ways.first], corners[ways.last], ways.powers)
    onward: list[list[tuple[int, float]]] = [[] for _ in range(n)]
    for i, j, cost in zip(ways.first.tolist(), ways.last.tolist(), costs.tolist(), strict=True):
        onward[i].append((j, cost))
    best, before = [math.inf] * n, [0] * n
    best[0] = 0.0
    for i, cost in enumerate(prices.of(corners[:-1], corners[1:], prices.legs).tolist()):
        for j, price in [(i + 1, cost * (1.0 + 1e-12)), *onward[i]]:  # on a par, fewer corners
            if best[i] + price < best[j]:
                best[j], before[j] = best[i] + price, i
    kept = [n - 1]
    while kept[-1] > 0:
        kept.append(before[kept[-1]])
    return corners[kept[::-1]]


def straightened(path: FloatArray) -> FloatArray:
    """The same path without corners on straight lines between others, and without duplicates."""
    apart = np.concatenate([[True], (path[1:] != path[:-1]).any(axis=1)])
    apart[1] |= not apart[1:].any()  # a path that stays where it is keeps two
    corners = path[apart]
    while True:
        count = len(corners)
        for first in (1, 2):  # never two neighbours at a time
            needless = np.zeros(len(corners), dtype=np.bool_)
            needless[first:-1:2] = _are_straight(corners, 2)[first - 1 :: 2]
            corners = corners[~needless]
        if len(corners) == count:
            return corners


def cut_corners(corners: FloatArray, judge: Judge) -> FloatArray:
    """Cut every corner at that scale of `CUTS` which saves most, if any saves anything."""
    if len(corners) < 3:
        return corners
    prices = Prices(judge, corners)
    count = len(CUTS)
    apex = np.repeat(corners[1:-1], count, axis=0)
    share = np.tile(CUTS, len(corners) - 2)[:, None]
    p = apex + share * (np.repeat(corners[:-2], count, axis=0) - apex)
    q = apex + share * (np.repeat(corners[2:], count, axis=0) - apex)
    into, out, across = (judge.powers(*ends) for ends in ((p, apex), (apex, q), (p, q)))
    around = _join(judge)(into, out)
    saved = prices.of(p, apex, into) + prices.of(apex, q, out) - prices.of(p, q, across)
    allowed = np.isfinite(across) & (across <= _enough(around, judge))
    saved = np.where(allowed, saved, -math.inf).reshape(-1, count)
    choice = saved.argmax(axis=1)
    result = [corners[:1]]
    for corner, scale in enumerate(choice.tolist()):
        k = corner * count + scale
        cut = saved[corner, scale] > WORTH
        result.append(np.array([p[k], q[k]]) if cut else corners[corner + 1 : corner + 2])
    return np.concatenate([*result, corners[-1:]])


def _shortcuts(corners: FloatArray, powers: FloatArray, judge: Judge) -> Shortcuts:
    """All motions over 2 to `SPAN` legs that risk no more than these."""
    n = len(corners)
    first, last, old, straight = [], [], [], []
    run = powers
    for span in range(2, min(SPAN, n - 1) + 1):
        run = _join(judge)(run[:-1], powers[span - 1 :])
        first.append(np.arange(n - span))
        last.append(np.arange(span, n))
        old.append(run)
        straight.append(_are_straight(corners, span))
    if not first:
        return Shortcuts(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
    i, j, sums = np.concatenate(first), np.concatenate(last), np.concatenate(old)
    new = judge.powers(corners[i], corners[j])
    better = np.concatenate(straight) | (new <= _enough(sums, judge))
    better &= np.isfinite(new)
    return Shortcuts(i[better], j[better], new[better])


def _are_straight(corners: FloatArray, span: int) -> NDArray[np.bool_]:
    """Whether runs of `span` legs lie on a straight line and never turn back."""
    a, b = corners[:-span], corners[span:]
    chord = b - a
    square = np.maximum(np.einsum("ij,ij->i", chord, chord), 1e-300)
    slack = STRAIGHT * (1.0 + np.abs(corners).max())
    straight, reached = np.ones(len(a), dtype=np.bool_), np.zeros(len(a))
    for k in range(1, span):
        there = corners[k : k + len(a)] - a
        along = np.einsum("ij,ij->i", there, chord) / square
        off = np.linalg.norm(there - along[:, None] * chord, axis=1)
        straight &= (off <= slack) & (along >= reached) & (along <= 1.0)
        reached = along
    return straight


def _enough(powers: FloatArray, judge: Judge) -> FloatArray:
    """What a motion may risk that replaces others."""
    return powers if math.isinf(judge.risk.exponent) else powers * (1.0 - MARGIN)


def _join(judge: Judge) -> np.ufunc:
    """How the powers of motions that follow each other combine."""
    return np.maximum if math.isinf(judge.risk.exponent) else np.add
