"""The Pareto set of a graph against all of its simple paths, and against slower searches."""

import itertools
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError, LabelLimitError, NoWayError
from ompl_risk.planners.roadmap.front import ParetoSet
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.pareto import pareto_set


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


def random_graph(seed, n, m, *, whole=False, **kind):
    rng = np.random.default_rng(seed)
    ends = rng.integers(0, n, (m, 2))
    draw = (lambda: rng.integers(0, 6, m).astype(float)) if whole else (lambda: rng.random(m))
    risk, duration = draw(), draw()
    risk[rng.random(m) < 0.3] = 0.0
    risk[rng.random(m) < 0.05] = math.inf
    return Graph.of_edges(n, ends, risk, duration, **kind)


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


def test_ways_whose_durations_round_to_the_same_are_one():
    ends, risk = [(0, 1), (0, 1), (1, 2)], [2.0, 1.0, 0.0]
    graph = Graph.of_edges(3, ends, risk, [0.0, 2.0**-54, 1.0])
    assert found(pareto_set(graph, 0, 2)) == [(1.0, 1.0)]


def test_a_small_risk_beside_a_great_one_stays_above_nothing():
    graph = Graph.of_edges(2, [(0, 1)] * 3, [1e9, 1e-30, 0.0], [1.0, 2.0, 3.0])
    assert pareto_set(graph, 0, 1).risks.tolist() == [1e9, 1e-30, 0.0]


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
