import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError, TerrainError, VoidError
from ompl_risk.terrains import fill_voids
from ompl_risk.terrains.voids import find_voids, settle_voids

J, I = np.mgrid[0:12, 0:15].astype(float)  # noqa: E741
PLANE = 3.0 * J - 2.0 * I + 100.0


def test_what_counts_as_void():
    raw = np.array([1.0, np.nan, np.inf, -np.inf, -9999.0, -32768.0, -32767.0, 3.4e38, 0.0])
    assert find_voids(raw).tolist() == [False] + 7 * [True] + [False]
    assert find_voids(np.array([0, -32768, -9998], np.int16)).tolist() == [False, True, False]


@given(st.integers(1, 6), st.integers(1, 8), st.integers(1, 4), st.integers(1, 5))
def test_a_hole_in_a_plane_is_filled_by_the_plane(row, column, height, width):
    holed = PLANE.copy()
    holed[row : row + height, column : column + width] = np.nan
    filled = fill_voids(holed)
    np.testing.assert_allclose(filled, PLANE, atol=1e-9)
    assert np.isnan(holed[row, column])  # the argument is left alone


def test_voids_that_touch_at_a_corner_are_one_hole():
    holed = PLANE.copy()
    holed[3:5, 4:6] = holed[5:7, 6:8] = np.nan
    np.testing.assert_allclose(fill_voids(holed), PLANE, atol=1e-9)


def test_holes_do_not_see_each_other():
    holed = np.zeros((5, 40))
    holed[:, 20:] = 100.0
    holed[0, 3] = holed[0, 36] = np.nan  # on the edge, outside the hull of their own rim
    filled = fill_voids(holed)
    assert (filled[0, 3], filled[0, 36]) == (0.0, 100.0)


@pytest.mark.parametrize("edge", [np.s_[:, :2], np.s_[-1:, :], np.s_[0, 0]])
def test_at_the_edge_the_nearest_known_post_counts(edge):
    rising = np.tile(np.arange(6.0) ** 2, (5, 1))
    holed = rising.copy()
    holed[edge] = np.nan
    filled = fill_voids(holed)
    known = np.argwhere(~np.isnan(holed))
    for j, i in np.argwhere(np.isnan(holed)):
        distance = ((known - (j, i)) ** 2).sum(axis=1)
        nearest = known[distance == distance.min()]
        assert filled[j, i] in holed[nearest[:, 0], nearest[:, 1]]


@given(st.integers(0, 2**32 - 1), st.floats(0.01, 0.9))
def test_filling_keeps_known_posts_and_stays_between_them(seed, share):
    rng = np.random.default_rng(seed)
    heights = rng.uniform(0.0, 1.0, (8, 9))
    holed = np.where(rng.uniform(size=heights.shape) < share, np.nan, heights)
    if np.isnan(holed).all():
        return
    filled = fill_voids(holed)
    known = ~np.isnan(holed)
    np.testing.assert_array_equal(filled[known], heights[known])
    assert np.nanmin(holed) - 1e-12 <= filled.min()
    assert filled.max() <= np.nanmax(holed) + 1e-12


def test_nothing_known_is_an_error():
    with pytest.raises(TerrainError, match="no post"):
        fill_voids(np.full((3, 3), np.nan))


def test_voids_are_reported_unless_filling_is_asked_for():
    voids = np.zeros((12, 15), bool)
    voids[4, 7] = voids[5, 2] = True
    with pytest.raises(VoidError, match="interpolate") as caught:
        settle_voids(PLANE, voids, None)
    assert (caught.value.count, caught.value.first) == (2, (4, 7))
    np.testing.assert_allclose(settle_voids(PLANE, voids, "interpolate"), PLANE)
    assert settle_voids(PLANE, np.zeros_like(voids), None) is PLANE
    with pytest.raises(ArgumentError, match="fill"):
        settle_voids(PLANE, voids, "zero")
