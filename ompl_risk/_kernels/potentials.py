"""What is left to the goal at least, and the edges' costs beyond that, in whole numbers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.heap import empty_heap, pop, push
from ompl_risk._kernels.jit import entry

UNREACHED = 1 << 62
"""Cost to the goal from where there is no way; twice any cost that counts, and more."""


class Rows(NamedTuple):
    """Edges vertex by vertex, with what they add to the least total by way of them.

    A path that takes an edge from u to w with cost c costs at least ``c + h(w)`` from u on, and so
    ``c + h(w) - h(u)``, which is 0 or more, beyond what was least at u. For costs of which the
    greatest counts it is at least ``max(c, h(w))``.

    Attributes:
        first: the edges of vertex v stand at first[v] to first[v + 1], shape (n + 1,).
        other: vertex at the other end, shape (k,).
        edge: number of the edge, shape (k,).
        extra: of duration and risk, shape (k, 2).
    """

    first: NDArray[np.int64]
    other: NDArray[np.int32]
    edge: NDArray[np.int32]
    extra: NDArray[np.int64]


@entry
def least_to_goal(first, target, edge, weight, goals, limit, maximum):
    """Least cost from every vertex to a goal, `UNREACHED` if above the limit (Dijkstra, 1959).

    Args:
        first: rows of the edges turned round, shape (n + 1,).
        target: shape (h,).
        edge: shape (h,).
        weight: cost of the edges, 0 or more, shape (m,).
        goals: vertices, shape (g,).
        limit: greatest cost that counts; less than half of `UNREACHED`.
        maximum: whether a path costs as much as its costliest edge, rather than the sum.
    """
    least = np.full(len(first) - 1, UNREACHED, np.int64)
    heap = empty_heap(len(least))
    for goal in goals:
        least[goal] = 0
        push(heap, least, goal)
    while heap.size[0] > 0:
        u = pop(heap, least)
        here = least[u]
        for h in range(first[u], first[u + 1]):
            w = weight[edge[h]]
            if w > limit:
                continue
            reached = max(here, w) if maximum else here + w
            v = target[h]
            if reached <= limit and reached < least[v]:
                least[v] = reached
                push(heap, least, v)
    return least


@entry
def reduced_rows(first, target, edge, duration, risk, to_goal, limits, inward, maximum):
    """The edges that can be part of a path within the limits, as `Rows`.

    Args:
        first: rows of the edges that leave a vertex, or if inward of those that lead to it.
        target: vertex at the other end, shape (h,).
        edge: number of the edge, shape (h,).
        duration: of the edges, shape (m,).
        risk: of the edges, shape (m,).
        to_goal: least duration and risk from each vertex to a goal, shape (n, 2).
        limits: greatest duration and risk of a path.
        inward: which of the two rows these are.
        maximum: whether the greatest risk counts, rather than the sum.
    """
    n, k = len(first) - 1, 0
    starts = np.zeros(n + 1, np.int64)
    other, number = np.empty(len(target), np.int32), np.empty(len(target), np.int32)
    extra = np.empty((len(target), 2), np.int64)
    for v in range(n):
        for h in range(first[v], first[v + 1]):
            tail, head = (target[h], v) if inward else (v, target[h])
            d, r = duration[edge[h]], risk[edge[h]]
            if d > limits[0] or r > limits[1]:
                continue
            d += to_goal[head, 0]
            r = max(r, to_goal[head, 1]) if maximum else r + to_goal[head, 1]
            if d > limits[0] or r > limits[1]:
                continue
            other[k], number[k] = target[h], edge[h]
            extra[k, 0] = d - to_goal[tail, 0]
            extra[k, 1] = r if maximum else r - to_goal[tail, 1]
            k += 1
        starts[v + 1] = k
    return Rows(starts, other[:k].copy(), number[:k].copy(), extra[:k].copy())
