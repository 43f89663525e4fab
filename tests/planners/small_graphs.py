"""Graphs small enough to list all of their paths."""

import math
from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from ompl_risk.planners.roadmap.graph import Graph


def ring(n):
    """Places of n vertices on a circle, where paths through other vertices are other curves."""
    angle = np.linspace(0.0, 2.0 * math.pi, n, endpoint=False)
    return 100.0 * np.column_stack([np.cos(angle), np.sin(angle)])


@st.composite
def graphs(draw, maximum=None, tied=False):
    n = draw(st.integers(2, 7))
    pairs = [(i, j) for i in range(n) for j in range(n) if i != j]
    ends = draw(st.lists(st.sampled_from(pairs), min_size=1, max_size=16))
    m = len(ends)
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    duration = rng.integers(0, 4, m).astype(float) if tied else rng.uniform(1.0, 3.0, m)
    risk = np.where(rng.random(m) < 0.1, math.inf, rng.exponential(1.0, m))
    risk[rng.random(m) < 0.2] = 0.0
    both = draw(st.booleans())
    top = draw(st.booleans()) if maximum is None else maximum
    return Graph.of_edges(n, ends, risk, duration, maximum=top, undirected=both)


def simple_paths(graph, start, goals):
    """All paths that pass no vertex twice and no goal before the end: (vertices, edges)."""
    found, waiting = [], [((start,), ())]
    while waiting:
        vertices, edges = waiting.pop()
        if vertices[-1] in goals:
            found.append((vertices, edges))
            continue
        for h in range(graph.first[vertices[-1]], graph.first[vertices[-1] + 1]):
            v, e = int(graph.target[h]), int(graph.edge[h])
            if v not in vertices and math.isfinite(graph.risk[e]):
                waiting.append(((*vertices, v), (*edges, e)))
    return found


def total_duration(graph, edges):
    return math.fsum(graph.duration[list(edges)])


def total_risk(graph, edges):
    risk = graph.risk[list(edges)]
    return risk.max(initial=0.0) if graph.maximum else math.fsum(risk)


def within(graph, edges, limit):
    return total_duration(graph, edges) <= limit


def dense(points, step):
    """The same polyline with points at most a step apart, corners included."""
    parts = [points[:1]]
    for a, b in pairwise(points):
        pieces = max(math.ceil(np.linalg.norm(b - a) / step), 1)
        parts.append(a + (b - a) * (np.arange(1, pieces + 1) / pieces)[:, None])
    return np.concatenate(parts)


def vertices_of(found):
    return [tuple(a.way.vertices.tolist()) for a in found]


def chain(maximum=False):
    """Eight diamonds in a row: below quick and dangerous, above 2 % slower and safe."""
    ends, points, risk, duration = [], [(0.0, 0.0)], [], []
    for k in range(8):
        a, up, down, b = 3 * k, 3 * k + 1, 3 * k + 2, 3 * k + 3
        ends += [(a, up), (up, b), (a, down), (down, b)]
        points += [(100.0 * k + 50, 20.0), (100.0 * k + 50, -20.0), (100.0 * k + 100, 0.0)]
        risk += [0.01, 0.01, 1.0, 1.0]
        duration += [1.02, 1.02, 1.0, 1.0]
    return Graph.of_edges(25, ends, risk, duration, maximum=maximum), points
