"""Roadmaps of trajectory primitives: what they find is flown, and nothing faster is missed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from ompl_risk import InverseDistance, Lp, Sobolev, TerrainClearance, planners, terrains
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.planners.roadmap.equal_time_flights import equal_time_flights
from ompl_risk.planners.roadmap.exploring import alternative_routes
from ompl_risk.planners.roadmap.flights import HEADINGS, flight_roadmap
from ompl_risk.planners.roadmap.region import VertexRegion
from ompl_risk.planners.roadmap.shortening import shortened


@pytest.fixture(scope="module")
def steering():
    return HelicopterSteering()


@pytest.fixture(scope="module")
def problem():
    """Across a ridge with a gap: 4 km of ground 3 km wide, a ceiling below the ridge."""
    x, y = np.meshgrid(np.arange(0.0, 4001.0, 50.0), np.arange(0.0, 3001.0, 50.0))
    ridge = 400.0 * np.exp(-(((x - 2000.0) / 200.0) ** 2))
    gap = 1.0 - np.exp(-(((y - 900.0) / 250.0) ** 2))
    ground = terrains.Terrain(ridge * gap, spacing=(50.0, 50.0))
    clearance = TerrainClearance(ground, 5.0, threads=1)
    return planners.low_level_flight(
        clearance,
        (500.0, 1500.0),
        (3500.0, 1500.0),
        ceiling=250.0,
        margin=0.3,
        avoidance=InverseDistance(80.0),
    )


@pytest.fixture(scope="module")
def roadmap(problem, steering):
    return flight_roadmap(problem, steering, places=250, seed=3, threads=1)


def test_ends_hover_at_start_and_goal(roadmap, problem, steering):
    assert len(roadmap.starts) == 1
    assert len(roadmap.goals) == HEADINGS
    ends = roadmap.states[[*roadmap.starts, *roadmap.goals]]
    assert (ends[0, :3] == problem.start).all()
    assert (ends[1:, :3] == problem.goal).all()
    assert (steering.library.speeds[ends[:, 4].astype(int)] == 0.0).all()


def test_every_place_has_a_vertex_for_each_cruise_speed(roadmap):
    sampled = roadmap.states[1 + HEADINGS :]
    places, counts = np.unique(sampled[:, :4], axis=0, return_counts=True)
    assert len(places) > 50
    assert (counts == 3).all()
    assert set(sampled[:, 4]) == {1.0, 2.0, 3.0}


def test_fastest_route_is_that_of_all_edges_evaluated(roadmap, problem, steering):
    """An independent Dijkstra over (vertex, trim) with every edge known beforehand."""
    tail, head = roadmap.edges.ends()
    a, b = roadmap.states[tail], roadmap.states[head]
    weights = roadmap.motions.durations(a, b)
    free = np.isfinite(roadmap.motions.costs(a, b)) & roadmap.gate.allows_motions(a, b)
    matrix = csr_array((weights[free], (tail[free], head[free])), shape=(roadmap.n, roadmap.n))
    expected = dijkstra(matrix, indices=roadmap.starts)[0, roadmap.goals].min()
    assert math.isfinite(expected)
    assert roadmap.fastest().duration == pytest.approx(expected, rel=1e-12)


def test_edges_are_durations_of_the_steering(roadmap, steering):
    rng = np.random.default_rng(0)
    tail, head = roadmap.edges.ends()
    for e in rng.choice(roadmap.edges.m, 30, replace=False):
        way = steering.connect(roadmap.states[tail[e]], roadmap.states[head[e]])
        assert way.exists
        assert roadmap.edges.duration[e] == pytest.approx(way.duration, rel=1e-12)


@pytest.mark.parametrize("which", ["fastest", "search"])
def test_routes_are_flown_with_the_risk_that_was_promised(which, roadmap, problem, steering):
    route = getattr(roadmap, which)()
    flight = steering.flight(roadmap.states[route.vertices])
    positions = flight.planned[:, :3]
    d = problem.clearance(positions)
    assert d.min() > problem.min_clearance
    f = problem.avoidance(d)
    assert Sobolev(1)(flight.t, f) ** 2 == pytest.approx(route.risk, rel=0.02)
    assert route.risk > 0.0
    np.testing.assert_allclose(positions[-1], problem.goal, atol=1e-6)
    assert flight.duration == pytest.approx(route.duration, abs=0.1)


def test_routes_stay_in_the_box(roadmap, problem, steering):
    for route in alternative_routes(roadmap, 10, excess=0.3, min_distance=50.0):
        path = route.states[:, :3]
        assert (path >= problem.low - 1e-6).all()
        assert (path <= problem.high + 1e-6).all()


def test_safest_has_no_more_risk_than_any_alternative(roadmap):
    safest = roadmap.search()
    for route in alternative_routes(roadmap, 10, excess=0.5, min_distance=50.0):
        assert safest.risk <= route.risk * (1.0 + 1e-9)


def test_shortened_costs_neither_time_nor_risk(roadmap, steering):
    shorter = 0
    for route in alternative_routes(roadmap, 10, excess=0.5, min_distance=50.0):
        found = shortened(route, roadmap)
        assert found.duration <= route.duration * (1.0 + 1e-12)
        assert found.risk <= route.risk * (1.0 + 1e-9)
        assert set(found.vertices) <= set(route.vertices)
        assert found.vertices[0] == route.vertices[0]
        assert found.vertices[-1] == route.vertices[-1]
        shorter += len(found.vertices) < len(route.vertices)
    assert shorter > 0


def test_equal_time_flights_are_that_and_differ(roadmap, problem, steering):
    excess, apart = 0.25, 100.0
    found = equal_time_flights(roadmap, problem, steering, 3, excess=excess, min_distance=apart)
    durations = [route.duration for route in found.routes]
    assert len(found.flights) == len(found.routes) >= 2
    assert durations[0] == min(durations)
    assert max(durations) <= (1.0 + excess) * durations[0] * (1.0 + 1e-12)
    assert found.separation >= apart or found.sides > 1
    assert f"{len(found.flights)} of {found.tried}" in found.summary


def test_same_seed_same_roadmap(problem, steering, roadmap):
    again = flight_roadmap(problem, steering, places=250, seed=3, threads=2)
    np.testing.assert_array_equal(again.states, roadmap.states)
    assert again.fastest().duration == roadmap.fastest().duration


def test_growing_that_is_always_cut_short_comes_to_the_same_end(problem, steering, roadmap):
    """Calls of ``solve`` may be shorter than it takes to connect what has been sampled."""
    parts = flight_roadmap(problem, steering, places=1, seed=3, threads=1)
    whole = flight_roadmap(problem, steering, places=1, seed=3, threads=1)
    assert whole.grow(250) > 0
    calls = 1
    while parts.grow(250, stop=lambda: True) == 0:
        assert parts.n < whole.n
        calls += 1
        assert calls < 20
    assert calls > 1
    np.testing.assert_array_equal(parts.states, whole.states)
    assert parts.edges.m == whole.edges.m
    np.testing.assert_array_equal(parts.edges.weight, whole.edges.weight)
    assert parts.fastest().duration == whole.fastest().duration


def test_risk_can_be_any_norm_that_adds_up(problem, steering):
    by_maximum = flight_roadmap(problem, steering, places=250, seed=3, norm=Lp(math.inf), threads=1)
    route = by_maximum.search()
    flight = steering.flight(by_maximum.states[route.vertices])
    f = problem.avoidance(problem.clearance(flight.planned[:, :3]))
    assert route.risk == pytest.approx(f.max(), rel=0.02)


def test_no_places_are_refused(problem, steering):
    with pytest.raises(ArgumentError, match="places = 0"):
        flight_roadmap(problem, steering, places=0)


def test_region_of_vertices(steering):
    low, high = np.array([0.0, 0.0, 10.0]), np.array([100.0, 200.0, 30.0])
    region = VertexRegion(low, high, steering, seed=1)
    assert (region.width, region.dimensions, region.copies) == (5, 4, 3)
    states = region.sample(64)
    assert states.shape == (192, 5)
    assert (states[:, :3] >= low).all()
    assert (states[:, :3] <= high).all()
    inner = region.sample(16, within=(low + 5.0, high - 5.0))
    assert (inner[:, :3] >= low + 5.0).all()
    assert (inner[:, :3] <= high - 5.0).all()
    # headings all round
    assert np.histogram(states[::3, 3] % (2 * math.pi), 4, (0.0, 2 * math.pi))[0].min() >= 10


def test_flights_that_collide_beside_their_plan_are_left_out(roadmap, problem, steering):
    """With a clearance that the flown states break though the planned ones do not."""
    options = {"excess": 0.25, "min_distance": 100.0}
    found = equal_time_flights(roadmap, problem, steering, 3, **options)
    refused = found.flights[0].states[:, :3]

    class Struck:
        def __call__(self, points):
            d = problem.clearance(points)
            return d - 1e3 * (len(points) == len(refused) and np.array_equal(points, refused))

    struck = replace(problem, clearance=Struck())
    again = equal_time_flights(roadmap, struck, steering, 3, **options)
    assert again.tried >= found.tried or len(again.flights) < len(found.flights)
    for flight in again.flights:
        assert not np.array_equal(flight.states[:, :3], refused)
    assert len(again.flights) >= 1
