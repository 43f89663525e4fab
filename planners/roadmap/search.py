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

Evaluate = Callable[[Integers, Integers, Integers], None]
"""Evaluates edges, given with the vertices at their tails and heads; perhaps not all of them."""

Weigh = Callable[[FloatArray, FloatArray], FloatArray]
"""From risks and durations of edges to their weights."""


class LazySearch:
    """Shortest paths by weights that are lower bounds until an edge matters.

    The shortest path by bounds is looked up, and its edges that are only bounded are evaluated;
    again, until a shortest path is all exact. No other path is shorter then, however few edges
    were evaluated. What makes the look-ups quick is the tree of shortest ways to the goals: as
    weights only rise, its distances stay lower bounds, and guide A* along little more than the
    path. Edges that are added later can only shorten them, which is repaired.

    Reference: Dellin & Srinivasa, A unifying formalism for shortest path problems with expensive
    edge evaluations via lazy best-first search, ICAPS 2016 (LazySP, forward selector).

    Args:
        edges: of the roadmap.
        maximum: whether a path is as long as its longest edge.

    Attributes:
        rest: lower bounds for the way from each vertex to a goal, shape (n,).
    """

    def __init__(self, edges: Edges, *, maximum: bool = False) -> None:
        self._edges, self._maximum = edges, maximum
        self._rows = np.zeros(1, np.int64)
        self._goals: list[int] = []
        self._fresh = 0
        self.rest: FloatArray = np.empty(0)

    def weight(self) -> FloatArray:
        """Weights of the edges, shape (m,)."""
        return self._edges.weight

    def update(self, goals: Sequence[int]) -> None:
        """Take in vertices, their edges, and goals that have been added since the last time."""
        n, n_old = len(self._edges.first) - 1, len(self.rest)
        if n > 2 * self._fresh:  # bounds that have been raised since are not in the tree: anew
            n_old, self._fresh, self._goals = 0, n, []
        self.rest = np.concatenate([self.rest[:n_old], np.full(n - n_old, math.inf)])
        self.rest[[goal for goal in goals if goal not in self._goals]] = 0.0
        backward = self._edges.backward
        longer = np.diff(backward[0])
        longer[:n_old] -= np.diff(self._rows)[:n_old]
        seeds = np.flatnonzero((longer > 0) & np.isfinite(self.rest))
        self._goals, self._rows = list(goals), backward[0]
        kernels.shortest_paths(
            *backward, self.weight(), seeds.astype(np.int32), self._maximum,
            self.rest, np.empty(n, np.int32), np.empty(n, np.int64),
        )  # fmt: skip

    def path(
        self, roots: Sequence[int], evaluate: Evaluate, stop: Callable[[], bool]
    ) -> NDArray[np.int64] | None:
        """Half-edges of a shortest path from a root to a goal, all of them evaluated.

        Returns:
            None if there is no path, or if ``stop`` says so before it is found.
        """
        n = len(self.rest)
        tree = Tree(np.empty(n), np.empty(n, np.int32), np.empty(n, np.int64))
        ends = np.array(roots, np.int32), np.array(self._goals, np.int32)
        while not stop():
            goal = kernels.guided_path(
                *self._edges.rows, self.weight(), self.rest, *ends, self._maximum,
                tree.distance, tree.parent, tree.via,
            )  # fmt: skip
            if goal < 0:
                return None
            half, vertices = tree.half_edges(goal), tree.vertices(goal)
            numbers = self._edges.edge[half]
            open_ = np.flatnonzero(~self._edges.known[numbers])
            if not len(open_):
                return half
            evaluate(numbers[open_], vertices[open_], vertices[open_ + 1])
            self._refresh(numbers[open_])
        return None

    def _refresh(self, numbers: Integers) -> None:
        """Take note of edges that have been evaluated."""

    @property
    def nbytes(self) -> int:
        """Memory of the bounds."""
        return self.rest.nbytes


class ReweighedSearch(LazySearch):
    """The same by other weights than the roadmap's own.

    Args:
        edges: of the roadmap.
        weigh: weights of edges from their risks and durations; they may not fall as risks rise.
    """

    def __init__(self, edges: Edges, weigh: Weigh) -> None:
        super().__init__(edges)
        self._weigh = weigh
        self._weight = weigh(edges.risk(), edges.duration)

    def weight(self) -> FloatArray:
        """Weights of the edges, shape (m,)."""
        return self._weight

    def _refresh(self, numbers: Integers) -> None:
        risk, duration = self._edges.risk(numbers), self._edges.duration[numbers]
        self._weight[numbers] = self._weigh(risk, duration)


def duration_within(limit: float) -> Weigh:
    """Weighs edges by their duration, and leaves those out whose risk exceeds a limit."""

    def weigh(risk: FloatArray, duration: FloatArray) -> FloatArray:
        return np.where((risk <= limit) & np.isfinite(risk), duration, math.inf)

    return weigh
