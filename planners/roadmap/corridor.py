"""The part of a graph where paths within a limit of duration can be."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import via as kernels
from ompl_risk.planners.roadmap.graph import Graph, Way

ROUNDING = 1e-12
"""Relative: durations that are equal but summed in another order count as equal."""


@dataclass(frozen=True, eq=False)
class Corridor:
    """The edges of a graph that lie on a path, from start to a goal, within a limit of duration.

    Attributes:
        graph: the graph.
        start: its vertex.
        goals: vertices, any of which will do, shape (g,).
        least: duration of the fastest path [s].
        limit: duration that a path may have [s].
        duration: of the edges [s], inf for those outside, shape (m,).
    """

    graph: Graph
    start: int
    goals: NDArray[np.int32]
    least: float
    limit: float
    duration: FloatArray

    @classmethod
    def between(
        cls, graph: Graph, start: int, goals: NDArray[np.int32], excess: float
    ) -> Corridor | None:
        """The corridor for a relative excess over the least duration; None without a path."""
        duration = graph.flyable_duration
        to = graph.tree(start, duration)
        least = float(to.distance[goals].min())
        if not math.isfinite(least):
            return None
        limit = (1.0 + excess) * least * (1.0 + ROUNDING)
        fro = graph.reverse.tree(goals, duration)
        through = np.empty(graph.m)
        rows = kernels.Rows(graph.first, graph.target, graph.edge)
        kernels.shortest_through(rows, duration, to.distance, fro.distance, through)
        inside = np.where(through <= limit, duration, math.inf)
        return cls(graph, start, goals, least, limit, inside)

    @property
    def rows(self) -> kernels.Rows:
        """The half-edges, as kernels take them."""
        return kernels.Rows(self.graph.first, self.graph.target, self.graph.edge)

    def weights(self, mix: float) -> FloatArray:
        """What trees are grown by.

        Args:
            mix: weight of the risk [s per unit of risk]; for a maximum norm the greatest risk that
                an edge may have.

        Returns:
            Weights of the edges, inf for those left out, shape (m,).
        """
        if self.graph.maximum:
            return np.where(self.graph.risk <= mix, self.duration, math.inf)
        inside = np.isfinite(self.duration)
        weights = np.full(self.graph.m, math.inf)
        weights[inside] = self.duration[inside] + mix * self.graph.risk[inside]
        return weights

    def best(self, mix: float) -> Way | None:
        """The path of least weight, which may be slower than the limit; None if there is none."""
        tree = self.graph.tree(self.start, self.weights(mix))
        end = int(self.goals[np.argmin(tree.distance[self.goals])])
        if not math.isfinite(tree.distance[end]):
            return None
        return self.graph.way(self.start, tree.half_edges(end))
