"""P_c against closed forms over planes; one estimator against the other."""

import math

import numpy as np
import pytest
import trimesh
from scipy.stats import binomtest

from ompl_risk import terrains
from ompl_risk.clearance import MeshClearance, TerrainClearance, UnionClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.probability import BallSampling, ColumnQuadrature, collision_probability
from ompl_risk.probability.proportion import clopper_pearson
from ompl_risk.trajectory import Trajectory

R = 20.0


def cap(d, r=R):
    """Share of a ball beyond a plane at signed distance d from its centre."""
    d = np.clip(d, -r, r)
    return (1 - d / r) ** 2 * (2 + d / r) / 4


def plane(ax=0.0, ay=0.0, n=61, spacing=2.0):
    y, x = np.mgrid[0:n, 0:n] * spacing
    return terrains.Terrain(ax * (x - 60) + ay * (y - 60), spacing=(spacing, spacing))


def column(low=-30.0, high=30.0, n=41):
    return Trajectory(
        np.arange(n, dtype=float), [[60.0, 60.0, z] for z in np.linspace(low, high, n)]
    )


@pytest.mark.parametrize(("ax", "ay"), [(0, 0), (0.5, 0), (0.3, -0.4), (1.0, 0.7)])
def test_quadrature_over_planes_in_closed_form(ax, ay):
    path = column()
    profile = collision_probability(path, plane(ax, ay), R, max_step=None)
    d = path.positions[:, 2] / math.sqrt(1 + ax * ax + ay * ay)
    assert profile.p == pytest.approx(cap(d), abs=2e-3)
    assert np.sqrt(np.mean((profile.p - cap(d)) ** 2)) < 7e-4
    fine = ColumnQuadrature(rings=64, spokes=128)
    profile = collision_probability(path, plane(ax, ay), R, estimator=fine, max_step=None)
    assert profile.p == pytest.approx(cap(d), abs=5e-5)  # 64 rings: the clipping has kinks


def test_over_flat_ground_the_error_is_that_of_the_radial_rule_alone():
    path = column()
    estimator = ColumnQuadrature(rings=200, spokes=4)
    profile = collision_probability(path, plane(), R, estimator=estimator, max_step=None)
    assert profile.p == pytest.approx(cap(path.positions[:, 2]), abs=3e-6)


@pytest.mark.parametrize("estimator", [ColumnQuadrature(32, 64), BallSampling(20_000, seed=2)])
def test_growing_by_the_body_shifts_the_plane(estimator):
    path, clearance = column(n=13), TerrainClearance(plane(0.5, 0.0), radius=4.0)
    d = path.positions[:, 2] / math.sqrt(1.25)
    options = {"estimator": estimator, "max_step": None}
    grown = collision_probability(path, clearance, R, grow=True, **options)
    plain = collision_probability(path, clearance, R, **options)
    tolerance = 1e-4 if isinstance(estimator, ColumnQuadrature) else 0.02
    assert grown.p == pytest.approx(cap(d - 4.0), abs=tolerance)
    assert plain.p == pytest.approx(cap(d), abs=tolerance)


def test_sampling_agrees_with_quadrature_over_real_terrain():
    terrain = terrains.load("jacksboro")
    x = np.linspace(5e3, 25e3, 40)
    z = terrain.height(x, x) + np.linspace(5, 95, 40)
    path = Trajectory(np.arange(40.0), np.column_stack([x, x, z]))
    exact = collision_probability(path, terrain, 100.0, max_step=None)
    sampled = collision_probability(
        path, terrain, 100.0, estimator=BallSampling(20_000, seed=1), max_step=None
    )
    assert exact.p.max() > 0.1
    assert sampled.p == pytest.approx(exact.p, abs=5 * 0.5 / math.sqrt(20_000) + 1e-3)
    inside = (sampled.low - 1e-3 <= exact.p) & (exact.p <= sampled.high + 1e-3)
    assert inside.mean() > 0.85


def test_intervals_cover_the_truth_as_often_as_they_claim():
    path = Trajectory(np.arange(400.0), np.tile([60.0, 60.0, 5.0], (400, 1)))
    profile = collision_probability(
        path, plane(), R, estimator=BallSampling(300, confidence=0.9), max_step=None
    )
    covered = (profile.low <= cap(5.0)) & (cap(5.0) <= profile.high)
    assert binomtest(int(covered.sum()), 400, 0.9, alternative="less").pvalue > 1e-3
    assert profile.samples == 300


def test_no_hit_still_has_an_upper_bound():
    path = Trajectory([0.0, 1.0], [[60, 60, 50], [61, 60, 50]])
    profile = collision_probability(path, plane(), R, estimator=BallSampling(10_000))
    assert profile.p.max() == 0.0
    assert profile.high[0] == pytest.approx(3.689e-4, rel=1e-3)
    assert "10000" in repr(profile)


@pytest.mark.parametrize(("hits", "n"), [(0, 10), (3, 10), (10, 10), (500, 1000)])
def test_clopper_pearson_against_scipy(hits, n):
    expected = binomtest(hits, n).proportion_ci(0.95, method="exact")
    assert clopper_pearson(hits, n, 0.95) == pytest.approx((expected.low, expected.high))


def test_a_shared_offset_says_whether_the_whole_trajectory_ever_collides():
    """Level flight over flat ground: the states collide together, so ever equals each P_c."""
    path = Trajectory(np.arange(30.0), [[30.0 + 2 * k, 60.0, 5.0] for k in range(30)])
    shared = collision_probability(
        path, plane(), R, estimator=BallSampling(4000, offsets="shared"), max_step=None
    )
    assert np.ptp(shared.p) == 0.0
    assert shared.ever.p == shared.p[0]
    assert shared.ever.low < cap(5.0) < shared.ever.high
    independent = collision_probability(
        path, plane(), R, estimator=BallSampling(4000), max_step=None
    )
    assert independent.ever is None
    assert np.ptp(independent.p) > 0.0


def test_the_seed_reproduces():
    path = column(n=5)
    first, again = (
        collision_probability(path, plane(), R, estimator=BallSampling(500, seed=7)).p
        for _ in range(2)
    )
    other = collision_probability(path, plane(), R, estimator=BallSampling(500, seed=8)).p
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_meshes_and_unions_are_sampled_without_their_body():
    slab = trimesh.creation.box((200, 200, 100))
    slab.apply_translation((60, 60, -50))
    mesh = MeshClearance(slab, radius=4.0)
    union = UnionClearance([mesh, TerrainClearance(plane(), radius=4.0)])
    path, estimator = column(-5, 15, 3), BallSampling(1500, seed=3)
    for obstacles in (mesh, union, mesh.of_point(), lambda p: p[:, 2]):
        profile = collision_probability(path, obstacles, R, estimator=estimator, max_step=None)
        assert profile.p == pytest.approx(cap(path.positions[:, 2]), abs=0.05)
    grown = collision_probability(path, mesh, R, estimator=estimator, grow=True, max_step=None)
    assert grown.p == pytest.approx(cap(path.positions[:, 2] - 4.0), abs=0.05)


def test_states_are_refined_to_the_radius():
    path = Trajectory([0.0, 10.0], [[30, 60, 10], [90, 60, 10]])
    assert len(collision_probability(path, plane(), R).t) >= 60 / (R / 50)
    assert len(collision_probability(path, plane(), R, max_step=10.0).t) == 7
    assert len(collision_probability(path, plane(), R, max_step=None).t) == 2


def test_beyond_the_edge_the_ground_goes_on_level():
    path = Trajectory([0.0, 1.0], [[0, 0, 5], [120, 60, 5]])
    for estimator in (ColumnQuadrature(64, 64), BallSampling(40_000)):
        profile = collision_probability(path, plane(), R, estimator=estimator, max_step=None)
        assert profile.p == pytest.approx(cap(np.array([5, 5])), abs=0.01)


@pytest.mark.parametrize(
    ("call", "names"),
    [
        (lambda p: collision_probability(p, plane(), 0.0), "radius = 0.0"),
        (lambda p: collision_probability(p, plane(), R, max_step=-1.0), "max_step = -1.0"),
        (lambda p: collision_probability(p, plane(), R, grow=True), "grow = True"),
        (lambda p: collision_probability(p, 3, R), "obstacles = 3"),
        (
            lambda p: collision_probability(p, lambda q: q[:, 2], R, estimator=ColumnQuadrature()),
            "BallSampling()",
        ),
        (lambda p: collision_probability(p, lambda q: np.zeros(3), R), "obstacles(points)"),
        (lambda p: ColumnQuadrature(rings=0), "rings = 0"),
        (lambda p: ColumnQuadrature(spokes=7), "spokes = 7"),
        (lambda p: BallSampling(0), "samples = 0"),
        (lambda p: BallSampling(offsets="both"), "offsets = 'both'"),
        (lambda p: BallSampling(confidence=1.0), "confidence = 1.0"),
    ],
)
def test_bad_input_is_named(call, names):
    with pytest.raises(ArgumentError) as error:
        call(column())
    assert names in str(error.value)


def test_the_bounds_of_the_quadrature_hold_on_real_terrain():
    terrain = terrains.load("jacksboro")
    rng = np.random.default_rng(9)
    x, y = rng.uniform(3e3, 27e3, 600), rng.uniform(3e3, 28e3, 600)
    z = terrain.height(x, y) + rng.uniform(5, 130, 600)
    path = Trajectory(np.arange(600.0), np.column_stack([x, y, z]))
    coarse = collision_probability(path, terrain, 100.0, max_step=None)
    fine = collision_probability(
        path, terrain, 100.0, estimator=ColumnQuadrature(48, 96), max_step=None
    )
    held = (coarse.low - 1e-6 <= fine.p) & (fine.p <= coarse.high + 1e-6)
    assert held.mean() > 0.98
    assert np.mean(coarse.high - coarse.low) < 0.02


def test_a_peak_between_the_columns_is_not_declared_impossible():
    heights = np.zeros((61, 61))
    heights[30, 36] = 15.0
    spike = terrains.Terrain(heights, spacing=(2.0, 2.0))
    path = Trajectory([0.0, 1.0], [[60.0, 60.0, 21.0], [60.1, 60.0, 21.0]])
    truth = collision_probability(path, spike, R, estimator=BallSampling(400_000), max_step=None)
    profile = collision_probability(path, spike, R, max_step=None)
    assert truth.p.min() > 0.0
    assert (profile.high >= truth.p).all()


def test_out_of_reach_the_upper_bound_is_zero():
    path = Trajectory([0.0, 1.0], [[60, 60, R + 1], [61, 60, R + 2]])
    assert collision_probability(path, plane(), R).high.max() == 0.0


@pytest.mark.parametrize("grow", [False, True])
def test_beyond_the_edge_grown_and_united_ground_goes_on_level_too(grow):
    path = Trajectory([0.0, 1.0], [[0, 0, 5], [120, 60, 5]])
    clearance = TerrainClearance(plane(), radius=4.0)
    expected = cap(np.array([1.0, 1.0])) if grow else cap(np.array([5.0, 5.0]))
    for obstacles, estimator in (
        (clearance, ColumnQuadrature(64, 64)),
        (clearance, BallSampling(20_000)),
        (UnionClearance([clearance]), BallSampling(20_000)),
    ):
        profile = collision_probability(
            path, obstacles, R, estimator=estimator, grow=grow, max_step=None
        )
        assert profile.p == pytest.approx(expected, abs=0.015)
