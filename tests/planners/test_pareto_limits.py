"""Pareto sets within limits of duration and risk, to a precision, of so many labels."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pareto_graphs import DECIMAL, WHOLE, found, front, graphs, pairs, random_graph

from ompl_risk.errors import LabelLimitError
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.pareto import pareto_set


@settings(max_examples=100, deadline=None)
@given(graphs(WHOLE), WHOLE, st.integers(0, 12))
def test_limits_leave_what_lies_within(graph, riskiest, longest):
    goal = graph.n - 1
    ways = pareto_set(graph, 0, goal, longest=longest, riskiest=riskiest)
    within = [(t, r) for t, r in pairs(graph, [0], {goal}) if t <= longest and r <= riskiest]
    assert found(ways) == front(within)


@settings(max_examples=100, deadline=None)
@given(graphs(DECIMAL, n=7, edges=16))
def test_a_limit_taken_from_a_way_keeps_that_way(graph):
    ways = pareto_set(graph, 0, graph.n - 1)
    for k, way in enumerate(ways):
        faster = pareto_set(graph, 0, graph.n - 1, longest=way.duration)
        assert found(faster) == found(ways)[: k + 1]
        safer = pareto_set(graph, 0, graph.n - 1, riskiest=way.risk)
        assert found(safer) == found(ways)[k:]


@settings(max_examples=200, deadline=None)
@given(graphs(DECIMAL), st.sampled_from([1e-3, 0.1, 0.5, 3.0]), DECIMAL)
def test_every_path_has_a_way_no_slower_within_the_precision(graph, precision, riskiest):
    goal = graph.n - 1
    ways = pareto_set(graph, 0, goal, precision=precision, riskiest=riskiest)
    rounding = 1 + 1e-12
    for t, r in pairs(graph, [0], {goal}):
        if r * rounding <= riskiest:
            assert any(
                w.duration <= t * rounding and w.risk <= (1 + precision) * r * rounding
                for w in ways
            )
    assert found(ways) == front(found(ways))
    if not graph.maximum:
        assert set(found(ways)) <= set(found(pareto_set(graph, 0, goal, riskiest=riskiest)))


def test_rounding_beyond_the_limit_loses_no_way():
    """In double precision 0.2 + 2.7 > 2.9."""
    graph = Graph(
        first=np.array([0, 2, 3, 3]),
        target=np.array([1, 2, 2], dtype=np.int32),
        edge=np.arange(3, dtype=np.int32),
        risk=np.array([0.2, 2.0, 2.7]),
        duration=np.array([0.0, 0.1, 0.0]),
        undirected=False,
    )
    for precision in (0.0, 0.5):
        (way,) = pareto_set(graph, 0, 2, riskiest=2.9, precision=precision)
        assert way.edges.tolist() == [1]
        turned = replace(graph, risk=graph.duration, duration=graph.risk)
        (way,) = pareto_set(turned, 0, 2, longest=2.9, precision=precision)
        assert way.edges.tolist() == [1]
    assert not len(pareto_set(graph, 0, 2, riskiest=1.9))


def test_a_way_that_rounds_beyond_the_limit_takes_no_way_within_along():
    """In double precision 3.6 + 0.2 > 3.8, but 1.6 + 0.4 + 1.8 = 3.8."""
    ends = [(0, 2), (2, 1), (0, 3), (3, 4), (4, 1)]
    duration, risk = [3.6, 0.2, 1.6, 0.4, 1.8], [5.0, 0.0, 2.0, 0.0, 0.0]
    graph = Graph.of_edges(5, ends, risk, duration, undirected=False)
    (way,) = pareto_set(graph, 0, 1, longest=3.8)
    assert way.edges.tolist() == [2, 3, 4]


@pytest.mark.parametrize("seed", [0, 2, 5, 6])
def test_limits_that_are_sums_of_a_way_are_met_to_the_last_digit(seed):
    graph = random_graph(seed, 300, 1200)
    ways = found(pareto_set(graph, 0, 299))
    assert len(ways) > 5
    for k, (t, r) in enumerate(ways):
        assert found(pareto_set(graph, 0, 299, longest=t)) == ways[: k + 1]
        assert found(pareto_set(graph, 0, 299, longest=np.nextafter(t, 0.0))) == ways[:k]
        assert found(pareto_set(graph, 0, 299, riskiest=r)) == ways[k:]
        if r > 0.0:
            assert found(pareto_set(graph, 0, 299, riskiest=np.nextafter(r, 0.0))) == ways[k + 1 :]


def ladder(k):
    """k stages with the choice of 2^i s or risk 2^i: all 2^k paths are non-dominated."""
    ends = [(i, i + 1) for i in range(k) for _ in range(2)]
    steps = 2.0 ** np.arange(k)
    nothing = np.zeros(k)
    risk = np.column_stack([steps, nothing]).ravel()
    return Graph.of_edges(k + 1, ends, risk, np.column_stack([nothing, steps]).ravel())


def test_a_front_of_exponential_size_is_found_and_thinned_by_precision():
    exact = pareto_set(ladder(12), 0, 12)
    assert exact.durations.tolist() == list(range(4096))
    assert exact.risks.tolist() == list(range(4095, -1, -1))
    rough = pareto_set(ladder(12), 0, 12, precision=0.1)
    assert set(found(rough)) < set(found(exact))
    risks = rough.risks[:-1]  # the last is 0
    assert (risks[:-1] > 1.1 * risks[1:]).all()
    assert len(rough) <= 2 + math.log(4095) / math.log(1.1)


def fan(n, maximum):
    """n edges side by side, each slower and safer than the one before."""
    risk = np.arange(n, 0.0, -1.0)
    return Graph.of_edges(2, [(0, 1)] * n, risk, n - risk, maximum=maximum)


@pytest.mark.parametrize("maximum", [False, True])
@pytest.mark.parametrize("precision", [0.01, 0.1, 0.7])
def test_precision_is_used_and_not_overdrawn(precision, maximum):
    ways = pareto_set(fan(1000, maximum), 0, 1, precision=precision)
    assert len(ways) <= 2 + math.log(1000) / math.log1p(precision)
    for risk in np.arange(1.0, 1001.0):
        assert ways.least_risk(1000 - risk).risk <= (1 + precision) * risk * (1 + 1e-12)


def test_the_limit_of_labels_says_how_far_they_reach():
    with pytest.raises(LabelLimitError, match="most_labels") as caught:
        pareto_set(ladder(12), 0, 12, most_labels=3000)
    error = caught.value
    assert (error.labels, error.fastest) == (3000, 0.0)
    assert 0.0 < error.reached < 4095.0
    assert pareto_set(ladder(12), 0, 12, longest=error.reached / 2, most_labels=3000).ways
    assert pickle.loads(pickle.dumps(error)).reached == error.reached


def test_as_many_labels_as_needed_are_enough():
    graph = Graph.of_edges(3, [(0, 1), (1, 2)], [1.0, 1.0], [1.0, 1.0])
    assert len(pareto_set(graph, 0, 2, most_labels=3)) == 1
    with pytest.raises(LabelLimitError):
        pareto_set(graph, 0, 2, most_labels=2)


def test_of_equal_durations_only_the_least_risk_costs_a_label():
    parallel = Graph.of_edges(2, [(0, 1)] * 2, [2.0, 1.0], [1.0, 1.0])
    assert found(pareto_set(parallel, 0, 1, most_labels=2)) == [(1.0, 1.0)]
    ends, risk = [(0, 2), (0, 1), (1, 2)], [5.0, 3.0, 0.0]
    by_way_of_1 = Graph.of_edges(3, ends, risk, [1.0, 1.0, 0.0], undirected=False)
    assert found(pareto_set(by_way_of_1, 0, 2, most_labels=3)) == [(1.0, 3.0)]
