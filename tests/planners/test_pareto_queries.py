"""What a Pareto set is asked: the least risk within a duration, the fastest within a risk."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pareto_graphs import WHOLE, graphs, pairs

from ompl_risk.errors import ArgumentError, NoWayError
from ompl_risk.planners.roadmap.front import ParetoSet
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.pareto import pareto_set


def three_ways(**limits):
    graph = Graph.of_edges(2, [(0, 1)] * 3, [5.0, 3.0, 1.0], [10.0, 12.0, 20.0])
    return pareto_set(graph, 0, 1, **limits)


@pytest.mark.parametrize(
    ("within", "risk"), [(10.0, 5.0), (11.9, 5.0), (12.0, 3.0), (19.0, 3.0), (math.inf, 1.0)]
)
def test_least_risk_within_a_duration(within, risk):
    assert three_ways().least_risk(within).risk == risk


@pytest.mark.parametrize(
    ("within_risk", "duration"), [(1.0, 20.0), (2.9, 20.0), (3.0, 12.0), (5, 10.0), (9.0, 10.0)]
)
def test_fastest_within_a_risk(within_risk, duration):
    assert three_ways().fastest(within_risk).duration == duration


@settings(max_examples=50, deadline=None)
@given(graphs(WHOLE), st.integers(0, 12), WHOLE)
def test_queries_answer_for_all_simple_paths(graph, within, within_risk):
    ways, points = pareto_set(graph, 0, graph.n - 1), pairs(graph, [0], {graph.n - 1})
    risks = [r for t, r in points if t <= within]
    if risks:
        assert ways.least_risk(within).risk == min(risks)
    else:
        with pytest.raises(NoWayError):
            ways.least_risk(within)
    durations = [t for t, r in points if r <= within_risk]
    if durations:
        assert ways.fastest(within_risk).duration == min(durations)
    else:
        with pytest.raises(NoWayError):
            ways.fastest(within_risk)


def test_queries_that_nothing_fits_name_the_nearest():
    with pytest.raises(NoWayError, match="at most 9 s: the fastest takes 10 s"):
        three_ways().least_risk(9.0)
    with pytest.raises(NoWayError, match=r"at most 0\.5: the safest has 1"):
        three_ways().fastest(0.5)
    with pytest.raises(NoWayError, match="no path leads to a goal"):
        ParetoSet(()).least_risk(1.0)
    with pytest.raises(NoWayError, match="no path leads to a goal"):
        ParetoSet(()).fastest(1.0)


def test_queries_beyond_what_was_searched_are_refused():
    with pytest.raises(ArgumentError, match="longest = 15"):
        three_ways(longest=15.0).least_risk(16.0)
    with pytest.raises(ArgumentError, match="riskiest = 4"):
        three_ways(riskiest=4.0).fastest(5.0)
    with pytest.raises(ArgumentError, match="within"):
        three_ways().least_risk(math.nan)


def test_the_set_is_a_sequence_of_ways_with_read_only_columns():
    ways = three_ways()
    assert [way.duration for way in ways] == ways.durations.tolist() == [10.0, 12.0, 20.0]
    assert ways[1] is ways.ways[1]
    with pytest.raises(ValueError, match="read-only"):
        ways.risks[0] = 0.0
