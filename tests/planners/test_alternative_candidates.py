import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from small_graphs import (
    chain,
    graphs,
    simple_paths,
    total_duration,
    total_risk,
    vertices_of,
    within,
)

from ompl_risk.planners.roadmap.alternatives import alternatives
from ompl_risk.planners.roadmap.corridor import Corridor
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.mixes import ladder
from ompl_risk.planners.roadmap.via import via_paths


@given(graphs(maximum=False), st.data(), st.floats(0.0, 1.0), st.floats(0.0, 3.0))
@settings(max_examples=100, deadline=None)
def test_candidates_are_all_paths_by_way_of_a_vertex(graph, data, excess, mix):
    """Once each, although every vertex of a plateau gives the same path."""
    assume(len(np.unique(np.sort([graph.source, graph.target], axis=0), axis=1).T) == graph.m)
    start = data.draw(st.integers(0, graph.n - 1))
    goal = data.draw(st.integers(0, graph.n - 1).filter(lambda v: v != start))
    corridor = Corridor.between(graph, start, np.array([goal], np.int32), excess)
    every = simple_paths(graph, start, [goal])
    assert (corridor is None) == (not every)
    if corridor is None:
        return
    inside = {e for _, edges in every for e in edges if within(graph, edges, corridor.limit)}
    assert inside <= set(np.flatnonzero(np.isfinite(corridor.duration)).tolist())
    weight = corridor.weights(mix)
    expected = set()
    for v in range(graph.n):
        ways = [best_in(graph, a, b, weight) for a, b in ((start, v), (v, goal))]
        if all(way is not None for way in ways):
            vertices = ways[0][0] + ways[1][0][1:]
            once = len(set(vertices)) == len(vertices)
            if once and within(graph, ways[0][1] + ways[1][1], corridor.limit):
                expected.add(vertices)
    pool = via_paths(corridor, np.array([mix]))
    found = [tuple(pool.way(graph, k).vertices.tolist()) for k in range(len(pool))]
    assert sorted(found) == sorted(expected)


def best_in(graph, a, b, weight):
    """The best path, among edges of finite weight."""
    if a == b:
        return (a,), ()
    paths = [p for p in simple_paths(graph, a, [b]) if np.isfinite(weight[list(p[1])]).all()]
    return min(paths, key=lambda p: math.fsum(weight[list(p[1])]), default=None)


@given(graphs(maximum=False), st.floats(0.0, 1.0))
@settings(max_examples=100, deadline=None)
def test_mixes_reach_the_lower_hull_at_the_limit(graph, excess):
    """The multiplier found by secants is the slope of the hull where it crosses the limit."""
    corridor = Corridor.between(graph, 0, np.array([graph.n - 1], np.int32), excess)
    assume(corridor is not None)
    inside = set(np.flatnonzero(np.isfinite(corridor.duration)).tolist())
    paths = [e for _, e in simple_paths(graph, 0, [graph.n - 1]) if set(e) <= inside]
    pairs = [(total_duration(graph, e), total_risk(graph, e)) for e in paths]
    fast, safe = min(pairs), min(pairs, key=lambda p: (p[1], p[0]))
    rungs = ladder(corridor)
    if safe[1] == fast[1]:
        assert rungs.tolist() == [0.0]
        return
    multiplier = rungs[-2]
    assert rungs[0] == 0.0
    before = min(pairs, key=lambda p: p[0] + multiplier * (1 - 1e-6) * p[1])
    after = min(pairs, key=lambda p: p[0] + multiplier * (1 + 1e-6) * p[1])
    assert before[0] <= corridor.limit
    assert after[0] > corridor.limit or after[1] == safe[1]
    assert after[1] < before[1]


@given(graphs(maximum=True), st.floats(0.0, 1.0))
@settings(max_examples=100, deadline=None)
def test_thresholds_reach_the_least_maximum_within_the_limit(graph, excess):
    corridor = Corridor.between(graph, 0, np.array([graph.n - 1], np.int32), excess)
    assume(corridor is not None)
    every = [e for _, e in simple_paths(graph, 0, [graph.n - 1])]
    least = min(total_risk(graph, e) for e in every if within(graph, e, corridor.limit))
    rungs = ladder(corridor)
    assert rungs[0] == math.inf
    assert rungs[-1] == least
    assert (np.diff(rungs[1:]) < 0).all()
    assert via_paths(corridor, rungs).risk.min() == least


def test_the_multiplier_is_that_of_the_least_risk_within_the_limit():
    """Choices of 0.01 s for 2^k less risk, and time for three: the fourth sets the price."""
    ends = [pair for k in range(8) for pair in ((k, k + 1), (k, k + 1))]
    risk = [x for k in range(8) for x in (2.0**k, 0.0)]
    graph = Graph.of_edges(9, ends, risk, [1.0, 1.01] * 8)
    corridor = Corridor.between(graph, 0, np.array([8], np.int32), 0.035 / 8.0)
    assert ladder(corridor)[-2] == pytest.approx(0.01 / 2.0**4, rel=1e-9)


@pytest.mark.parametrize("maximum", [False, True])
def test_mixes_find_what_duration_alone_does_not(maximum):
    graph, points = chain(maximum)
    asked = {"count": 50, "excess": 0.05, "min_distance": 10.0}
    found = alternatives(graph, points, 0, 24, **asked)
    alone = alternatives(graph, points, 0, 24, **asked, mixes=[])
    least = 0.01 if maximum else 0.16
    assert min(a.way.risk for a in found) == pytest.approx(least)
    assert min(a.way.risk for a in alone) >= (1.0 if maximum else 14.0)
    given_mix = [0.01] if maximum else [1.0]
    again = alternatives(graph, points, 0, 24, **asked, mixes=given_mix)
    assert min(a.way.risk for a in again) == pytest.approx(least)
    assert found[0].way.duration == again[0].way.duration == 16.0


def test_a_spike_is_no_alternative():
    """Three vertices in a row, and one aside from where the way back is another edge."""
    points = [(0, 0), (480, 0), (500, 300), (520, 0), (1000, 0)]
    ends = [(0, 1), (1, 3), (3, 4), (1, 2), (2, 3)]
    lengths = [np.linalg.norm(np.subtract(points[a], points[b])) for a, b in ends]
    graph = Graph.of_edges(5, ends, np.ones(5), lengths)
    asked = {"count": 9, "excess": 1.0, "min_distance": 100.0}
    assert vertices_of(alternatives(graph, points, 0, 4, **asked)) == [(0, 1, 3, 4)]
    allowed = alternatives(graph, points, 0, 4, **asked, stretch=math.inf)
    assert vertices_of(allowed) == [(0, 1, 3, 4), (0, 1, 2, 3, 4)]
    assert len(alternatives(graph, points, 0, 4, **asked, stretch=100.0)) == 2


def test_what_is_a_detour_for_the_duration_need_not_be_one_for_the_risk():
    """The spike goes round a dangerous edge: found by heeding the risk, and so not cut off."""
    points = [(0, 0), (480, 200), (500, 500), (520, 200), (1000, 0), (500, 0)]
    ends = [(0, 5), (5, 4), (0, 1), (1, 2), (2, 3), (3, 4), (1, 3)]
    lengths = [np.linalg.norm(np.subtract(points[a], points[b])) for a, b in ends]
    graph = Graph.of_edges(6, ends, [0, 0, 0, 0, 0, 0, 1000.0], lengths)
    asked = {"count": 9, "excess": 1.0, "min_distance": 200.0}
    assert (0, 1, 2, 3, 4) in vertices_of(alternatives(graph, points, 0, 4, **asked, mixes=[1.0]))
    assert (0, 1, 2, 3, 4) not in vertices_of(alternatives(graph, points, 0, 4, **asked, mixes=[]))
