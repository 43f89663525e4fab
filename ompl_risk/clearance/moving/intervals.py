"""When places among moving obstacles are free."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import moving_spans
from ompl_risk._kernels.moving import Tracks

Spans = tuple[NDArray[np.intp], FloatArray]
"""Places, and the begin and end [s] of a span for each, shapes (m,) and (m, 2)."""


class SafeIntervals(NamedTuple):
    """Intervals of time in which each of n places is free; they are closed.

    Attributes:
        first: those of place i are ``first[i]`` to ``first[i + 1] - 1``, shape (n + 1,).
        begin: when they begin [s], shape (m,), increasing for a place.
        end: when they end [s], shape (m,).
    """

    first: NDArray[np.int64]
    begin: FloatArray
    end: FloatArray

    def as_lists(self) -> list[list[tuple[float, float]]]:
        """A list of (begin, end) [s] for each place."""
        pairs = list(zip(self.begin.tolist(), self.end.tolist(), strict=True))
        first = self.first.tolist()
        return [pairs[first[i] : first[i + 1]] for i in range(len(first) - 1)]


class Wait(NamedTuple):
    """A time at which to stay where one is, and what counts as free then.

    Attributes:
        t0: its beginning [s].
        t1: its end [s], maybe infinite.
        enough: distance of a point that counts as free [m].
        resolution: of the ends of intervals [s].
    """

    t0: float
    t1: float
    enough: float
    resolution: float

    def blocked(self, tracks: Tracks, first: int, last: int, points: FloatArray) -> Spans:
        """Spans in which places are not certainly free of obstacles first to last - 1."""
        return moving_spans.blocked_spans(
            tracks, first, last, points, self.t0, self.t1, self.enough, self.resolution
        )

    def all_of(self, places: NDArray[np.bool_]) -> Spans:
        """The whole wait at the places that are true."""
        owners = np.flatnonzero(places)
        return owners, np.tile([self.t0, self.t1], (len(owners), 1))


def the_rest(blocked: Sequence[Spans], count: int, wait: Wait) -> SafeIntervals:
    """The parts of a wait that no span blocks, at each of ``count`` places."""
    owners = np.concatenate([places for places, _ in blocked])
    spans = np.concatenate([times for _, times in blocked])
    order = np.lexsort((spans[:, 0], owners))
    first, out = np.empty(count + 1, np.int64), np.empty((len(order) + count, 2))
    moving_spans.free_spans(owners[order], spans[order], count, wait.t0, wait.t1, first, out)
    begin, end = out[: first[-1]].T.copy()
    for array in (first, begin, end):
        array.setflags(write=False)
    return SafeIntervals(first, begin, end)
