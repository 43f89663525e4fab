"""Shortest paths in a graph whose half-edges stand vertex by vertex (compressed rows)."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.heap import empty_heap, pop, push
from ompl_risk._kernels.jit import entry


@entry
def shortest_paths(first, target, edge, weight, seeds, maximum, distance, parent, via):
    """Lower ``distance`` to what can be reached from the seeds (Dijkstra, 1959).

    With ``distance`` inf but for the sources, which are the seeds, this finds all shortest paths.
    With the distances of an earlier run, and as seeds the vertices whose distance has been lowered
    since (by new edges), it repairs them: distances may only fall.

    Args:
        first: half-edges of vertex v stand at first[v] to first[v + 1], shape (n + 1,).
        target: vertex at the other end of a half-edge, shape (h,).
        edge: its number, an index into ``weight``, shape (h,).
        weight: of the edges, 0 or more; edges of weight inf do not exist, shape (m,).
        seeds: vertices to start from, with ``distance`` set, shape (s,).
        maximum: whether a path is as long as its longest edge, rather than the sum of them.
        distance: in and out, shape (n,).
        parent: vertex before, -1 where there is none; in and out, shape (n,).
        via: half-edge from there; in and out, shape (n,).
    """
    heap = empty_heap(len(distance))
    for seed in seeds:
        push(heap, distance, seed)
    while heap.size[0] > 0:
        u = pop(heap, distance)
        here = distance[u]
        for h in range(first[u], first[u + 1]):
            w = weight[edge[h]]
            reached = max(here, w) if maximum else here + w
            v = target[h]
            if reached < distance[v] and w < math.inf:
                distance[v], parent[v], via[v] = reached, u, h
                push(heap, distance, v)


@entry
def guided_path(first, target, edge, weight, rest, roots, goals, maximum, distance, parent, via):
    """A shortest path from the roots to the goals by A* (Hart, Nilsson and Raphael, 1968).

    Args:
        first, target, edge, weight, maximum: see ``shortest_paths``.
        rest: lower bounds for the way from each vertex to the goals, consistent with the weights,
            inf where there is none, shape (n,).
        roots, goals: vertices, shapes (r,) and (k,).
        distance, parent, via: work space, then the tree as far as it was needed, shape (n,).

    Returns:
        The goal that was reached, -1 if there is no path.
    """
    distance[:] = math.inf
    parent[:] = -1
    key = np.empty(len(distance))
    heap = empty_heap(len(distance))
    for root in roots:
        if rest[root] < math.inf:
            distance[root], key[root] = 0.0, rest[root]
            push(heap, key, root)
    while heap.size[0] > 0:
        u = pop(heap, key)
        here = distance[u]
        if rest[u] == 0.0:
            for goal in goals:
                if goal == u:
                    return u
        for h in range(first[u], first[u + 1]):
            v = target[h]
            if rest[v] == math.inf:
                continue
            w = weight[edge[h]]
            reached = max(here, w) if maximum else here + w
            if reached < distance[v] and w < math.inf:
                distance[v], parent[v], via[v] = reached, u, h
                key[v] = max(reached, rest[v]) if maximum else reached + rest[v]
                push(heap, key, v)
    return -1


@entry
def neighbour_pairs(nearest, start, n):
    """Pairs of new vertices and their neighbours, each pair once.

    Args:
        nearest: neighbours of the vertices from ``start`` on, -1 for none; shape (n - start, k).
        start: first of the new vertices.
        n: number of vertices.

    Returns:
        tail and head, shape (m,).
    """
    k = nearest.shape[1]
    tail, head = np.empty(len(nearest) * k, np.int32), np.empty(len(nearest) * k, np.int32)
    m = 0
    for i in range(len(nearest)):
        v = start + i
        for c in range(k):
            u = nearest[i, c]
            if u < 0 or u >= n or u == v:
                continue
            if u > v:  # both are new: the pair is u's, if u has it as well
                mutual = False
                for other in range(k):
                    mutual = mutual or nearest[u - start, other] == v
                if mutual:
                    continue
            repeated = False
            for other in range(c):
                repeated = repeated or nearest[i, other] == u
            if not repeated:
                tail[m], head[m] = v, u
                m += 1
    return tail[:m].copy(), head[:m].copy()


@entry
def merged_rows(n, first, target, edge, tail, head, number, both):
    """Rows of n vertices with the old half-edges and new ones: first, target, edge.

    Args:
        first, target, edge: old rows, of n vertices or fewer.
        tail, head: of the new edges.
        number: of the first new edge; the others count up.
        both: whether new edges go both ways.
    """
    old = len(first) - 1
    rows = np.zeros(n + 1, np.int64)
    for v in range(old):
        rows[v + 1] = first[v + 1] - first[v]
    for e in range(len(tail)):
        rows[tail[e] + 1] += 1
        if both:
            rows[head[e] + 1] += 1
    for v in range(n):
        rows[v + 1] += rows[v]
    targets, edges = np.empty(rows[n], np.int32), np.empty(rows[n], np.int32)
    end = rows[:-1].copy()
    for v in range(old):
        for h in range(first[v], first[v + 1]):
            targets[end[v]], edges[end[v]] = target[h], edge[h]
            end[v] += 1
    for e in range(len(tail)):
        u, v = tail[e], head[e]
        targets[end[u]], edges[end[u]] = v, number + e
        end[u] += 1
        if both:
            targets[end[v]], edges[end[v]] = u, number + e
            end[v] += 1
    return rows, targets, edges
