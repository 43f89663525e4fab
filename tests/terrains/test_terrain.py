import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError, ExtentError, TerrainError, VoidError
from ompl_risk.terrains import Terrain


def bumpy(shape=(7, 9), spacing=(20.0, 30.0), origin=(-100.0, 4_050_000.0), seed=1):
    heights = np.random.default_rng(seed).uniform(0.0, 100.0, shape)
    return Terrain(heights, spacing=spacing, origin=origin)


TERRAIN = bumpy()
inside = st.floats(0.0, 1.0)


def by_mesh(terrain, x, y):
    """Height by the plane through the triangle of `surface()` below (x, y): no shared code."""
    corners = terrain.surface().triangles
    for a, b, c in corners:
        sides = np.column_stack([b[:2] - a[:2], c[:2] - a[:2]])
        s, t = np.linalg.solve(sides, np.array([x, y]) - a[:2])
        if s >= -1e-9 and t >= -1e-9 and s + t <= 1 + 1e-9:
            return a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2])
    raise LookupError


def test_the_posts_themselves_are_met_exactly():
    terrain = bumpy(spacing=(16.0, 32.0), origin=(0.0, 64.0))  # positions without rounding
    x, y = np.meshgrid(16.0 * np.arange(9), 64.0 + 32.0 * np.arange(7))
    np.testing.assert_array_equal(terrain.height(x, y), terrain.heights)


def test_row_0_is_south_and_the_diagonal_runs_from_south_west_to_north_east():
    # south-west 0, south-east 1, north-west 10, north-east 3
    cell = Terrain([[0.0, 1.0], [10.0, 3.0]], spacing=(1.0, 1.0))
    assert cell.height(0.5, 0.5) == 1.5  # the diagonal SW-NE; the other one would give 5.5
    assert cell.height(0.75, 0.25) == pytest.approx(0.25 * 0 + 0.5 * 1 + 0.25 * 3)
    assert cell.height(0.25, 0.75) == pytest.approx(0.25 * 0 + 0.5 * 10 + 0.25 * 3)


@given(u=inside, v=inside)
def test_height_is_that_of_the_mesh(u, v):
    xmin, xmax, ymin, ymax = TERRAIN.extent
    x, y = xmin + u * (xmax - xmin), ymin + v * (ymax - ymin)
    x, y = min(x, xmax), min(y, ymax)
    assert TERRAIN.height(x, y) == pytest.approx(by_mesh(TERRAIN, x, y), abs=1e-6)


@given(
    a=st.floats(-3.0, 3.0), b=st.floats(-3.0, 3.0), c=st.floats(-500.0, 500.0), u=inside, v=inside
)
def test_a_plane_is_a_plane(a, b, c, u, v):
    x, y = 15.0 * np.arange(5), 40.0 * np.arange(4)[:, None]
    plane = Terrain(a * x + b * y + c, spacing=(15.0, 40.0))
    at = u * 60.0, v * 120.0
    assert plane.height(*at) == pytest.approx(a * at[0] + b * at[1] + c, abs=1e-9)


def test_height_broadcasts_and_a_pair_of_numbers_gives_a_number():
    xmin, xmax, ymin, ymax = TERRAIN.extent
    x, y = np.linspace(xmin, xmax, 5), np.linspace(ymin, ymax, 4)
    grid = TERRAIN.height(x, y[:, None])
    assert grid.shape == (4, 5)
    assert type(TERRAIN.height(x[2], y[3])) is float
    assert grid[3, 2] == TERRAIN.height(x[2], y[3])
    strided = np.asfortranarray(np.broadcast_to(x, (4, 5)))
    np.testing.assert_array_equal(TERRAIN.height(strided, y[:, None]), grid)
    assert TERRAIN.height([], []).shape == (0,)


def test_a_query_outside_says_how_many_and_where():
    with pytest.raises(ExtentError) as caught:
        TERRAIN.height([0.0, 61.0, 0.0], [4_050_010.0, 4_050_010.0, 4_049_999.0])
    assert caught.value.count == 2
    assert caught.value.first == (61.0, 4_050_010.0)
    assert caught.value.extent == TERRAIN.extent == (-100.0, 60.0, 4_050_000.0, 4_050_180.0)


@pytest.mark.parametrize(
    ("x", "y", "argument"),
    [(np.nan, 4_050_000.0, "x"), (0.0, np.inf, "y"), ([0.0, np.nan], 0.0, "x")],
)
def test_a_query_that_is_not_finite_is_refused(x, y, argument):
    with pytest.raises(ArgumentError) as caught:
        TERRAIN.height(x, y)
    assert caught.value.argument == argument


def test_queries_must_broadcast():
    with pytest.raises(ArgumentError, match="broadcast"):
        TERRAIN.height([0.0, 1.0], [0.0, 1.0, 2.0])


def test_heights_are_shared_but_read_only_and_stay_so_in_another_process():
    mine = np.zeros((3, 4))
    terrain = Terrain(mine, spacing=(1.0, 1.0))
    assert np.shares_memory(terrain.heights, mine)
    assert mine.flags.writeable
    for one in (terrain, pickle.loads(pickle.dumps(terrain))):
        assert not one.heights.flags.writeable
        assert one.heights.flags.c_contiguous
        assert one.heights.dtype == np.float64
    with pytest.raises(AttributeError):
        terrain.spacing = (2.0, 2.0)


@pytest.mark.parametrize(
    "heights", [np.zeros((3, 4), np.int16), np.zeros((4, 3)).T, np.zeros((6, 8))[::2, ::2]]
)
def test_any_real_array_becomes_contiguous_float64(heights):
    terrain = Terrain(heights, spacing=(1.0, 1.0))
    assert terrain.shape == (3, 4)
    assert terrain.heights.flags.c_contiguous
    assert terrain.heights.dtype == np.float64


@pytest.mark.parametrize(
    ("heights", "message"),
    [
        ([[1.0, 2.0]], r"\(1, 2\).*2 x 2"),
        ([1.0, 2.0], r"\(2,\).*2 x 2"),
        (np.zeros((2, 2, 2)), "2 x 2"),
        ([[0.0, 1.0], [2.0, np.nan]], "1 heights are not finite.*row 1, column 1"),
        ([[0.0, -np.inf], [np.inf, np.nan]], "3 heights are not finite.*row 0, column 1"),
        ([[1j, 0], [0, 0]], "complex"),
        ([["a", "b"], ["c", "d"]], "type"),
        ([[True, False], [True, True]], "bool"),
    ],
)
def test_heights_that_cannot_serve_are_refused(heights, message):
    with pytest.raises(TerrainError, match=message):
        Terrain(heights, spacing=(1.0, 1.0))


def test_finite_heights_whose_sum_overflows_are_finite():
    assert Terrain(np.full((2, 2), 1e308), spacing=(1.0, 1.0)).shape == (2, 2)


def test_a_masked_post_is_a_void():
    heights = np.ma.masked_equal([[1.0, 2.0], [-1.0, 3.0]], -1.0)
    with pytest.raises(VoidError) as caught:
        Terrain(heights, spacing=(1.0, 1.0))
    assert (caught.value.count, caught.value.first) == (1, (1, 0))
    assert Terrain(np.ma.masked_array(np.ones((2, 2))), spacing=(1.0, 1.0)).heights.sum() == 4


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"spacing": (0.0, 1.0)}, "spacing[0]"),
        ({"spacing": (1.0, -1.0)}, "spacing[1]"),
        ({"spacing": (np.nan, 1.0)}, "spacing[0]"),
        ({"spacing": 30.0}, "spacing"),
        ({"spacing": (1.0, 1.0, 1.0)}, "spacing"),
        ({"spacing": "30"}, "spacing"),
        ({"spacing": (1.0, 1.0), "origin": (np.inf, 0.0)}, "origin[0]"),
        ({"spacing": (1.0, 1.0), "origin": (0.0, "a")}, "origin[1]"),
        ({"spacing": (1.0, 1.0), "scale_error": -0.1}, "scale_error"),
    ],
)
def test_bad_arguments_are_named(arguments, named):
    with pytest.raises(ArgumentError) as caught:
        Terrain(np.zeros((2, 2)), **arguments)
    assert caught.value.argument == named


def test_a_window_covers_its_bounds_and_leaves_every_height_where_it_was():
    part = TERRAIN.window((-75.0, 4_050_031.0, 19.0, 4_050_119.0))
    assert part.extent == (-80.0, 20.0, 4_050_030.0, 4_050_120.0)
    assert part.spacing == TERRAIN.spacing
    x, y = np.random.default_rng(0).uniform((-80, 4_050_030), (20, 4_050_120), (200, 2)).T
    np.testing.assert_allclose(part.height(x, y), TERRAIN.height(x, y), atol=1e-9)


def test_a_window_on_posts_takes_no_more_than_those_and_the_whole_is_the_whole():
    xmin, xmax, ymin, ymax = TERRAIN.extent
    assert TERRAIN.window((xmin, ymin, xmax, ymax)).shape == TERRAIN.shape
    assert TERRAIN.window((-80.0, 4_050_030.0, -60.0, 4_050_060.0)).shape == (2, 2)
    tenths = Terrain(np.zeros((50, 50)), spacing=(0.1, 0.1))
    assert tenths.window((0.3, 0.3, 0.7, 0.7)).shape == (5, 5)  # 0.1 * 3 is not 0.3


@given(st.tuples(inside, inside, inside, inside))
def test_every_window_is_the_smallest_that_covers(parts):
    xmin, xmax, ymin, ymax = TERRAIN.extent
    (u0, u1), (v0, v1) = sorted(parts[:2]), sorted(parts[2:])
    bounds = (
        xmin + u0 * (xmax - xmin), ymin + v0 * (ymax - ymin),
        min(xmin + u1 * (xmax - xmin), xmax), min(ymin + v1 * (ymax - ymin), ymax),
    )  # fmt: skip
    if not (bounds[0] < bounds[2] and bounds[1] < bounds[3]):
        return
    got = TERRAIN.window(bounds)
    west, east, south, north = got.extent
    tiny = 1e-4
    assert west - tiny <= bounds[0] < bounds[2] <= east + tiny
    assert south - tiny <= bounds[1] < bounds[3] <= north + tiny
    (ny, nx), (dx, dy) = got.shape, TERRAIN.spacing
    if nx > 2:
        assert west + dx > bounds[0] - tiny
        assert east - dx < bounds[2] + tiny
    if ny > 2:
        assert south + dy > bounds[1] - tiny
        assert north - dy < bounds[3] + tiny


@pytest.mark.parametrize(
    "bounds",
    [
        (-120.0, 4_050_000.0, 0.0, 4_050_030.0),  # leaves in the west
        (-100.0, 4_050_000.0, 0.0, 4_050_200.0),  # leaves in the north
        (0.0, 4_050_030.0, -20.0, 4_050_060.0),  # turned round
        (0.0, 4_050_030.0, 0.0, 4_050_060.0),  # empty
        (np.nan, 4_050_030.0, 0.0, 4_050_060.0),
        (0.0, 1.0),
    ],
)
def test_bounds_that_leave_or_are_empty_are_refused(bounds):
    with pytest.raises(ArgumentError, match="bounds"):
        TERRAIN.window(bounds)


def test_the_repr_says_what_one_wants_to_know():
    text = repr(Terrain([[1.0, 2.0], [3.0, 4.5]], spacing=(30.0, 20.0), crs="EPSG:32616", name="n"))
    for part in ("'n'", "2 x 2", "30 x 20 m", "z 1 to 4.5 m", "EPSG:32616"):
        assert part in text
