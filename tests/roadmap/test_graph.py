"""Graphs and their shortest paths against scipy, and repaired paths against new ones."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from ompl_risk._kernels import graph as kernels
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.roadmap.graph import Graph, Tree, no_rows


def random_graph(seed, *, undirected=True, n=30, m=80):
    rng = np.random.default_rng(seed)
    pairs = {tuple(sorted(p)) if undirected else tuple(p) for p in rng.integers(0, n, (m, 2))}
    ends = np.array(sorted((a, b) for a, b in pairs if a != b))
    return Graph.of_edges(
        n,
        ends,
        rng.integers(0, 5, len(ends)).astype(float),
        rng.integers(1, 9, len(ends)).astype(float),
        undirected=undirected,
    ), ends


def scipys(n, ends, weight, root, *, undirected):
    keep = np.isfinite(weight)
    matrix = coo_matrix((weight[keep], ends[keep].T), (n, n)).tocsr()
    return dijkstra(matrix, directed=not undirected, indices=root)


@pytest.mark.parametrize("undirected", [True, False])
@pytest.mark.parametrize("seed", range(20))
def test_distances_are_those_of_scipy(seed, undirected):
    graph, ends = random_graph(seed, undirected=undirected)
    weight = graph.duration.copy()
    weight[::7] = math.inf
    tree = graph.tree(0, weight)
    np.testing.assert_array_equal(
        tree.distance, scipys(graph.n, ends, weight, 0, undirected=undirected)
    )
    backward = graph.reverse.tree(0, weight)
    expected = scipys(graph.n, ends[:, ::-1], weight, 0, undirected=undirected)
    np.testing.assert_array_equal(backward.distance, expected)


@pytest.mark.parametrize("undirected", [True, False])
def test_paths_of_a_tree_are_as_long_as_it_says(undirected):
    graph, ends = random_graph(3, undirected=undirected)
    tree = graph.tree(0, graph.duration)
    for end in np.flatnonzero(np.isfinite(tree.distance)):
        half = tree.half_edges(end)
        way = graph.way(0, half)
        assert way.vertices[-1] == end
        assert list(way.vertices) == list(tree.vertices(end))
        assert way.duration == tree.distance[end]
        for edge, a, b in zip(way.edges, way.vertices[:-1], way.vertices[1:], strict=True):
            assert (a, b) == tuple(ends[edge]) or (undirected and (b, a) == tuple(ends[edge]))
    for end in np.flatnonzero(np.isinf(tree.distance)):
        assert len(tree.vertices(end)) == len(tree.half_edges(end)) == 0


def test_a_maximum_tree_minimises_the_longest_edge():
    graph, ends = random_graph(5)
    tree = graph.tree(0, graph.duration, maximum=True)
    for limit in range(10):
        within = scipys(
            graph.n, ends, np.where(graph.duration <= limit, 1.0, math.inf), 0, undirected=True
        )
        np.testing.assert_array_equal(tree.distance <= limit, np.isfinite(within))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.booleans(), st.booleans())
def test_guided_paths_are_shortest_after_weights_have_risen(seed, undirected, maximum):
    graph, _ = random_graph(seed, undirected=undirected)
    rng = np.random.default_rng(seed)
    weight = graph.duration.copy()
    roots, goals = np.array([0, 1], np.int32), np.array([7, 8, 9], np.int32)
    rest = graph.reverse.tree(goals, weight, maximum=maximum).distance
    n = graph.n
    work = np.empty(n), np.empty(n, np.int32), np.empty(n, np.int64)
    for _ in range(6):
        goal = kernels.guided_path(
            graph.first, graph.target, graph.edge, weight, rest, roots, goals, maximum, *work
        )
        distances = graph.tree(roots, weight, maximum=maximum).distance[goals]
        if goal < 0:
            assert np.isinf(distances).all()
            return
        assert goal in goals
        half = Tree(*work).half_edges(goal)
        lengths = weight[graph.edge[half]]
        assert (lengths.max(initial=0.0) if maximum else lengths.sum()) == distances.min()
        way = graph.way(int(Tree(*work).vertices(goal)[0]), half)
        assert way.vertices[0] in roots
        assert way.vertices[-1] == goal
        raised = np.concatenate([way.edges, rng.integers(0, graph.m, 4)])
        more = rng.integers(0, 4, len(raised))
        weight[raised] = np.where(rng.random(len(raised)) < 0.2, math.inf, weight[raised] + more)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.booleans(), st.booleans())
def test_paths_are_repaired_when_edges_are_added(seed, undirected, maximum):
    graph, ends = random_graph(seed, undirected=undirected)
    new = np.random.default_rng(seed).random(graph.m) < 0.3
    weight = np.where(new, math.inf, graph.duration)
    tree = graph.tree(0, weight, maximum=maximum)
    seeds = np.unique(ends[new]).astype(np.int32)
    kernels.shortest_paths(
        graph.first, graph.target, graph.edge, graph.duration,
        seeds[np.isfinite(tree.distance[seeds])], maximum, tree.distance, tree.parent, tree.via,
    )  # fmt: skip
    anew = graph.tree(0, graph.duration, maximum=maximum)
    np.testing.assert_array_equal(tree.distance, anew.distance)


def test_edges_added_later_give_the_graph_of_all_edges():
    rng = np.random.default_rng(2)
    ends = np.array(
        sorted({tuple(sorted(p)) for p in rng.integers(0, 20, (60, 2)) if p[0] != p[1]})
    )
    tail, head = ends.T.astype(np.int32)
    rows = kernels.merged_rows(12, *no_rows(), tail[:0], head[:0], 0, True)
    old = (tail < 12) & (head < 12)
    rows = kernels.merged_rows(12, *rows, tail[old], head[old], 0, True)
    rows = kernels.merged_rows(20, *rows, tail[~old], head[~old], int(old.sum()), True)
    first, target, edge = rows
    order = np.concatenate([np.flatnonzero(old), np.flatnonzero(~old)])
    found = {
        (v, int(target[h]), int(order[edge[h]]))
        for v in range(20)
        for h in range(first[v], first[v + 1])
    }
    expected = {(a, b, e) for e, (a, b) in enumerate(ends.tolist())}
    assert found == expected | {(b, a, e) for a, b, e in expected}


def test_each_pair_of_neighbours_is_named_once():
    rng = np.random.default_rng(4)
    n, start, k = 40, 25, 6
    points = rng.random((n, 2))
    gaps = np.linalg.norm(points[start:, None] - points[None], axis=2)
    nearest = np.argsort(gaps, axis=1)[:, : k + 1].astype(np.int32)  # each its own nearest
    tail, head = kernels.neighbour_pairs(nearest, start, n)
    found = [frozenset(pair) for pair in zip(tail.tolist(), head.tolist(), strict=True)]
    expected = {
        frozenset((start + i, int(u)))
        for i in range(n - start)
        for u in nearest[i]
        if u != start + i
    }
    assert len(found) == len(set(found))
    assert set(found) == expected


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"ends": [[0, 3]]}, "ends"),
        ({"ends": [[-1, 1]]}, "ends"),
        ({"risk": [-1.0]}, "risk"),
        ({"risk": [math.nan]}, "risk"),
        ({"duration": [1.0, 2.0]}, "duration.shape"),
    ],
)
def test_wrong_edges_are_refused(changes, match):
    given = {"ends": [[0, 1]], "risk": [1.0], "duration": [1.0]} | changes
    with pytest.raises(ArgumentError, match=match):
        Graph.of_edges(3, **given)
