import math
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk._kernels import curves, via
from ompl_risk._kernels.frechet import discrete_frechet
from ompl_risk.planners.roadmap.graph import Graph


def weight_of(graph, mix, e):
    if graph.maximum:
        return graph.duration[e] if graph.risk[e] <= mix else math.inf
    return graph.duration[e] + mix * graph.risk[e] if math.isfinite(graph.risk[e]) else math.inf


def least_weight(graph, mix, a, b):
    """Over all orders of all vertices between the two."""
    edges = {}
    for h in range(len(graph.target)):
        pair = int(graph.source[h]), int(graph.target[h])
        edges[pair] = min(edges.get(pair, math.inf), weight_of(graph, mix, graph.edge[h]))
    others = [v for v in range(graph.n) if v not in (a, b)]
    return min(
        math.fsum(edges.get(pair, math.inf) for pair in zip((a, *mid), (*mid, b), strict=True))
        for k in range(len(others) + 1)
        for mid in permutations(others, k)
    )


@given(
    st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), min_size=1, max_size=12),
    st.integers(0, 2**32 - 1),
    st.booleans(),
    st.booleans(),
)
@settings(deadline=None)
def test_cuts_by_brute_force_and_the_space_is_left_as_it_was(ends, seed, maximum, undirected):
    rng = np.random.default_rng(seed)
    m = len(ends)
    risk = np.where(rng.random(m) < 0.2, math.inf, rng.exponential(1.0, m))
    graph = Graph.of_edges(
        5, ends, risk, rng.uniform(1.0, 3.0, m), maximum=maximum, undirected=undirected
    )
    rows = via.Rows(graph.first, graph.target, graph.edge)
    space = via.search_space(5)
    mix = 1.5
    mixture = via.Mixture(graph.flyable_duration, graph.risk, mix, maximum)
    for e, (a, b) in enumerate(ends):
        along = weight_of(graph, mix, e)
        if a == b or not math.isfinite(along):
            continue
        path = np.array([[a, b], [e, -1]], dtype=np.int32)
        least = least_weight(graph, mix, a, b)
        for stretch in (0.0, 0.3, 1.0, math.inf):
            expected = (1.0 + stretch) * least < along * (1.0 - 1e-9)
            assert via.can_be_cut(rows, mixture, path, stretch, space) == expected
            heap, distance, _ = space
            assert heap.size[0] == 0
            assert (heap.place == -1).all()
            assert (distance == math.inf).all()


def resampled(points, path, samples):
    out = np.full((samples, points.shape[1]), np.nan)
    curves.resample(points, path, out)
    return out


@given(st.lists(st.integers(0, 9), min_size=1, max_size=9), st.integers(2, 40))
@settings(deadline=None)
def test_samples_stand_at_equal_arc_lengths(path, samples):
    points = np.random.default_rng(4).uniform(-1.0, 1.0, (10, 3))
    corners = points[path]
    arc = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1)))
    s = np.linspace(0.0, arc[-1], samples)
    expected = np.column_stack([np.interp(s, arc, x) for x in corners.T])
    found = resampled(points, np.array(path, dtype=np.int32), samples)
    assert found == pytest.approx(expected, abs=1e-12)


def outside(a, b, gates, reach):
    at, low, high = np.empty((3, len(gates.levels), a.shape[1]))
    curves.pass_gates(a, gates, at)
    curves.cover_gates(b, gates, reach, low, high)
    return curves.is_outside(at, low, high)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0))
@settings(deadline=None)
def test_gates_part_only_what_is_far_apart(seed, spread):
    """Random walks from one point, some of which turn back or never reach the last gates."""
    rng = np.random.default_rng(seed)
    a, b = np.cumsum(rng.normal([0.1, 0.0], [0.2, 0.02 + spread], (2, 40, 2)), axis=1)
    a, b = a - a[0], b - b[0]
    step = max(float(np.linalg.norm(np.diff(x, axis=0), axis=1).max()) for x in (a, b))
    distance = float(discrete_frechet(a, b))
    gates = curves.Gates(np.array([1.0, 0.0]), np.linspace(0.2, 4.0, 9), distance + step)
    assert not outside(a, b, gates, distance * (1.0 + 1e-12))


def test_gates_do_part():
    x = np.linspace(0.0, 10.0, 101)
    a, b = np.column_stack([x, 0.0 * x]), np.column_stack([x, np.sin(x * np.pi / 10.0)])
    gates = curves.Gates(np.array([1.0, 0.0]), np.linspace(1.0, 9.0, 9), 0.6)
    assert outside(a, b, gates, 0.5)
    assert not outside(a, b, gates, 1.0)
