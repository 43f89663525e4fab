"""Lower bounds for pairs of vertices, some at a time: an interruption loses none of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.motion import MotionBatch
from ompl_risk.planners.roadmap.graph import Integers

CHUNK = 1 << 15
"""Pairs that are bounded at a time: some 20 ms where a steering has to be asked."""


class Bounded(NamedTuple):
    """The pairs between which there may be a motion.

    Attributes:
        tail, head: vertices, shape (m,).
        risk: lower bounds, shape (m,).
        duration: lower bounds [s], shape (m,).
    """

    tail: Integers
    head: Integers
    risk: FloatArray
    duration: FloatArray


class Bounding:
    """Pairs of vertices whose bounds are being found.

    Args:
        motions: between vertices.
        states: of all vertices, shape (n, width).
        clearance: there [m], shape (n,).
        tail: where motions begin, shape (m,).
        head: where they end, shape (m,).
    """

    def __init__(
        self,
        motions: MotionBatch,
        states: FloatArray,
        clearance: FloatArray,
        tail: Integers,
        head: Integers,
    ) -> None:
        self.states, self.clearance = states, clearance
        self._motions, self._tail, self._head = motions, tail, head
        self._risk, self._duration = np.empty(len(tail)), np.empty(len(tail))
        self._done = 0

    def finished(self, stop: Callable[[], bool]) -> bool:
        """Go on, by a chunk at least, until ``stop`` says so; whether all have been bounded."""
        while self._done < len(self._tail):
            part = slice(self._done, self._done + CHUNK)
            a, b = self._tail[part], self._head[part]
            self._risk[part], self._duration[part] = self._motions.edge_bounds(
                self.states[a], self.states[b], self.clearance[a], self.clearance[b]
            )
            self._done += len(a)
            if stop():
                break
        return self._done == len(self._tail)

    def result(self) -> Bounded:
        """The pairs with a finite duration: there is no motion between the others."""
        columns = Bounded(self._tail, self._head, self._risk, self._duration)
        exist = np.isfinite(self._duration)
        if exist.all():
            return columns
        tail, head, risk, duration = columns
        return Bounded(tail[exist], head[exist], risk[exist], duration[exist])
