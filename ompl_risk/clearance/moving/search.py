"""Least distances on timed motions, for obstacles that are asked from Python; see ``travel``."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._pieces import Pieces
from ompl_risk.clearance.moving.travel import Travel, lowest

BLOCK = 16_384
"""Most pieces that are halved at a time: bounds the memory that they take."""


class TimedMotions(NamedTuple):
    """Straight motions at constant velocity.

    Attributes:
        a, b: where they begin and end [m], shape (n, 3).
        ta, tb: when [s], shape (n,).
    """

    a: FloatArray
    ta: FloatArray
    b: FloatArray
    tb: FloatArray

    def at(self, k: NDArray[np.intp], s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places (m, 3) [m] and times (m,) [s] at fractions s of the motions k."""
        a, ta, b, tb = self.chosen(k)
        return a + s[:, None] * (b - a), ta + s * (tb - ta)

    def chosen(self, k: NDArray[np.intp] | slice) -> TimedMotions:
        """The motions k."""
        return TimedMotions(self.a[k], self.ta[k], self.b[k], self.tb[k])


class Approach(NamedTuple):
    """How near motions come to the obstacles.

    Attributes:
        d: least distances [m], shape (n,).
        t: when they are found [s], shape (n,).
    """

    d: FloatArray
    t: FloatArray


Distance = Callable[[FloatArray, FloatArray], FloatArray]
"""Distances [m] of points (m, 3) at times (m,)."""

Travels = Callable[[TimedMotions], Travel]
"""How motions go against the obstacle."""


def lower_least(
    motions: TimedMotions,
    k: NDArray[np.intp],
    distance: Distance,
    travels: Travels,
    least: FloatArray,
    when: FloatArray,
    *,
    tolerance: float,
    floor: float = -np.inf,
) -> None:
    """Lower ``least[k]`` to the least distance on the motions k, and set ``when`` to its time.

    Args:
        motions: all motions.
        k: those to search.
        distance: to the obstacle.
        travels: how motions go against it.
        least: least distances found so far [m], shape (n,); at the end too great by at most the
            tolerance.
        when: times of them [s], shape (n,).
        tolerance: [m].
        floor: a motion is left once its least distance is found to be no greater than this [m].
    """

    def ask(k: NDArray[np.intp], s: FloatArray) -> FloatArray:
        points, times = motions.at(k, s)
        d = distance(points, times)
        order = np.argsort(-d, kind="stable")  # the least of a motion is written last
        lower = order[d[order] < least[k[order]]]
        least[k[lower]], when[k[lower]] = d[lower], times[lower]
        return d

    s0, s1 = np.zeros(len(k)), np.ones(len(k))
    waiting = [Pieces(k, s0, s1, ask(k, s0), ask(k, s1))]
    while waiting:
        pieces = waiting.pop()
        if len(pieces.k) > BLOCK:
            waiting.append(pieces.chosen(slice(BLOCK, None)))
            pieces = pieces.chosen(slice(BLOCK))
        (p0, t0), (p1, t1) = motions.at(pieces.k, pieces.s0), motions.at(pieces.k, pieces.s1)
        bound = lowest(pieces.d0, pieces.d1, travels(TimedMotions(p0, t0, p1, t1)))
        found, middle = least[pieces.k], pieces.middle
        matters = (bound < found - tolerance) & (found > floor)
        pieces = pieces.chosen(matters & (pieces.s0 < middle) & (middle < pieces.s1))
        if len(pieces.k):
            waiting.append(pieces.halved(ask(pieces.k, pieces.middle)))


def still_blocked(
    motions: TimedMotions,
    distance: Distance,
    travels: Travels,
    *,
    enough: float,
    resolution: float,
) -> tuple[NDArray[np.intp], FloatArray]:
    """Spans of waits, motions that stay where they are, in which d may be ``enough`` or less.

    Args:
        motions: the waits.
        distance: to the obstacle.
        travels: how motions go against it.
        enough: distance that counts as free [m].
        resolution: pieces as short as this [s] are divided no further.

    Returns:
        Which wait each span belongs to, and its begin and end [s], shape (m, 2); in no order.
    """
    owners, spans = [np.empty(0, np.intp)], [np.empty((0, 2))]
    d0, d1 = distance(motions.a, motions.ta), distance(motions.a, motions.tb)
    pieces = Pieces(np.arange(len(motions.a)), motions.ta, motions.tb, d0, d1)
    while len(pieces.k):
        k, t0, t1, d0, d1 = pieces
        travel = travels(TimedMotions(motions.a[k], t0, motions.a[k], t1))
        free = lowest(d0, d1, travel) > enough
        middle = pieces.middle
        small = (t1 - t0 <= resolution) | (middle <= t0) | (t1 <= middle)
        blocked = ~free & (small | (0.5 * (d0 + d1 + travel.whole) <= enough))
        owners.append(k[blocked])
        spans.append(np.stack([t0[blocked], t1[blocked]], axis=1))
        pieces = pieces.chosen(~free & ~blocked)
        pieces = pieces.halved(distance(motions.a[pieces.k], pieces.middle))
    return np.concatenate(owners), np.concatenate(spans)
