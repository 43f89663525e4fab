"""TerrainClearance against closed forms, a brute-force oracle and python-fcl."""

import math
import pickle

import fcl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain


def rough(shape, seed, *, scale=1.0, spacing=(1.0, 1.0), origin=(0.0, 0.0)):
    heights = np.random.default_rng(seed).normal(size=shape) * scale
    return Terrain(heights, spacing=spacing, origin=origin)


def triangles(terrain):
    """All triangles (n, 3, 3), written down anew from the rule: cells split from SW to NE."""
    (x0, y0), (dx, dy), h = terrain.origin, terrain.spacing, terrain.heights
    ny, nx = h.shape
    post = lambda i, j: (x0 + j * dx, y0 + i * dy, h[i, j])  # noqa: E731
    cells = [(i, j) for i in range(ny - 1) for j in range(nx - 1)]
    lower = [(post(i, j), post(i, j + 1), post(i + 1, j + 1)) for i, j in cells]
    upper = [(post(i, j), post(i + 1, j + 1), post(i + 1, j)) for i, j in cells]
    return np.array(lower + upper)


def brute_force(points, faces):
    """Unsigned distance to a triangle soup: the foot on each plane, or on each edge."""
    a, b, c = faces[:, 0], faces[:, 1], faces[:, 2]
    n = np.cross(b - a, c - a)
    nn = (n * n).sum(-1)
    out = []
    for p in points:
        plane = ((p - a) * n).sum(-1)
        foot = p - (plane / nn)[:, None] * n
        inside = np.ones(len(faces), bool)
        best = np.full(len(faces), np.inf)
        for s, e in ((a, b), (b, c), (c, a)):
            inside &= (np.cross(e - s, foot - s) * n).sum(-1) >= 0
            t = np.clip(((p - s) * (e - s)).sum(-1) / ((e - s) ** 2).sum(-1), 0, 1)
            best = np.minimum(best, np.linalg.norm(p - s - t[:, None] * (e - s), axis=-1))
        best[inside] = np.minimum(best[inside], np.abs(plane[inside]) / np.sqrt(nn[inside]))
        out.append(best.min())
    return np.array(out)


def queries(terrain, n, seed, low, high):
    rng = np.random.default_rng(seed)
    xmin, xmax, ymin, ymax = terrain.extent
    x, y = rng.uniform(xmin, xmax, n), rng.uniform(ymin, ymax, n)
    return np.column_stack([x, y, terrain.height(x, y) + rng.uniform(low, high, n)])


@pytest.mark.parametrize("shape", [(2, 2), (2, 9), (9, 2), (5, 5), (6, 11), (17, 33), (40, 37)])
@pytest.mark.parametrize("scale", [0.0, 0.1, 1.0, 20.0])
@pytest.mark.parametrize("above", [(0.0, 1.0), (1.0, 40.0), (-30.0, 0.0)])
def test_agrees_with_brute_force(shape, scale, above):
    terrain = rough(shape, 1, scale=scale, spacing=(1.0, 1.7), origin=(-3.0, 1e3))
    points = queries(terrain, 60, 2, *above)
    d = TerrainClearance(terrain)(points)
    assert np.abs(d) == pytest.approx(brute_force(points, triangles(terrain)), abs=1e-9)
    assert np.array_equal(d < 0, points[:, 2] < terrain.height(points[:, 0], points[:, 1]))


def test_agrees_with_brute_force_over_a_smooth_map_from_far_above():
    y, x = np.mgrid[0:70, 0:65]
    terrain = Terrain(8 * np.sin(x / 6) * np.cos(y / 9) + 0.3 * x, spacing=(1.0, 1.0))
    points = queries(terrain, 150, 5, 5.0, 300.0)
    d = TerrainClearance(terrain)(points)
    assert d == pytest.approx(brute_force(points, triangles(terrain)), abs=1e-9)


def test_agrees_with_fcl():
    terrain = rough((60, 80), 3, scale=15.0, spacing=(20.0, 30.0))
    surface = terrain.surface()
    model = fcl.BVHModel()
    model.beginModel(len(surface.vertices), len(surface.faces))
    model.addSubModel(np.asarray(surface.vertices), np.asarray(surface.faces))
    model.endModel()
    ground = fcl.CollisionObject(model, fcl.Transform())
    body = fcl.CollisionObject(fcl.Sphere(2.0), fcl.Transform())
    points = queries(terrain, 300, 4, 10.0, 200.0)
    expected = []
    for point in points:
        body.setTranslation(point)
        expected.append(fcl.distance(body, ground, fcl.DistanceRequest(), fcl.DistanceResult()))
    free = np.array(expected) > 0
    d = TerrainClearance(terrain, radius=2.0)(points)
    assert free.sum() > 250
    assert d[free] == pytest.approx(np.array(expected)[free], abs=1e-6)


def test_flat_and_inclined_planes_in_closed_form():
    y, x = np.mgrid[0:50, 0:60] * 2.0
    terrain = Terrain(0.5 * x - 0.25 * y + 7.0, spacing=(2.0, 2.0))
    points = np.random.default_rng(0).uniform((40, 40, 40), (70, 60, 50), (200, 3))
    height = points[:, 2] - (0.5 * points[:, 0] - 0.25 * points[:, 1] + 7.0)
    expected = height / math.sqrt(1 + 0.25 + 0.0625) - 3.0
    assert TerrainClearance(terrain, radius=3.0)(points) == pytest.approx(expected, abs=1e-9)


@given(
    seed=st.integers(0, 50),
    shift=st.tuples(*[st.floats(-5, 5)] * 3),
    start=st.tuples(st.floats(0, 30), st.floats(0, 20), st.floats(-10, 30)),
)
@settings(max_examples=150, deadline=None)
def test_is_1_lipschitz(seed, shift, start):
    terrain = rough((21, 31), seed, scale=3.0)
    a = np.array(start)
    b = np.clip(a + shift, (0, 0, -100), (30, 20, 100))
    d = TerrainClearance(terrain)([a, b])
    assert abs(d[0] - d[1]) <= np.linalg.norm(a - b) + 1e-9


@pytest.mark.parametrize("bound", [0.5, 3.0, 20.0])
def test_bound_caps_and_changes_nothing_else(bound):
    terrain = rough((64, 64), 6, scale=2.0)
    points = queries(terrain, 400, 7, -5.0, 40.0)
    clearance = TerrainClearance(terrain, radius=0.25)
    assert clearance(points, bound=bound) == pytest.approx(
        np.minimum(clearance(points), bound), abs=1e-12
    )


def test_outside_the_extent_is_never_free():
    clearance = TerrainClearance(rough((5, 5), 0))
    inside = [[0, 0, 9], [4, 4, 9], [0, 4, 9], [2, 0, 9]]
    outside = [[-1e-9, 0, 9], [0, 4.001, 9], [1e9, 2, 9], [2, -3, 9]]
    assert (clearance(inside) > 0).all()
    assert (clearance(outside) == -math.inf).all()
    assert np.isnan(clearance.nearest(outside)).all()


def test_gradient_is_the_direction_of_steepest_ascent():
    terrain = rough((30, 30), 8, scale=2.0)
    clearance = TerrainClearance(terrain, radius=0.5)
    points = queries(terrain, 200, 9, -3.0, 10.0)
    points = points[((points[:, :2] > 0.1) & (points[:, :2] < 28.9)).all(axis=1)]
    gradient = clearance.gradient(points)
    step = 1e-6
    numeric = np.column_stack(
        [
            (clearance(points + step * e) - clearance(points - step * e)) / (2 * step)
            for e in np.eye(3)
        ]
    )
    smooth = np.abs(np.linalg.norm(numeric, axis=1) - 1) < 1e-5  # elsewhere d has a kink
    assert smooth.mean() > 0.9
    assert gradient[smooth] == pytest.approx(numeric[smooth], abs=1e-4)
    assert np.linalg.norm(gradient, axis=1) == pytest.approx(1.0)


def test_gradient_on_the_surface_is_the_normal():
    _, x = np.mgrid[0:5, 0:5].astype(float)
    clearance = TerrainClearance(Terrain(x.copy(), spacing=(1.0, 1.0)))
    assert clearance.gradient([[1.5, 2.2, 1.5]])[0] == pytest.approx(
        np.array([-1, 0, 1]) / math.sqrt(2)
    )


def test_nearest_points_lie_on_the_surface_at_the_distance():
    terrain = rough((40, 40), 10, scale=4.0)
    points = queries(terrain, 100, 11, 0.0, 30.0)
    clearance = TerrainClearance(terrain)
    nearest = clearance.nearest(points)
    assert terrain.height(nearest[:, 0], nearest[:, 1]) == pytest.approx(nearest[:, 2], abs=1e-9)
    assert np.linalg.norm(points - nearest, axis=1) == pytest.approx(clearance(points), abs=1e-9)


def test_threads_and_radii_agree():
    terrain = rough((50, 50), 12, scale=2.0)
    points = queries(terrain, 20_000, 13, -2.0, 20.0)
    one, two = TerrainClearance(terrain, threads=1), TerrainClearance(terrain, threads=2)
    assert np.array_equal(one(points), two(points))
    assert np.array_equal(one.with_radius(1.0)(points), TerrainClearance(terrain, 1.0)(points))


@pytest.mark.parametrize(
    ("call", "names"),
    [
        (lambda c: c([[0.0, 0.0]]), "points.shape = (1, 2)"),
        (lambda c: c([0.0, 0.0, 1.0]), "points.shape = (3,)"),
        (lambda c: c([[0, 0, 1], [0, math.nan, 1]]), "points[1]"),
        (lambda c: c([[0, 0, math.inf]]), "points[0]"),
        (lambda c: c("here"), "points = 'here'"),
        (lambda c: c([[0, 0, 1]], bound=0.0), "bound = 0.0"),
        (lambda c: TerrainClearance(c.terrain, radius=-1.0), "radius = -1.0"),
        (lambda c: TerrainClearance(c.terrain, radius=math.nan), "radius = nan"),
        (lambda c: TerrainClearance(c.terrain, threads=0), "threads = 0"),
    ],
)
def test_bad_input_is_named(call, names):
    clearance = TerrainClearance(rough((3, 3), 0))
    with pytest.raises(ArgumentError) as error:
        call(clearance)
    assert names in str(error.value)


def test_survives_pickling():
    clearance = TerrainClearance(rough((9, 9), 1), radius=0.5)
    points = queries(clearance.terrain, 50, 2, 1, 9)
    assert np.array_equal(pickle.loads(pickle.dumps(clearance))(points), clearance(points))


def test_no_queries_give_no_distances():
    assert TerrainClearance(rough((3, 3), 0))(np.empty((0, 3))).shape == (0,)


@pytest.mark.parametrize("seed", range(20))
def test_the_corners_of_the_extent_are_inside_whatever_the_rounding(seed):
    rng = np.random.default_rng(seed)
    origin, spacing = rng.uniform(1e5, 6e6, 2).round(1), rng.uniform(1, 99, 2).round(1)
    terrain = Terrain(np.zeros((7, 11)), spacing=tuple(spacing), origin=tuple(origin))
    xmin, xmax, ymin, ymax = terrain.extent
    corners = [[x, y, 9.0] for x in (xmin, xmax) for y in (ymin, ymax)]
    assert TerrainClearance(terrain)(corners) == pytest.approx(9.0)


def test_agrees_with_brute_force_over_extreme_cliffs():
    """Slopes of 1e5: single precision anywhere in the bounds would show."""
    terrain = rough((40, 40), 21, scale=1e3, spacing=(0.01, 0.01))
    points = queries(terrain, 400, 22, -500.0, 500.0)
    expected = brute_force(points, triangles(terrain))
    d = np.abs(TerrainClearance(terrain)(points))
    assert d == pytest.approx(expected, abs=1e-7)


def test_another_radius_shares_the_search_structure():
    clearance = TerrainClearance(rough((9, 9), 1), radius=0.5)
    assert clearance.with_radius(2.0).field is clearance.field
    assert clearance.of_point().field is clearance.field


def test_what_is_no_terrain_is_named():
    with pytest.raises(ArgumentError, match="terrain = 'jacksboro'"):
        TerrainClearance("jacksboro")
