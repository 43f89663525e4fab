"""Peers and oracles: a comparison is worth as much as what it compares with."""

import math
from itertools import pairwise

import numpy as np
import pytest
from ompl import geometric as og

from benchmarks import oracle, planning
from benchmarks.objective import Config, judge
from benchmarks.peers.fcl_ground import FclGround
from benchmarks.peers.fcl_planning import inverse_distance, squared_sobolev
from benchmarks.peers.quadtree import QuadtreeGround
from benchmarks.probability import fine_share
from benchmarks.scenes import above_ground
from ompl_risk import InverseDistance, Sobolev
from ompl_risk.terrains import Terrain

RNG = np.random.default_rng(5)
ROUGH = Terrain(RNG.normal(size=(23, 34)) * 2.0, spacing=(1.0, 1.5), origin=(-3.0, 40.0))
PLANE = Terrain(
    np.add.outer(0.5 * np.arange(40.0), 0.75 * np.arange(50.0)), spacing=(1.0, 1.0)
)  # z = 0.75 x + 0.5 y
FLAT = Terrain(np.zeros((61, 61)), spacing=(50.0, 50.0))


def mesh_distances(terrain, points):
    """By trimesh, a third party."""
    return terrain.surface().nearest.on_surface(points)[1]


@pytest.mark.parametrize(
    "distances",
    [
        lambda t, points: np.array([oracle.distance(t, p) for p in points]),
        lambda t, points: np.array([oracle.distance_in_window(t, p) for p in points]),
        lambda t, points: QuadtreeGround(t).distances(points),
        lambda t, points: FclGround(t).distances(points),
    ],
    ids=["all triangles", "window", "quadtree", "fcl"],
)
def test_distances(distances):
    points = above_ground(ROUGH, 60, np.random.default_rng(1), low=-3.0, high=12.0)
    assert distances(ROUGH, points) == pytest.approx(mesh_distances(ROUGH, points), abs=1e-9)
    middle = np.array([[25.0, 20.0, 0.75 * 25 + 0.5 * 20 + 3.0]])
    assert distances(PLANE, middle) == pytest.approx(3.0 / math.sqrt(1 + 0.75**2 + 0.5**2))


def test_bounded_quadtree_distances_are_cut():
    points = above_ground(ROUGH, 60, np.random.default_rng(2), low=0.0, high=12.0)
    tree = QuadtreeGround(ROUGH)
    assert np.array_equal(tree.distances(points, 4.0), np.minimum(tree.distances(points), 4.0))


def test_sphere_touches_where_its_distance_vanishes():
    ground = FclGround(ROUGH, radius=1.0)
    points = above_ground(ROUGH, 200, np.random.default_rng(3), low=0.0, high=4.0)
    d = mesh_distances(ROUGH, points) - 1.0
    assert ground.distances(points) == pytest.approx(d, abs=1e-9)
    assert [ground.touches(p) for p in points] == list(d <= 0.0)
    assert 20 < np.count_nonzero(d <= 0.0) < 180


def test_points_are_where_they_should_be():
    points = above_ground(ROUGH, 500, np.random.default_rng(4), low=2.0, high=3.0, margin=1.0)
    up = points[:, 2] - ROUGH.height(points[:, 0], points[:, 1])
    assert up.min() >= 2.0 - 1e-9
    assert up.max() <= 3.0 + 1e-9
    assert points[:, 0].min() >= -2.0
    assert points[:, 0].max() <= ROUGH.extent[1] - 1.0


def test_quadrature_of_the_peer_is_exact_for_straight_lines():
    # f = 1 + 2 t on [0, 3]: integral of f^2 is (7^3 - 1) / 6, of f'^2 is 12
    t = np.linspace(0.0, 3.0, 8)
    assert squared_sobolev(1.0 + 2.0 * t, t[1]) == pytest.approx((7**3 - 1) / 6 + 12)
    d = np.array([1.0, 50.0, 100.0, 300.0])
    assert inverse_distance(d, 100.0) == pytest.approx(InverseDistance(100.0)(d))


@pytest.mark.parametrize("height", [-0.6, 0.0, 0.3, 0.9])
def test_reference_share_over_flat_ground(height):
    # spherical cap: share of a unit ball below a plane `height` below its centre
    expected = (1.0 - height) ** 2 * (2.0 + height) / 4.0
    centre = np.array([1500.0, 1500.0, 100.0 * height])
    assert fine_share(FLAT, centre, 100.0, 20_000) == pytest.approx(expected, abs=2e-5)


def test_paths_are_judged_from_their_corners_alone():
    config = Config()
    ground = FclGround(FLAT, config.problem.radius)
    level = np.array([[100.0, 200.0, 45.0], [1300.0, 200.0, 45.0], [1300.0, 800.0, 45.0]])
    cost, least = judge(level, FLAT, ground, config.problem)
    f = 1 / 40 - 1 / config.problem.d0
    assert cost == pytest.approx(f * f * 1800 / config.problem.speed, rel=1e-9)
    assert least == pytest.approx(40.0)
    climb = np.array([[100.0, 200.0, 45.0], [1300.0, 200.0, 85.0]])
    length, t = np.linalg.norm(climb[1] - climb[0]), np.linspace(0.0, 1.0, 20_001)
    f = InverseDistance(config.problem.d0)(40.0 + 40.0 * t)
    expected = Sobolev(1).power(t * length / config.problem.speed, f)
    assert judge(climb, FLAT, ground, config.problem)[0] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("z", [-300.0, 4.0])
def test_a_path_below_or_into_the_ground_is_in_collision(z):
    config = Config()
    corners = np.array([[100.0, 200.0, 45.0], [1300.0, 200.0, z], [1300.0, 800.0, 45.0]])
    cost, least = judge(corners, FLAT, FclGround(FLAT, config.problem.radius), config.problem)
    assert cost == math.inf
    assert least <= 0.0
    assert judge(np.empty((0, 3)), FLAT, FclGround(FLAT), config.problem) == (math.inf, math.inf)


def test_peer_and_library_agree_on_motions(problem):
    terrain = planning.terrains.load(problem.terrain)
    setups = [og.SimpleSetup(problem.space(terrain)) for _ in range(2)]
    ours = planning.install_ours(setups[0], terrain, problem)
    peer = planning.install_peer(setups[1], terrain, problem)
    si, other = (setup.getSpaceInformation() for setup in setups)
    for each in (si, other):
        each.setup()
    points = above_ground(terrain, 80, np.random.default_rng(6), low=6.0, high=90.0, margin=100.0)
    points[:, 2] = np.minimum(points[:, 2], problem.box(terrain)[2, 1])
    states = [planning.as_state(si, point) for point in points]
    free = 0
    for a, b in pairwise(states):
        cost, theirs = ours.motionCost(a, b).value(), peer.motionCost(a, b).value()
        assert math.isinf(cost) == math.isinf(theirs)
        if math.isfinite(cost):
            assert theirs == pytest.approx(cost, rel=0.1, abs=1e-6)
            assert si.checkMotion(a, b)
            assert other.checkMotion(a, b)
            free += 1
        assert si.isValid(a) == other.isValid(a)
    assert 10 < free < 75
