"""Paths through a graph by way of a vertex."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.heap import empty_heap, pop, push
from ompl_risk._kernels.jit import entry, kernel


class Rows(NamedTuple):
    """The half-edges of a graph, see ``shortest_paths``."""

    first: NDArray[np.int64]
    target: NDArray[np.int32]
    edge: NDArray[np.int32]


class Mixture(NamedTuple):
    """Weights of edges, see ``Corridor.weights``, computed where they are needed.

    Attributes:
        duration: of the edges [s], inf for those left out, shape (m,).
        risk: of the edges, shape (m,).
        mix: weight of the risk, or for a maximum norm the greatest that an edge may have.
        maximum: whether it is a maximum norm.
    """

    duration: NDArray[np.float64]
    risk: NDArray[np.float64]
    mix: float
    maximum: bool


class Arms(NamedTuple):
    """Two trees: the way from the start to every vertex, and from there to the goal.

    Attributes:
        before: vertex before on the way from the start, -1 at the start, shape (n,).
        into: edge from there, -1 likewise, shape (n,).
        after: vertex after on the way to the goal, -1 at the goal, shape (n,).
        out_of: edge to there, -1 likewise, shape (n,).
    """

    before: NDArray[np.int32]
    into: NDArray[np.int32]
    after: NDArray[np.int32]
    out_of: NDArray[np.int32]


@entry
def shortest_through(rows, weight, to, fro, out):
    """``out[e]`` = least weight of a path through edge e, from the distances to start and goal."""
    out[:] = math.inf
    for u in range(len(to)):
        for h in range(rows.first[u], rows.first[u + 1]):
            e = rows.edge[h]
            out[e] = min(out[e], to[u] + weight[e] + fro[rows.target[h]])


@entry
def along_tree(parent, edge, value, maximum, total, steps):
    """Sum (or maximum) of a value of the edges, and their number, from the root to each vertex.

    Args:
        parent: vertex before, -1 at the roots and where the tree does not reach, shape (n,).
        edge: from there, shape (n,).
        value: of the edges, shape (m,).
        maximum: whether to take the maximum.
        total: out, shape (n,).
        steps: out, shape (n,).
    """
    waiting = np.empty(len(parent), np.int32)
    steps[:] = -1
    for v in range(len(parent)):
        u, size = v, 0
        while steps[u] < 0 and parent[u] >= 0:
            waiting[size] = u
            size += 1
            u = parent[u]
        if steps[u] < 0:
            total[u], steps[u] = 0.0, 0
        while size > 0:
            size -= 1
            w = waiting[size]
            x = value[edge[w]]
            total[w] = max(total[u], x) if maximum else total[u] + x
            steps[w] = steps[u] + 1
            u = w


@entry
def paths_via(arms, via, is_goal, first, vertices, edges, simple):
    """Write the path by way of each vertex: from the start to it, and on to the goal.

    Args:
        arms: the trees.
        via: the vertices, shape (p,).
        is_goal: of all vertices, shape (n,).
        first: path k takes first[k] to first[k + 1] of ``vertices``, and its edges the same
            places but the last, shape (p + 1,).
        vertices: out, of all paths.
        edges: out, as many.
        simple: out, whether no vertex is passed twice, and no goal before the end, shape (p,).
    """
    seen = np.full(len(arms.before), -1, np.int64)
    for k in range(len(via)):
        end = first[k + 1] - 1
        v, at = via[k], first[k]
        while arms.before[v] >= 0:
            v = arms.before[v]
            at += 1
        v, middle = via[k], at
        while at > first[k]:
            vertices[at] = v
            edges[at - 1] = arms.into[v]
            v = arms.before[v]
            at -= 1
        vertices[at] = v
        v, at = via[k], middle
        while at < end:
            edges[at] = arms.out_of[v]
            v = arms.after[v]
            at += 1
            vertices[at] = v
        edges[end] = -1
        simple[k] = True
        for at in range(first[k], end + 1):
            v = vertices[at]
            if seen[v] == k or (is_goal[v] and at < end):
                simple[k] = False
            seen[v] = k


@entry
def can_be_cut(rows, mixture, path, stretch, space):
    """Whether the graph has a path with the same ends that is better by more than a tolerance.

    Args:
        rows: the graph.
        mixture: weights of its edges.
        path: its vertices, and the edges after them (the last is not looked at), shape (2, k).
        stretch: the tolerance, relative: better means ``(1 + stretch) other < path``.
        space: as ``search_space`` makes it, and so again at the end.
    """
    start, goal = path[0, 0], path[0, -1]
    along = 0.0
    for i in range(path.shape[1] - 1):
        along += _weight(mixture, path[1, i])
    at_most = along / (1.0 + stretch)
    heap, distance, touched = space
    distance[start] = 0.0
    touched[0], size = start, 1
    push(heap, distance, start)
    while heap.size[0] > 0:
        u = pop(heap, distance)
        if u == goal:
            break
        for h in range(rows.first[u], rows.first[u + 1]):
            v, reached = rows.target[h], distance[u] + _weight(mixture, rows.edge[h])
            if reached < min(distance[v], at_most):
                if distance[v] == math.inf:
                    touched[size] = v
                    size += 1
                distance[v] = reached
                push(heap, distance, v)
    found = distance[goal] < at_most
    for i in range(size):
        distance[touched[i]] = math.inf
        heap.place[touched[i]] = -1
    heap.size[0] = 0
    return found


@kernel
def _weight(mixture, e):
    duration = mixture.duration[e]
    if duration == math.inf:
        return duration  # the risk may be inf too, and 0 inf is no number
    if mixture.maximum:
        return duration if mixture.risk[e] <= mixture.mix else math.inf
    return duration + mixture.mix * mixture.risk[e]


@entry
def search_space(n):
    """Work space of a search in part of a graph: a heap, distances, vertices reached."""
    return empty_heap(n), np.full(n, math.inf), np.empty(n, np.int32)
