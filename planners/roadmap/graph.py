"""The graph that paths are searched in, and its shortest paths."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import graph as kernels
from ompl_risk.errors import ArgumentError

Integers = NDArray[np.int32]
Rows = tuple[NDArray[np.int64], Integers, Integers]


def no_rows() -> Rows:
    """``first``, ``target`` and ``edge`` of a graph without vertices."""
    return np.zeros(1, np.int64), np.empty(0, np.int32), np.empty(0, np.int32)


@dataclass(frozen=True, eq=False)
class Graph:
    """Vertices and edges, each edge with its risk and its duration.

    The half-edges that leave vertex v stand in the rows ``first[v]`` to ``first[v + 1]``. An
    undirected edge has a half-edge at both of its ends.

    Attributes:
        first: shape (n + 1,).
        target: vertex at the end of each half-edge, shape (h,).
        edge: number of its edge, shape (h,).
        risk: what the edges add to the p-th power of the norm, or for a maximum norm f at its
            greatest; inf where they may not be flown, shape (m,).
        duration: of the edges [s], shape (m,).
        maximum: whether risks combine by their maximum rather than their sum.
        undirected: whether every edge can be flown both ways.
    """

    first: NDArray[np.int64]
    target: Integers
    edge: Integers
    risk: FloatArray
    duration: FloatArray
    maximum: bool = False
    undirected: bool = True

    @classmethod
    def of_edges(
        cls,
        n: int,
        ends: ArrayLike,
        risk: ArrayLike,
        duration: ArrayLike,
        *,
        maximum: bool = False,
        undirected: bool = True,
    ) -> Graph:
        """A graph of n vertices from its edges.

        Args:
            n: number of vertices.
            ends: vertices at the tail and head of each edge, shape (m, 2).
            risk: of the edges, 0 or more, shape (m,).
            duration: of the edges [s], 0 or more, shape (m,).
            maximum: whether risks combine by their maximum.
            undirected: whether every edge can be flown both ways.

        Raises:
            ArgumentError: shapes that do not fit, ends out of range, negative numbers or NaN.
        """
        ends = np.asarray(ends, dtype=np.int32).reshape(-1, 2)
        if len(ends) and (ends.min() < 0 or ends.max() >= n):
            raise ArgumentError("ends", int(ends.min()), f"vertices from 0 to {n - 1}")
        given = {"risk": risk, "duration": duration}
        columns = {k: np.ascontiguousarray(v, dtype=np.float64) for k, v in given.items()}
        for name, column in columns.items():
            if column.shape != (len(ends),):
                raise ArgumentError(f"{name}.shape", column.shape, f"({len(ends)},), as ends")
            if not (column >= 0.0).all():
                raise ArgumentError(name, float(column[~(column >= 0.0)][0]), "0 or more")
        tail, head = (np.ascontiguousarray(column) for column in ends.T)
        rows = kernels.merged_rows(n, *no_rows(), tail, head, 0, undirected)
        return cls(*rows, columns["risk"], columns["duration"], maximum, undirected)

    @property
    def n(self) -> int:
        """Number of vertices."""
        return len(self.first) - 1

    @property
    def m(self) -> int:
        """Number of edges."""
        return len(self.risk)

    @cached_property
    def source(self) -> Integers:
        """Vertex that each half-edge leaves, shape (h,)."""
        return np.repeat(np.arange(self.n, dtype=np.int32), np.diff(self.first))

    @cached_property
    def reverse(self) -> Graph:
        """The graph with every edge turned round; itself if undirected."""
        if self.undirected:
            return self
        order = np.argsort(self.edge)
        tail, head = self.target[order], self.source[order]
        rows = kernels.merged_rows(self.n, *no_rows(), tail, head, 0, False)
        return Graph(*rows, self.risk, self.duration, self.maximum, undirected=False)

    @property
    def flyable_duration(self) -> FloatArray:
        """Durations [s], inf for edges that may not be flown, shape (m,)."""
        return np.where(np.isfinite(self.risk), self.duration, math.inf)

    def tree(self, roots: ArrayLike, weight: FloatArray, *, maximum: bool = False) -> Tree:
        """Shortest paths from the roots to all vertices.

        Args:
            roots: vertices, shape (r,).
            weight: of the edges, 0 or more, inf to leave one out, shape (m,).
            maximum: whether a path is as long as its longest edge.
        """
        seeds = np.atleast_1d(np.asarray(roots, dtype=np.int32))
        tree = Tree(
            np.full(self.n, math.inf), np.full(self.n, -1, np.int32), np.full(self.n, -1, np.int64)
        )
        tree.distance[seeds] = 0.0
        kernels.shortest_paths(
            self.first, self.target, self.edge, weight, seeds, maximum,
            tree.distance, tree.parent, tree.via,
        )  # fmt: skip
        return tree

    def way(self, start: int, half_edges: NDArray[np.int64]) -> Way:
        """The path from a vertex along half-edges."""
        vertices = np.append(np.int32(start), self.target[half_edges])
        edges = self.edge[half_edges]
        risk = self.risk[edges]
        total = risk.max(initial=0.0) if self.maximum else risk.sum()
        return Way(vertices, edges, float(self.duration[edges].sum()), float(total))


@dataclass(frozen=True, eq=False)
class Tree:
    """Shortest paths from one or several roots to all vertices.

    Attributes:
        distance: from the roots, inf where there is no path, shape (n,).
        parent: vertex before on the path, -1 at roots and where there is no path, shape (n,).
        via: half-edge from the parent, -1 likewise, shape (n,).
    """

    distance: FloatArray
    parent: NDArray[np.int32]
    via: NDArray[np.int64]

    def vertices(self, end: int) -> NDArray[np.int32]:
        """Vertices of the path from a root to ``end``, root first; empty if there is none."""
        if not math.isfinite(self.distance[end]):
            return np.empty(0, np.int32)
        path = [int(end)]
        while self.parent[path[-1]] >= 0:
            path.append(int(self.parent[path[-1]]))
        return np.array(path[::-1], dtype=np.int32)

    def half_edges(self, end: int) -> NDArray[np.int64]:
        """Half-edges of the same path, in the same order."""
        return self.via[self.vertices(end)[1:]]


@dataclass(frozen=True, eq=False)
class Way:
    """A path in a graph.

    Attributes:
        vertices: from start to goal, shape (k,).
        edges: between them, shape (k - 1,).
        duration: [s].
        risk: p-th power of its norm, or its maximum norm; without any weight of time.
    """

    vertices: NDArray[np.int32]
    edges: NDArray[np.int32]
    duration: float
    risk: float
