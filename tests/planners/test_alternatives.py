import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_graphs import dense, graphs, ring, simple_paths, total_duration, total_risk, vertices_of

from ompl_risk.errors import ArgumentError
from ompl_risk.frechet import frechet_distance
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.roadmap.alternatives import alternatives
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.sides import Sides

TINY = 1e-6


@given(graphs(), st.data(), st.floats(0.0, 1.0), st.sampled_from([TINY, 20.0, 80.0]))
@settings(max_examples=200, deadline=None)
def test_against_all_simple_paths(graph, data, excess, min_distance):
    start = data.draw(st.integers(0, graph.n - 1))
    goals = data.draw(st.lists(st.integers(0, graph.n - 1), min_size=1, max_size=2))
    points = ring(graph.n)
    every = dict.fromkeys(simple_paths(graph, start, goals))
    found = alternatives(
        graph, points, start, goals, count=30, excess=excess, min_distance=min_distance
    )
    assert bool(found) == bool(every)
    if not every:
        return
    least = min(total_duration(graph, edges) for _, edges in every)
    assert found[0].way.duration == pytest.approx(least, rel=1e-12)
    for a in found:
        assert (tuple(a.way.vertices.tolist()), tuple(a.way.edges.tolist())) in every
        assert a.way.duration == pytest.approx(total_duration(graph, a.way.edges), rel=1e-12)
        assert a.way.risk == pytest.approx(total_risk(graph, a.way.edges), rel=1e-12)
        assert a.way.duration <= (1.0 + excess) * least * (1.0 + 1e-11)
    for a, b in combinations(found, 2):
        curves = [dense(points[x.way.vertices], 3.0) for x in (a, b)]
        assert frechet_distance(*curves) >= min_distance


@given(graphs(tied=True), st.data())
@settings(max_examples=80, deadline=None)
def test_ties_and_edges_of_no_duration(graph, data):
    start = data.draw(st.integers(0, graph.n - 1))
    goal = data.draw(st.integers(0, graph.n - 1))
    every = simple_paths(graph, start, [goal])
    found = alternatives(graph, ring(graph.n), start, goal, count=30, excess=0.0, min_distance=TINY)
    assert bool(found) == bool(every)
    least = min((total_duration(graph, e) for _, e in every), default=0.0)
    assert all(a.way.duration == least for a in found)
    assert set(vertices_of(found)) <= {vertices for vertices, _ in every}
    assert len(set(vertices_of(found))) == len(found)


def grid_with_a_hole(size=9, hole=2):
    """Vertices 10 m apart, none within ``hole`` of the middle; start and goal left and right."""
    middle = size // 2
    places = [
        (i, j)
        for i in range(size)
        for j in range(size)
        if max(abs(i - middle), abs(j - middle)) > hole
    ]
    number = {place: k for k, place in enumerate(places)}
    ends = [
        (k, number[i + a, j + b])
        for (i, j), k in number.items()
        for a, b in ((1, 0), (0, 1))
        if (i + a, j + b) in number
    ]
    graph = Graph.of_edges(len(places), ends, np.ones(len(ends)), np.ones(len(ends)))
    points = 10.0 * np.array(places, dtype=float)
    return graph, points, number[0, middle], number[size - 1, middle], 10.0 * middle


def test_a_hole_has_two_sides():
    graph, points, start, goal, middle = grid_with_a_hole()
    sides = Sides([(middle, middle)])
    far = {"count": 9, "excess": 0.0, "min_distance": 1000.0}
    found = alternatives(graph, points, start, goal, **far, sides=sides)
    assert len(found) == 2
    assert len({a.side for a in found}) == 2
    above = [(points[a.way.vertices, 1] > middle).any() for a in found]
    below = [(points[a.way.vertices, 1] < middle).any() for a in found]
    assert above == [not b for b in below]
    assert sorted(above) == [False, True]
    assert [a.side for a in found] == [sides.word(points[a.way.vertices]) for a in found]
    assert len(alternatives(graph, points, start, goal, **far)) == 1


def test_new_sides_come_before_far_paths():
    """Three ways: straight, far aside on the same side, and close by but past the peak."""
    points = [(0, 0), (500, 1), (500, 400), (500, -20), (1000, 0)]
    ends = [(0, 1), (1, 4), (0, 2), (2, 4), (0, 3), (3, 4)]
    lengths = [np.linalg.norm(np.subtract(points[a], points[b])) for a, b in ends]
    graph = Graph.of_edges(5, ends, np.ones(6), lengths)
    sides = Sides([(500.0, -10.0)])
    asked = {"count": 9, "excess": 0.5, "min_distance": 100.0, "stretch": math.inf}
    found = alternatives(graph, points, 0, 4, **asked, sides=sides)
    assert [path[1] for path in vertices_of(found)] == [1, 3, 2]
    assert [path[1] for path in vertices_of(alternatives(graph, points, 0, 4, **asked))] == [1, 2]
    first = alternatives(graph, points, 0, 4, **(asked | {"count": 2}), sides=sides)
    assert [path[1] for path in vertices_of(first)] == [1, 3]


def test_the_farthest_comes_first_among_one_side():
    aside = [0.0, 60.0, 150.0, 330.0, -100.0]
    points = [(0, 0), *((500, y) for y in aside), (1000, 0)]
    ends = [(0, k) for k in range(1, 6)] + [(k, 6) for k in range(1, 6)]
    lengths = [np.linalg.norm(np.subtract(points[a], points[b])) for a, b in ends]
    graph = Graph.of_edges(7, ends, np.ones(10), lengths)
    asked = {"count": 9, "excess": 1.0, "stretch": math.inf}
    found = alternatives(graph, points, 0, 6, **asked, min_distance=20.0)
    assert [aside[path[1] - 1] for path in vertices_of(found)] == [0.0, 330.0, 150.0, -100.0, 60.0]
    assert len(alternatives(graph, points, 0, 6, **asked, min_distance=80.0)) == 4


def test_min_distance_is_kept_and_little_more_is_asked():
    """Curves exactly 100 m apart; sampling asks for at most a sixteenth more than it must."""
    points = [(0, 0), (500, 0), (500, 100), (1000, 0)]
    ends = [(0, 1), (1, 3), (0, 2), (2, 3)]
    lengths = [np.linalg.norm(np.subtract(points[a], points[b])) for a, b in ends]
    graph = Graph.of_edges(4, ends, np.ones(4), lengths)
    for min_distance, different in ((100.01, 1), (100.0 / (1 + 1 / 16), 2)):
        found = alternatives(graph, points, 0, 3, count=9, min_distance=min_distance)
        assert len(found) == different


def test_one_way_edges():
    ends = [(0, 1), (1, 3), (0, 2), (3, 2), (3, 4), (2, 4)]
    graph = Graph.of_edges(5, ends, np.ones(6), np.ones(6), undirected=False)
    found = alternatives(graph, ring(5), 0, 4, count=9, excess=1.0, min_distance=TINY)
    assert vertices_of(found)[0] == (0, 2, 4)
    assert set(vertices_of(found)) <= {(0, 2, 4), (0, 1, 3, 4), (0, 1, 3, 2, 4)}
    assert (0, 1, 3, 4) in vertices_of(found)
    assert alternatives(graph, ring(5), 4, 0, count=9, min_distance=TINY) == ()


def test_any_goal_will_do():
    ends = [(0, 1), (1, 2), (0, 3), (3, 4)]
    graph = Graph.of_edges(5, ends, np.ones(4), [1.0, 1.0, 1.0, 1.1])
    found = alternatives(graph, ring(5), 0, [2, 4, 2], count=9, excess=0.2, min_distance=TINY)
    assert vertices_of(found) == [(0, 1, 2), (0, 3, 4)]
    through = alternatives(graph, ring(5), 0, [1, 2], count=9, excess=5.0, min_distance=TINY)
    assert vertices_of(through) == [(0, 1)]


def test_nothing_to_find():
    graph = Graph.of_edges(4, [(0, 1), (1, 2)], [1.0, math.inf], [1.0, 1.0])
    assert alternatives(graph, ring(4), 0, 3, count=5, min_distance=1.0) == ()
    assert alternatives(graph, ring(4), 0, 2, count=5, min_distance=1.0) == ()
    (here,) = alternatives(graph, ring(4), 1, [1, 3], count=5, min_distance=1.0)
    assert (here.way.vertices.tolist(), here.way.duration, here.way.risk) == ([1], 0.0, 0.0)


@pytest.fixture(scope="module")
def roadmap(problem):
    """A small roadmap over a ridge with two passes: positions, ends of the edges."""
    rng = np.random.default_rng(5)
    points = rng.uniform(problem.low, problem.high, (4000, 3))
    points = points[problem.obstacles(points) > 0.0][:900]
    points = np.vstack([problem.start, problem.goal, points])
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    near = np.argsort(apart, axis=1)[:, 1:15]
    pairs = np.column_stack([np.repeat(np.arange(len(points)), 14), near.ravel()])
    return points, np.unique(np.sort(pairs, axis=1), axis=0)


@pytest.mark.parametrize("norm", [Sobolev(1), Lp(math.inf)])
def test_over_a_ridge_with_two_passes(problem, roadmap, norm):
    points, ends = roadmap
    weighing = Risk(problem.avoidance, norm, speed=20.0, duration_weight=0.0)
    batch = motion_batch(problem.clearance, weighing)
    a, b = points[ends[:, 0]], points[ends[:, 1]]
    free = motion_batch(problem.obstacles, weighing).are_free(a, b)
    risk = np.where(free, batch.costs(a, b), math.inf)
    maximum = math.isinf(getattr(norm, "p", 2.0))
    graph = Graph.of_edges(len(points), ends, risk, batch.durations(a, b), maximum=maximum)
    sides = Sides.of_terrain(problem.clearance.terrain, problem.low, problem.high,
                             radius=5.0, min_clearance=problem.min_clearance)  # fmt: skip
    assert sides.count == 1
    asked = {"count": 12, "excess": 0.1, "min_distance": 120.0, "sides": sides}
    found = alternatives(graph, points, 0, 1, **asked)
    assert len({x.side for x in found}) == 2
    assert len({x.side for x in found[:3]}) == 2
    many = alternatives(graph, points, 0, 1, **(asked | {"count": 1000}))
    assert len(many) > 12
    assert found[1].way.risk == min(x.way.risk for x in many)
    crossing = [np.interp(1500.0, *points[x.way.vertices, :2].T) for x in found]
    assert len({(y > 1000.0, x.side) for y, x in zip(crossing, found, strict=True)}) == 2
    for x, y in combinations(found, 2):
        curves = [dense(points[z.way.vertices], 20.0) for z in (x, y)]
        assert x.side != y.side or frechet_distance(*curves) >= 120.0
    fastest = min(x.way.duration for x in found)
    assert found[0].way.duration == fastest
    assert max(x.way.duration for x in found) <= 1.1 * fastest * (1 + 1e-11)
    risks = [x.way.risk for x in found]
    assert max(risks) > 1.5 * min(risks)
    again = alternatives(graph, points, 0, 1, **asked)
    assert vertices_of(again) == vertices_of(found)
    assert vertices_of(alternatives(graph, points, 0, 1, **(asked | {"count": 1}))) == [
        tuple(found[0].way.vertices.tolist())
    ]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"states": np.zeros((3, 2))}, r"states.shape = \(3, 2\): must be \(4, k\)"),
        ({"states": np.full((4, 2), np.nan)}, r"states\[0, 0\] = nan"),
        ({"start": 4}, "start = 4: must be vertices from 0 to 3"),
        ({"start": 0.5}, "start = 0.5"),
        ({"goals": []}, r"goals = \[\]: .* at least one"),
        ({"goals": [1, -1]}, r"goals = \[1, -1\]"),
        ({"count": 0}, "count = 0: must be a whole number of at least 1"),
        ({"count": 2.0}, "count = 2.0"),
        ({"count": True}, "count = True"),
        ({"excess": -0.1}, "excess = -0.1: must be 0 or more"),
        ({"excess": math.inf}, "excess = inf"),
        ({"excess": math.nan}, "excess = nan"),
        ({"min_distance": 0.0}, "min_distance = 0.0: must be a positive"),
        ({"stretch": -1.0}, "stretch = -1.0: must be 0 or more"),
        ({"mixes": [-1.0]}, r"mixes = \[-1.0\]: must be 0 or more and finite"),
        ({"mixes": [math.inf]}, r"mixes = \[inf\]"),
        ({"mixes": [math.nan]}, r"mixes = \[nan\]"),
        ({"mixes": 1.0}, r"mixes = 1.0: .* shape \(k,\)"),
    ],
)
def test_what_is_refused(given, message):
    graph = Graph.of_edges(4, [(0, 1), (1, 2), (2, 3)], np.ones(3), np.ones(3))
    asked = {"states": ring(4), "start": 0, "goals": 3, "count": 2, "min_distance": 1.0} | given
    states, start, goals = (asked.pop(name) for name in ("states", "start", "goals"))
    with pytest.raises(ArgumentError, match=message):
        alternatives(graph, states, start, goals, **asked)
