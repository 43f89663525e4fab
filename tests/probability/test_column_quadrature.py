"""The quadrature's kernel against the same sum in plain numpy, and what it leaves out."""

import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.probability import (
    BallSampling,
    ColumnQuadrature,
    collision_probabilities,
    collision_probability,
)
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

ROUGH = Terrain(
    np.random.default_rng(3).normal(size=(23, 34)) * 4.0, spacing=(3.0, 2.0), origin=(-3.0, 40.0)
)


def plain_halves(terrain, points, radius, estimator):
    """Sum over the columns of weight times the filled length, for either half of the columns."""
    x, y, half, weight, second = estimator.columns().T
    xmin, xmax, ymin, ymax = terrain.extent
    px = (points[:, :1] + radius * x).clip(xmin, xmax)  # beyond the map the ground goes on level
    py = (points[:, 1:2] + radius * y).clip(ymin, ymax)
    top = terrain.height(px.ravel(), py.ravel()).reshape(px.shape)
    bottom = points[:, 2:] - radius * half
    filled = weight * np.clip(top - bottom, 0.0, 2.0 * radius * half) / radius
    return np.stack([filled[:, second == 0].sum(axis=1), filled[:, second == 1].sum(axis=1)])


points_over_rough = st.lists(
    st.tuples(st.floats(-3.0, 96.0), st.floats(40.0, 84.0), st.floats(-30.0, 30.0)),
    min_size=1, max_size=30,
).map(np.array)  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(
    points_over_rough,
    st.floats(0.5, 60.0),
    st.sampled_from([(8, 16), (1, 4), (3, 6), (5, 10)]),
    st.sampled_from([1, 3]),
)
def test_it_is_the_sum_over_its_columns(points, radius, shape, threads):
    estimator = ColumnQuadrature(*shape)
    found = estimator.estimate(TerrainClearance(ROUGH, threads=threads), points, radius)
    one, other = plain_halves(ROUGH, points, radius, estimator)
    p = (0.5 * (one + other)).clip(0.0, 1.0)
    assert found.p == pytest.approx(p, abs=1e-13)
    depth = ((radius - TerrainClearance(ROUGH)(points)) / radius).clip(0.0, 2.0)
    error = 0.5 * np.abs(one - other) + 0.5 * estimator.columns()[:, 3].max() * depth
    assert found.low == pytest.approx((p - error).clip(0.0, 1.0), abs=1e-13)
    assert found.high == pytest.approx((p + error).clip(0.0, 1.0), abs=1e-13)


def test_at_posts_and_edges_of_cells_and_of_the_map():
    """Where a column stands on a post or an edge, whichever cell is taken."""
    x, y = np.meshgrid(np.arange(-3.0, 97.0, 3.0), np.arange(40.0, 85.0, 2.0))
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, 1.0)])
    estimator = ColumnQuadrature()
    for radius in (1e-9, 3.0, 6.0):
        found = estimator.estimate(TerrainClearance(ROUGH), points, radius)
        expected = plain_halves(ROUGH, points, radius, estimator).mean(axis=0).clip(0.0, 1.0)
        assert found.p == pytest.approx(expected, abs=1e-7 if radius < 1e-3 else 1e-12)


def test_out_of_reach_there_is_nothing_at_all():
    clearance = TerrainClearance(ROUGH)
    points = np.array([[40.0, 60.0, 14.0 + k] for k in range(40)])
    radius = 20.0
    found = ColumnQuadrature().estimate(clearance, points, radius)
    reached = clearance(points) < radius
    assert 3 < np.count_nonzero(reached) < 37
    assert not found.p[~reached].any()
    assert not found.high[~reached].any()
    assert (found.high[reached] > 0.0).all()


def test_what_it_takes_for_distances_is_the_surface_even_for_a_subclass():
    class Cautious(TerrainClearance):
        def __call__(self, points, **options):
            return super().__call__(points, **options) + 1000.0

    points = np.array([[40.0, 60.0, 2.0]])
    plain = ColumnQuadrature().estimate(TerrainClearance(ROUGH), points, 20.0)
    other = ColumnQuadrature().estimate(Cautious(ROUGH), points, 20.0)
    assert plain.p[0] > 0.1
    assert other.p == plain.p


def test_columns_are_shared_and_so_cannot_be_changed():
    columns = ColumnQuadrature().columns()
    assert columns is ColumnQuadrature().columns()
    with pytest.raises(ValueError, match="read-only"):
        columns[0] = 1.0


@pytest.mark.parametrize(
    ("points", "name"), [([[0.0, 0.0]], "shape"), ([[0, 0, np.nan]], "points")]
)
def test_points_that_are_none(points, name):
    with pytest.raises(ArgumentError, match=name):
        ColumnQuadrature().estimate(TerrainClearance(ROUGH), np.array(points), 1.0)


def test_arrays_of_any_layout_give_the_same():
    points = np.random.default_rng(1).uniform([0, 45, -5], [90, 80, 20], (200, 3))
    clearance = TerrainClearance(ROUGH)
    expected = ColumnQuadrature().estimate(clearance, points, 10.0).p
    for other in (np.asfortranarray(points), np.repeat(points, 2, axis=0)[::2]):
        assert np.array_equal(ColumnQuadrature().estimate(clearance, other, 10.0).p, expected)


def paths(n):
    rng = np.random.default_rng(4)
    return [
        Trajectory(
            np.arange(5.0), rng.uniform([0.0, 42.0, 0.0], [90.0, 80.0, 25.0], (5, 3)), f"T{k}"
        )
        for k in range(n)
    ]


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("grow", [False, True])
@pytest.mark.parametrize("n", [1, 4, 9])
def test_many_trajectories_get_the_profiles_of_each(threads, grow, n):
    clearance = TerrainClearance(ROUGH, radius=1.5, threads=threads)
    found = collision_probabilities(paths(n), clearance, 12.0, grow=grow, max_step=3.0)
    assert list(found) == [f"T{k}" for k in range(n)]
    for path in paths(n):
        one = collision_probability(path, clearance, 12.0, grow=grow, max_step=3.0)
        many = found[path.name]
        for name in ("t", "p", "low", "high"):
            assert np.array_equal(getattr(one, name), getattr(many, name))
        assert many.method == one.method
    assert clearance.threads == threads


def test_nobody_elses_code_runs_in_threads():
    seen = set()

    def spy(points):
        seen.add(threading.get_ident())
        return points[:, 2]

    found = collision_probabilities(paths(8), spy, 5.0, estimator=BallSampling(20, seed=1))
    assert seen == {threading.get_ident()}
    assert len(found) == 8


def test_one_generator_is_drawn_from_in_order():
    def drawn(of):
        rng = np.random.default_rng(7)
        return of(BallSampling(50, seed=rng))

    terrain = TerrainClearance(ROUGH, threads=3)
    many = drawn(lambda e: collision_probabilities(paths(8), terrain, 9.0, estimator=e))
    each = drawn(lambda e: [collision_probability(p, terrain, 9.0, estimator=e) for p in paths(8)])
    assert all(np.array_equal(m.p, one.p) for m, one in zip(many.values(), each, strict=True))


def test_what_is_no_list_of_trajectories():
    twice = [paths(1)[0], paths(1)[0]]
    with pytest.raises(ArgumentError, match="names that differ"):
        collision_probabilities(twice, ROUGH)
    with pytest.raises(ArgumentError, match="objects of class Trajectory"):
        collision_probabilities([1.0], ROUGH)
    with pytest.raises(ArgumentError, match="grow"):
        collision_probabilities(paths(2), ROUGH, grow=True)
    with pytest.raises(ArgumentError, match="radius"):
        collision_probabilities(paths(9), TerrainClearance(ROUGH, threads=2), -1.0)
    assert collision_probabilities([], ROUGH) == {}
    assert list(collision_probabilities(paths(1)[0], ROUGH)) == ["T0"]
