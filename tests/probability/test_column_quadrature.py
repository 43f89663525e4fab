"""The quadrature's kernel against the same sum in plain numpy, and what it leaves out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.probability import ColumnQuadrature
from ompl_risk.terrains import Terrain

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
