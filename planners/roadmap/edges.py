"""The edges of a growing roadmap, most of them never evaluated."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import graph as kernels
from ompl_risk.planners.roadmap.graph import Graph, Integers, no_rows


class Edges:
    """Rows of half-edges as in ``Graph``, and per edge a risk that may only be a lower bound.

    Args:
        undirected: whether every edge can be flown both ways.

    Attributes:
        first, target, edge: see ``Graph``.
        risk: of the edges, exact or a lower bound, shape (m,).
        duration: of the edges [s], shape (m,).
        known: whether the risk is exact, shape (m,).
    """

    def __init__(self, *, undirected: bool) -> None:
        self.undirected = undirected
        self.first, self.target, self.edge = no_rows()
        self.risk: FloatArray = np.empty(0)
        self.duration: FloatArray = np.empty(0)
        self.known: NDArray[np.bool_] = np.empty(0, np.bool_)

    @property
    def m(self) -> int:
        """Number of edges."""
        return len(self.risk)

    @property
    def source(self) -> Integers:
        """Vertex that each half-edge leaves, shape (h,)."""
        return np.repeat(np.arange(len(self.first) - 1, dtype=np.int32), np.diff(self.first))

    @property
    def backward(self) -> tuple[NDArray[np.int64], Integers]:
        """Rows of the vertices from which half-edges come to each vertex."""
        if self.undirected:
            return self.first, self.target
        reverse = self.graph(maximum=False).reverse
        return reverse.first, reverse.target

    def add(
        self,
        n: int,
        tail: Integers,
        head: Integers,
        *,
        risk: FloatArray,
        duration: FloatArray,
    ) -> None:
        """Add edges, in a graph that has n vertices by now, whose risk is only a lower bound."""
        rows = self.first, self.target, self.edge
        self.first, self.target, self.edge = kernels.merged_rows(
            n, *rows, tail, head, self.m, self.undirected
        )
        self.risk = np.concatenate([self.risk, risk])
        self.duration = np.concatenate([self.duration, duration])
        self.known = np.concatenate([self.known, np.zeros(len(risk), np.bool_)])

    def graph(self, *, maximum: bool) -> Graph:
        """The edges whose risk is known; the others are left out by an infinite risk."""
        risk = np.where(self.known, self.risk, np.inf)
        rows = self.first, self.target, self.edge
        return Graph(*rows, risk, self.duration, maximum, self.undirected)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        columns = self.first, self.target, self.edge, self.risk, self.duration, self.known
        return sum(column.nbytes for column in columns)
