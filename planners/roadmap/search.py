"""Shortest paths that evaluate only the edges they need."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import graph as kernels
from ompl_risk.planners.roadmap.edges import Edges
from ompl_risk.planners.roadmap.graph import Integers, Tree

Weigh = Callable[[FloatArray, FloatArray], FloatArray]
"""From risks and durations of edges to their weights; it may not fall as the risk rises."""

Evaluate = Callable[[Integers, Integers, Integers], None]
"""Evaluates edges, given with the vertices at their tails and heads."""


class LazySearch:
    """A tree of shortest paths by weights that are lower bounds until an edge matters.

    The shortest path by bounds is looked up, its edges that are only bounded are evaluated, and the
    tree is repaired where they turn out dearer; until a shortest path is all exact. No other path
    is shorter then, however few edges were evaluated.

    Reference: Dellin & Srinivasa, A unifying formalism for shortest path problems with expensive
    edge evaluations via lazy best-first search, ICAPS 2016 (LazySP, forward selector).

    Args:
        edges: of the roadmap.
        weigh: weights of edges.
        maximum: whether a path is as long as its longest edge.
    """

    def __init__(self, edges: Edges, weigh: Weigh, *, maximum: bool = False) -> None:
        self._edges, self._weigh, self._maximum = edges, weigh, maximum
        self._weight = np.empty(0)
        self._first = np.zeros(1, np.int64)
        self._roots: list[int] = []
        self.tree = Tree(np.empty(0), np.empty(0, np.int32), np.empty(0, np.int64))

    @property
    def nbytes(self) -> int:
        """Memory of tree and weights."""
        tree = self.tree
        return sum(x.nbytes for x in (self._weight, tree.distance, tree.parent, tree.via))

    def update(self, roots: Sequence[int]) -> None:
        """Take in edges and roots that have been added since the last time."""
        edges, old = self._edges, self.tree
        n, n_old, m_old = len(edges.first) - 1, len(old.distance), len(self._weight)
        added = slice(m_old, edges.m)
        new_weights = self._weigh(edges.risk[added], edges.duration[added])
        self._weight = np.concatenate([self._weight, new_weights])
        parent = np.concatenate([old.parent, np.full(n - n_old, -1, np.int32)])
        distance = np.concatenate([old.distance, np.full(n - n_old, math.inf)])
        via = np.full(n, -1, np.int64)
        child = np.flatnonzero(parent >= 0)
        # Old half-edges stand at the beginning of the new rows, in the old order.
        shift = edges.first[parent[child]] - self._first[parent[child]]
        via[child] = old.via[child] + shift
        self.tree = Tree(distance, parent, via)
        distance[[root for root in roots if root not in self._roots]] = 0.0
        self._roots, self._first = list(roots), edges.first
        self._relax(np.unique(edges.source[edges.edge >= m_old]), roots)

    def _relax(self, seeds: Integers, roots: Sequence[int]) -> None:
        edges, tree = self._edges, self.tree
        seeds = np.union1d(seeds, np.array(roots, np.int32)).astype(np.int32)
        kernels.shortest_paths(
            edges.first, edges.target, edges.edge, self._weight,
            seeds[np.isfinite(tree.distance[seeds])], self._maximum,
            tree.distance, tree.parent, tree.via,
        )  # fmt: skip

    def path(
        self, goals: Sequence[int], evaluate: Evaluate, stop: Callable[[], bool]
    ) -> NDArray[np.int64] | None:
        """Half-edges of a shortest path from a root to a goal, all of them evaluated.

        Returns:
            None if there is no path, or if ``stop`` says so before it is found.
        """
        while not stop():
            distances = self.tree.distance[list(goals)]
            goal = goals[int(np.argmin(distances))]
            if not math.isfinite(distances.min()):
                return None
            half = self.tree.half_edges(goal)
            doubtful = half[~self._edges.known[self._edges.edge[half]]]
            if not len(doubtful):
                return half
            self._settle(self.tree.vertices(goal), half, evaluate)
        return None

    def _settle(
        self, vertices: Integers, half_edges: NDArray[np.int64], evaluate: Evaluate
    ) -> None:
        """Evaluate the edges of a path that are only bounded, and repair the tree."""
        edges = self._edges
        numbers = edges.edge[half_edges]
        open_ = np.flatnonzero(~edges.known[numbers])
        evaluate(numbers[open_], vertices[open_], vertices[open_ + 1])
        open_ = open_[edges.known[numbers[open_]]]  # evaluation may have been stopped half way
        numbers = numbers[open_]
        before = self._weight[numbers]
        self._weight[numbers] = self._weigh(edges.risk[numbers], edges.duration[numbers])
        raised = vertices[open_ + 1][self._weight[numbers] > before]
        rows = edges.first, edges.target, edges.edge
        kernels.repair_paths(
            *rows, *edges.backward, self._weight, raised, self._maximum,
            self.tree.distance, self.tree.parent, self.tree.via,
        )  # fmt: skip
