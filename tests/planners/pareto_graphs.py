"""Small graphs and all of their paths."""

import math

import numpy as np
from hypothesis import strategies as st

from ompl_risk.planners.roadmap.graph import Graph


def simple_paths(graph, starts, goals):
    """All paths that visit no vertex twice, as lists of edges, found by going everywhere."""
    found = []

    def go(v, seen, edges):
        if v in goals:
            found.append(edges)
        for h in range(graph.first[v], graph.first[v + 1]):
            w, e = int(graph.target[h]), int(graph.edge[h])
            if w not in seen and math.isfinite(graph.risk[e]) and math.isfinite(graph.duration[e]):
                go(w, seen | {w}, [*edges, e])

    for s in starts:
        go(s, {s}, [])
    return found


def pairs(graph, starts, goals):
    """Duration and risk of all those paths."""
    risk_of = (lambda r: max(r, default=0.0)) if graph.maximum else math.fsum
    return [
        (math.fsum(graph.duration[p]), risk_of([float(r) for r in graph.risk[p]]))
        for p in simple_paths(graph, starts, goals)
    ]


def front(points):
    """Those that no other one undercuts, each once."""
    kept = []
    for t, r in sorted(points):
        if not kept or r < kept[-1][1]:
            kept.append((t, r))
    return kept


def found(ways):
    return list(zip(ways.durations.tolist(), ways.risks.tolist(), strict=True))


def check_ways(graph, ways, starts, goals):
    """Every way is a path from a start to a goal, and its numbers are those of its edges."""
    leaves = graph.source
    half_edges = {
        (int(leaves[h]), int(graph.target[h]), int(graph.edge[h])) for h in range(len(graph.target))
    }
    for way in ways:
        assert way.vertices[0] in starts
        assert way.vertices[-1] in goals
        assert len(set(way.vertices.tolist())) == len(way.vertices)
        tails, heads = way.vertices[:-1].tolist(), way.vertices[1:].tolist()
        steps = zip(tails, heads, way.edges.tolist(), strict=True)
        assert all(step in half_edges for step in steps)
        risk = graph.risk[way.edges]
        assert way.duration == graph.duration[way.edges].sum()
        assert way.risk == (risk.max(initial=0.0) if graph.maximum else risk.sum())


def graphs(weights, n=6, edges=12):
    """Small graphs, loops, parallel edges and forbidden edges among them."""

    @st.composite
    def draw(draw):
        vertices = draw(st.integers(2, n))
        vertex = st.integers(0, vertices - 1)
        rows = draw(
            st.lists(
                st.tuples(vertex, vertex, st.one_of(weights, st.just(math.inf)), weights),
                max_size=edges,
            )
        )
        columns = list(zip(*rows, strict=True)) or [(), (), (), ()]
        return Graph.of_edges(
            vertices,
            np.column_stack(columns[:2]).astype(int) if rows else np.empty((0, 2), int),
            columns[2],
            columns[3],
            maximum=draw(st.booleans()),
            undirected=draw(st.booleans()),
        )

    return draw()


WHOLE = st.integers(0, 4).map(float)
DECIMAL = st.integers(0, 40).map(lambda k: k / 10)


def random_graph(seed, n, m, *, whole=False, **kind):
    rng = np.random.default_rng(seed)
    ends = rng.integers(0, n, (m, 2))
    draw = (lambda: rng.integers(0, 6, m).astype(float)) if whole else (lambda: rng.random(m))
    risk, duration = draw(), draw()
    risk[rng.random(m) < 0.3] = 0.0
    risk[rng.random(m) < 0.05] = math.inf
    return Graph.of_edges(n, ends, risk, duration, **kind)
