"""The Pareto set of a graph against all of its simple paths, and against slower searches."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pareto_graphs import (
    WHOLE,
    check_ways,
    found,
    front,
    graphs,
    pairs,
    random_graph,
)

from ompl_risk.errors import ArgumentError
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.pareto import pareto_set


@settings(max_examples=300, deadline=None)
@given(graphs(WHOLE))
def test_whole_weights_give_exactly_the_front_of_all_simple_paths(graph):
    ways = pareto_set(graph, 0, graph.n - 1)
    assert found(ways) == front(pairs(graph, [0], {graph.n - 1}))
    check_ways(graph, ways, {0}, {graph.n - 1})


@settings(max_examples=100, deadline=None)
@given(graphs(WHOLE), st.data())
def test_several_starts_and_goals_that_may_be_the_same(graph, data):
    some = st.sets(st.integers(0, graph.n - 1), min_size=1, max_size=3)
    starts, goals = data.draw(some), data.draw(some)
    ways = pareto_set(graph, list(starts), list(goals))
    assert found(ways) == front(pairs(graph, starts, goals))
    check_ways(graph, ways, starts, goals)


@pytest.mark.parametrize("maximum", [False, True])
@pytest.mark.parametrize("undirected", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_real_weights_give_the_front_of_all_simple_paths(seed, undirected, maximum):
    graph = random_graph(seed, 8, 30, undirected=undirected, maximum=maximum)
    ways = pareto_set(graph, 0, 7)
    want = front(pairs(graph, [0], {7}))
    assert len(ways) == len(want) > 0
    np.testing.assert_allclose(found(ways), want, rtol=1e-14)


def front_by_correction(graph, start, goal):
    """The front at the goal: fronts of all vertices, joined along edges until nothing changes."""
    fronts = [[] for _ in range(graph.n)]
    fronts[start] = [(0.0, 0.0)]
    changed = True
    while changed:
        changed = False
        for h, u in enumerate(graph.source):
            t, r, v = graph.duration[graph.edge[h]], graph.risk[graph.edge[h]], graph.target[h]
            if not math.isfinite(r):
                continue
            more = [(a + t, max(b, r) if graph.maximum else b + r) for a, b in fronts[u]]
            joined = front(fronts[v] + more)
            if joined != fronts[v]:
                fronts[v], changed = joined, True
    return fronts[goal]


@pytest.mark.parametrize("maximum", [False, True])
@pytest.mark.parametrize("undirected", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_middling_graphs_agree_with_label_correction(seed, undirected, maximum):
    kind = {"whole": True, "undirected": undirected, "maximum": maximum}
    graph = random_graph(seed, 80, 320, **kind)
    ways = pareto_set(graph, 0, 79)
    assert found(ways) == front_by_correction(graph, 0, 79)
    assert len(ways) > 1
    check_ways(graph, ways, {0}, {79})


def front_by_threshold(graph, start, goal):
    """Fastest path, then the fastest by edges of less risk than its greatest, and so on."""
    points, weight = [], graph.flyable_duration
    while True:
        tree = graph.tree(start, weight)
        if not math.isfinite(tree.distance[goal]):
            return front(points)
        edges = graph.edge[tree.half_edges(goal)]
        points.append((graph.duration[edges].sum(), graph.risk[edges].max(initial=0.0)))
        weight = np.where(graph.risk < points[-1][1], weight, math.inf)


@pytest.mark.parametrize("seed", range(5))
def test_maximum_norm_agrees_with_the_sweep_over_thresholds(seed):
    graph = random_graph(seed, 300, 1500, maximum=True)
    ways = pareto_set(graph, 0, 299)
    assert len(ways) > 2
    np.testing.assert_allclose(found(ways), front_by_threshold(graph, 0, 299), rtol=1e-14)


def test_swapping_duration_and_risk_mirrors_the_set():
    graph = random_graph(1, 200, 1000)
    finite = np.isfinite(graph.risk)
    ends = np.column_stack([graph.source, graph.target])[
        np.unique(graph.edge, return_index=True)[1]
    ]
    there = Graph.of_edges(200, ends[finite], graph.risk[finite], graph.duration[finite])
    back = Graph.of_edges(200, ends[finite], graph.duration[finite], graph.risk[finite])
    ways, mirrored = pareto_set(there, 0, 199), pareto_set(back, 199, 0)
    assert len(ways) > 5
    np.testing.assert_allclose(ways.risks[::-1], mirrored.durations, rtol=1e-14)
    np.testing.assert_allclose(ways.durations[::-1], mirrored.risks, rtol=1e-14)


@pytest.mark.parametrize("factor", [2.0**-900, 2.0**-30, 2.0**900])
def test_units_do_not_matter(factor):
    graph = random_graph(2, 100, 500)
    scaled = Graph(
        graph.first, graph.target, graph.edge, graph.risk * factor, graph.duration / factor
    )
    for way, same in itertools.zip_longest(pareto_set(graph, 0, 99), pareto_set(scaled, 0, 99)):
        assert way.edges.tolist() == same.edges.tolist()


def test_ways_whose_durations_round_to_the_same_are_one():
    ends, risk = [(0, 1), (0, 1), (1, 2)], [2.0, 1.0, 0.0]
    graph = Graph.of_edges(3, ends, risk, [0.0, 2.0**-54, 1.0])
    assert found(pareto_set(graph, 0, 2)) == [(1.0, 1.0)]


def test_a_small_risk_beside_a_great_one_stays_above_nothing():
    graph = Graph.of_edges(2, [(0, 1)] * 3, [1e9, 1e-30, 0.0], [1.0, 2.0, 3.0])
    assert pareto_set(graph, 0, 1).risks.tolist() == [1e9, 1e-30, 0.0]


@pytest.mark.parametrize("maximum", [False, True])
def test_start_at_the_goal_is_a_way_without_edges(maximum):
    (way,) = pareto_set(random_graph(0, 8, 20, maximum=maximum), 3, [5, 3])
    assert (way.vertices.tolist(), way.edges.tolist()) == ([3], [])
    assert (way.duration, way.risk) == (0.0, 0.0)


@pytest.mark.parametrize("maximum", [False, True])
def test_without_a_path_the_set_is_empty(maximum):
    apart = Graph.of_edges(3, [(0, 1), (1, 2)], [1.0, math.inf], [1.0, 1.0], maximum=maximum)
    ways = pareto_set(apart, 0, 2)
    assert not ways
    assert found(ways) == []
    never = Graph.of_edges(2, [(0, 1)], [1.0], [math.inf], maximum=maximum)
    assert not pareto_set(never, 0, 1)


@pytest.mark.parametrize(
    ("argument", "given_"),
    [
        ("start", {"start": 2}),
        ("start", {"start": []}),
        ("start", {"start": 0.5}),
        ("goals", {"goals": [1, -1]}),
        ("longest", {"longest": -1.0}),
        ("longest", {"longest": math.nan}),
        ("riskiest", {"riskiest": "much"}),
        ("precision", {"precision": -0.1}),
        ("precision", {"precision": math.inf}),
        ("most_labels", {"most_labels": 0}),
        ("most_labels", {"most_labels": 2**31}),
        ("most_labels", {"most_labels": 1.5}),
    ],
)
def test_bad_arguments_are_named(argument, given_):
    graph = Graph.of_edges(2, [(0, 1)], [1.0], [1.0])
    with pytest.raises(ArgumentError, match=f"^{argument} = "):
        pareto_set(graph, **{"start": 0, "goals": 1, **given_})
