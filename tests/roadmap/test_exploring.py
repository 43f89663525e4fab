"""Many routes at once: nothing is missed although most edges are never evaluated."""

import math
from itertools import combinations

import numpy as np
import pytest
from scene import CEILING, D0, SPEED, counted, ends, hills, roadmap

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError, NoWayError
from ompl_risk.frechet import frechet_distance
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.low_level import low_level_flight
from ompl_risk.planners.roadmap.building import roadmap_of, sides_of
from ompl_risk.planners.roadmap.equal_time import equal_time_paths
from ompl_risk.planners.roadmap.exploring import (
    alternative_routes,
    evaluate_within,
    pareto_routes,
)
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.pareto import pareto_set
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

NORMS = [Lp(1), Lp(math.inf), Sobolev(1)]
names = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


def grown(norm=None, n=200, seed=0):
    made = roadmap(counted(norm), seed=seed)
    made.grow(n)
    made.search()
    return made


def eager(made):
    """The same graph, every edge evaluated."""
    tail, head = np.sort(made.edges.ends(), axis=0)
    a, b = made.states[tail], made.states[head]
    return Graph.of_edges(
        made.n,
        np.column_stack([tail, head]),
        made.motions.costs(a, b),
        made.motions.durations(a, b),
        maximum=made.maximum,
    )


@names
@pytest.mark.parametrize("seed", [0, 1])
def test_the_pareto_set_is_that_of_the_graph_with_every_edge_evaluated(norm, seed):
    made = grown(norm, seed=seed)
    front = pareto_routes(made)
    exact = pareto_set(eager(made), made.starts, made.goals)
    np.testing.assert_allclose(
        [route.duration for route in front.routes], exact.durations, rtol=1e-9
    )
    np.testing.assert_allclose([route.risk for route in front.routes], exact.risks, rtol=1e-9)
    assert len(exact) >= 2


@names
def test_fastest_and_safest_are_the_ends_of_the_pareto_set(norm):
    made = grown(norm)
    exact = pareto_set(eager(made), made.starts, made.goals)
    assert made.fastest().duration == pytest.approx(exact.durations[0], rel=1e-9)
    assert made.safest().risk == pytest.approx(exact.risks[-1], rel=1e-9)


def test_queries_of_the_front_give_routes():
    front = pareto_routes(grown())
    durations = [route.duration for route in front.routes]
    middle = len(durations) // 2
    assert front.least_risk(within=durations[middle]) is front.routes[middle]
    assert front.fastest(within_risk=front.routes[middle].risk) is front.routes[middle]
    with pytest.raises(NoWayError, match="fastest"):
        front.least_risk(within=0.9 * durations[0])


@pytest.mark.parametrize("excess", [0.02, 0.2])
def test_all_edges_of_all_paths_within_the_limit_are_evaluated(excess):
    made = grown(n=120)
    whole = eager(made)
    least = whole.tree(made.starts, whole.flyable_duration).distance[made.goals[0]]
    limit = (1.0 + excess) * least
    known = evaluate_within(made, limit)
    there = whole.tree(made.starts, whole.flyable_duration).distance
    back = whole.tree(made.goals, whole.flyable_duration).distance
    tail, head = made.edges.ends()
    through = np.minimum(there[tail] + back[head], there[head] + back[tail]) + whole.duration
    needed = (through <= limit) & np.isfinite(whole.risk)
    assert needed.any()
    np.testing.assert_allclose(known.risk[needed], whole.risk[needed], rtol=1e-9)
    assert made.evaluated < made.edges.m


def test_alternatives_are_within_the_excess_of_the_fastest_and_differ():
    made = grown(n=600)
    routes = alternative_routes(made, 6, excess=0.15, min_distance=60.0)
    fastest = made.fastest().duration
    assert len(routes) >= 2
    assert routes[0].duration == pytest.approx(fastest)
    for route in routes:
        assert route.duration <= 1.15 * fastest * (1 + 1e-9)
        assert math.isfinite(route.risk)
    fine = [Trajectory.at_constant_speed(r.states, SPEED).densify(3.0).positions for r in routes]
    for a, b in combinations(fine, 2):
        assert frechet_distance(a, b) >= 60.0 - 3.0


def test_without_a_path_there_is_nothing():
    heights = np.zeros((41, 41))
    heights[:, 20] = CEILING + 5.0
    made = roadmap(terrain=Terrain(heights, spacing=(25.0, 25.0)))
    made.grow(200)
    assert alternative_routes(made, 3) == ()
    assert pareto_routes(made).routes == ()


@pytest.fixture(scope="module")
def problem():
    start, goal = ends(hills(relief=45.0))
    return low_level_flight(
        TerrainClearance(hills(relief=45.0), 2.0),
        start[:2],
        goal[:2],
        start_height=20.0,
        goal_height=20.0,
        ceiling=75.0,
        margin=0.0,
        min_clearance=4.0,
        speed=SPEED,
        avoidance=InverseDistance(D0),
    )


def test_paths_of_equal_time_are_no_worse_than_the_routes_they_come_from(problem):
    made = roadmap_of(problem, samples=2500, seed=2)
    paths = equal_time_paths(made, problem, 5, excess=0.2, min_distance=50.0)
    assert len(paths.positions) >= 2
    lengths = [np.linalg.norm(np.diff(p, axis=0), axis=1).sum() for p in paths.positions]
    assert lengths[0] == min(lengths)
    assert max(lengths) <= 1.2 * min(lengths) * (1 + 1e-9)
    assert lengths[0] <= made.fastest().duration * SPEED * (1 + 1e-9)
    sides = sides_of(problem)
    assert paths.sides == len({sides.word(p) for p in paths.positions})
    fine = [Trajectory.at_constant_speed(p, SPEED).densify(1.0).positions for p in paths.positions]
    for points in fine:
        assert problem.clearance(points).min() > 4.0 - 1e-9
        assert (points >= problem.low - 1e-9).all()
        assert (points <= problem.high + 1e-9).all()
    for (a, p), (b, q) in combinations(zip(fine, paths.positions, strict=True), 2):
        assert frechet_distance(a, b) >= 50.0 - 12.0 or sides.word(p) != sides.word(q)
    assert str(len(paths.positions)) in paths.summary


def test_the_same_seed_gives_the_same_paths(problem):
    found = []
    for threads in (1, 2):
        made = roadmap_of(problem, samples=1500, seed=3, threads=threads)
        found.append(equal_time_paths(made, problem, 3, excess=0.2, min_distance=50.0).positions)
    assert len(found[0]) == len(found[1])
    for a, b in zip(*found, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_norm_that_does_not_add_up_is_refused(problem):
    with pytest.raises(ArgumentError, match="norm"):
        roadmap_of(problem, samples=100, norm=Sobolev(2))
