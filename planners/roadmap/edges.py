"""The edges of a growing roadmap, most of them never evaluated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import graph as kernels
from ompl_risk.planners.roadmap.graph import Graph, Integers, Rows, no_rows


class Edges:
    """Rows of half-edges as in ``Graph``, and per edge a weight that may only be a lower bound.

    ::

        weight = risk + time_weight * duration

    is what paths are searched by. The risk is not stored: at 25 edges a vertex every number counts.

    Args:
        time_weight: weight of a second; 0 for maximum norms.
        undirected: whether every edge can be flown both ways.

    Attributes:
        first, target, edge: see ``Graph``.
        weight: of the edges, exact or a lower bound, inf where they may not be flown, shape (m,).
        duration: of the edges [s], exact or a lower bound, shape (m,).
        known: whether weight and duration are exact, shape (m,).
    """

    def __init__(self, *, time_weight: float, undirected: bool) -> None:
        self.undirected, self._time_weight = undirected, time_weight
        self.first, self.target, self.edge = no_rows()
        self.weight: FloatArray = np.empty(0)
        self.duration: FloatArray = np.empty(0)
        self.known: NDArray[np.bool_] = np.empty(0, np.bool_)

    @property
    def m(self) -> int:
        """Number of edges."""
        return len(self.weight)

    @property
    def rows(self) -> Rows:
        """``first``, ``target`` and ``edge``."""
        return self.first, self.target, self.edge

    @property
    def backward(self) -> Rows:
        """The same with every edge turned round."""
        if self.undirected:
            return self.rows
        reverse = self.graph(maximum=False).reverse
        return reverse.first, reverse.target, reverse.edge

    def ends(self) -> tuple[Integers, Integers]:
        """Vertices at the tail and head of each edge, shape (m,)."""
        source = np.repeat(np.arange(len(self.first) - 1, dtype=np.int32), np.diff(self.first))
        tail, head = np.empty(self.m, np.int32), np.empty(self.m, np.int32)
        tail[self.edge], head[self.edge] = source, self.target
        return tail, head

    def add(
        self, n: int, tail: Integers, head: Integers, *, risk: FloatArray, duration: FloatArray
    ) -> None:
        """Add edges whose risk and duration are lower bounds, in a graph of n vertices by now."""
        self.first, self.target, self.edge = kernels.merged_rows(
            n, *self.rows, tail, head, self.m, self.undirected
        )
        weight = risk + self._time_weight * duration
        self.weight = np.concatenate([self.weight, weight])
        self.duration = np.concatenate([self.duration, duration])
        self.known = np.concatenate([self.known, np.zeros(len(risk), np.bool_)])

    def evaluated(self, numbers: Integers, risk: FloatArray, duration: FloatArray) -> None:
        """Take in the exact risk and duration of edges, inf where there is no way."""
        exists = np.isfinite(duration)
        self.duration[numbers[exists]] = duration[exists]
        weight = risk + self._time_weight * self.duration[numbers]
        self.weight[numbers] = np.where(exists, weight, np.inf)
        self.known[numbers] = True

    def risk(self, numbers: NDArray[np.integer] | slice = slice(None)) -> FloatArray:
        """Risk of edges: exactly 0 where it is 0, else to the rounding of the weight."""
        weight, spent = self.weight[numbers], self._time_weight * self.duration[numbers]
        flyable = np.isfinite(weight)
        return np.maximum(np.subtract(weight, spent, out=weight.copy(), where=flyable), 0.0)

    def graph(self, *, maximum: bool) -> Graph:
        """The edges that are known exactly; the others are left out by an infinite risk."""
        risk = np.where(self.known, self.risk(), np.inf)
        return Graph(*self.rows, risk, self.duration, maximum, self.undirected)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        columns = *self.rows, self.weight, self.duration, self.known
        return sum(column.nbytes for column in columns)
