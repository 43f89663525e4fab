"""Paths by way of every vertex: the best from the start to it, then the best to the goal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import via as kernels
from ompl_risk.planners.roadmap.corridor import Corridor
from ompl_risk.planners.roadmap.graph import Graph, Tree, Way


@dataclass(frozen=True, eq=False)
class Pool:
    """Paths from start to goal, one after the other.

    Attributes:
        first: path k has the vertices first[k] to first[k + 1], shape (p + 1,).
        vertices: of all paths.
        edges: those that follow the vertices, -1 after a path's last.
        via: place of the vertex, along its path, where the trees meet, shape (p,).
        mix: number of the mix that the path was found by, shape (p,).
        duration: [s], shape (p,).
        risk: shape (p,).
    """

    first: NDArray[np.int64]
    vertices: NDArray[np.int32]
    edges: NDArray[np.int32]
    via: NDArray[np.int64]
    mix: NDArray[np.int64]
    duration: FloatArray
    risk: FloatArray

    def __len__(self) -> int:
        return len(self.via)

    def way(self, graph: Graph, k: int) -> Way:
        """Path k."""
        begin, end = self.first[k], self.first[k + 1]
        edges = self.edges[begin : end - 1].copy()
        risk = graph.risk[edges]
        total = risk.max(initial=0.0) if graph.maximum else risk.sum()
        duration = float(graph.duration[edges].sum())
        return Way(self.vertices[begin:end].copy(), edges, duration, float(total))


@dataclass(frozen=True, eq=False)
class _Arm:
    """One of the two trees.

    Attributes:
        tree: the tree.
        edge: from the parent, -1 at roots and beyond reach, shape (n,).
        duration: to the root [s], shape (n,).
        risk: on the way to the root, shape (n,).
        steps: number of edges to the root, shape (n,).
    """

    tree: Tree
    edge: NDArray[np.int32]
    duration: FloatArray
    risk: FloatArray
    steps: NDArray[np.int64]

    @classmethod
    def of(cls, graph: Graph, roots: int | NDArray[np.int32], weight: FloatArray) -> _Arm:
        tree = graph.tree(roots, weight)
        edge = np.where(tree.via >= 0, graph.edge[tree.via], np.int32(-1))
        duration, risk = np.empty(graph.n), np.empty(graph.n)
        steps = np.empty(graph.n, np.int64)
        sums = (graph.duration, False, duration), (graph.risk, graph.maximum, risk)
        for value, maximum, total in sums:
            kernels.along_tree(tree.parent, edge, value, maximum, total, steps)
        return cls(tree, edge, duration, risk, steps)


def via_paths(corridor: Corridor, mixes: FloatArray) -> Pool:
    """All paths within the limit that are best, by one of the mixes, to and from some vertex.

    Where the path to a vertex and the path from the one before it use the same edge, both vertices
    give the same path: such runs (plateaus) are taken once, at their first vertex. Paths that pass
    a vertex twice, or a goal before their end, are left out.

    Reference:
        Abraham, Delling, Goldberg & Werneck, Alternative routes in road networks,
        ACM Journal of Experimental Algorithmics 18, 2013.
    """
    parts = [_by_mix(corridor, number, mix) for number, mix in enumerate(mixes.tolist())]

    def joined(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(part, name) for part in parts])

    sizes = np.concatenate([np.diff(part.first) for part in parts])
    names = ("vertices", "edges", "via", "mix", "duration", "risk")
    return Pool(_starts(sizes), *map(joined, names))


def _by_mix(corridor: Corridor, number: int, mix: float) -> Pool:
    """The same for one mix."""
    graph, weight = corridor.graph, corridor.weights(mix)
    to = _Arm.of(graph, corridor.start, weight)
    fro = _Arm.of(graph.reverse, corridor.goals, weight)
    duration = to.duration + fro.duration
    via = np.flatnonzero(
        np.isfinite(to.tree.distance)
        & np.isfinite(fro.tree.distance)
        & (duration <= corridor.limit)
        & ~_continues_plateau(to, fro)
    )
    lengths = to.steps[via] + fro.steps[via] + 1
    first = _starts(lengths)
    vertices, edges = np.empty((2, first[-1]), np.int32)
    simple = np.empty(len(via), np.bool_)
    is_goal = np.zeros(graph.n, np.bool_)
    is_goal[corridor.goals] = True
    arms = kernels.Arms(to.tree.parent, to.edge, fro.tree.parent, fro.edge)
    kernels.paths_via(arms, via, is_goal, first, vertices, edges, simple)
    kept = np.repeat(simple, lengths)
    risk = np.maximum(to.risk, fro.risk) if graph.maximum else to.risk + fro.risk
    via = via[simple]
    return Pool(
        _starts(lengths[simple]),
        vertices[kept],
        edges[kept],
        to.steps[via],
        np.full(len(via), number),
        duration[via],
        risk[via],
    )


def _starts(lengths: NDArray[np.int64]) -> NDArray[np.int64]:
    """Where each begins if they stand one after the other, and where the last ends."""
    return np.append(0, np.cumsum(lengths))


def _continues_plateau(to: _Arm, fro: _Arm) -> NDArray[np.bool_]:
    """Whether the edge into a vertex, on its way from the start, is also the way on to the goal."""
    before = to.tree.parent
    return (before >= 0) & (fro.edge[before] == to.edge)
