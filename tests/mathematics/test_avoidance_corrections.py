"""Integrands with slope and curvature against direct integration over curved ground."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from ompl_risk.avoidance import FlatCap, GaussianTail
from ompl_risk.avoidance.corrections import corrected_cap, corrected_tail, surface_curvature
from ompl_risk.errors import ArgumentError

R = 100.0


def ball_share(d, k1, k2):
    """Share of a ball below ``z = (k1 x^2 + k2 y^2) / 2``, its centre at (0, 0, d).

    In each direction ground of curvature k leaves the ball at the radius q^(1/2), up to which
    ``k q / 2 - d + (R^2 - q)^(1/2)`` is filled; that times the radius integrates by hand.
    """
    theta = np.arange(48) * (2 * math.pi / 48)
    k = k1 * np.cos(theta) ** 2 + k2 * np.sin(theta) ** 2
    a, b = R * R - d * d, 1 - d * k
    q = 2 * a / (b + np.sqrt(b * b + k * k * a))
    filled = k * q * q / 8 - d * q / 2 + (R**3 - (R * R - q) ** 1.5) / 3
    return float(2 * math.pi * filled.mean() / (4 / 3 * math.pi * R**3))


def test_the_share_of_a_ball_by_counting_points():
    points = np.random.default_rng(5).uniform(-R, R, (400_000, 3))
    points = points[(points**2).sum(axis=1) < R * R]
    ground = 0.5 * (4e-3 * points[:, 0] ** 2 - 1e-3 * points[:, 1] ** 2)
    share = (points[:, 2] + 30.0 < ground).mean()
    deviation = math.sqrt(share / len(points))
    assert ball_share(30.0, 4e-3, -1e-3) == pytest.approx(share, abs=4 * deviation)


@pytest.mark.parametrize("d", [10.0, 40.0, 70.0])
@pytest.mark.parametrize("ratio", [1.0, 0.4, -0.5])
def test_the_share_of_a_ball_over_a_paraboloid_to_first_order(d, ratio):
    """The difference to the formula shrinks with the square of the curvature."""
    errors = []
    for mean in (1e-4, 5e-5, 2.5e-5):
        k1, k2 = 2 * mean / (1 + ratio), 2 * mean * ratio / (1 + ratio)
        exact, flat = (ball_share(d, *k) for k in ((k1, k2), (0.0, 0.0)))
        corrected = corrected_cap(d, 1.0, mean, r=R) - FlatCap(R)(d)
        errors.append(abs(exact - flat - corrected) / corrected)
    assert errors[0] < 0.05
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.03)
    assert errors[2] / errors[1] == pytest.approx(0.5, abs=0.03)


def test_a_dome_takes_away_what_a_bowl_adds():
    more, less = (corrected_cap(30.0, 1.0, k, r=R) for k in (1e-3, -1e-3))
    assert more > FlatCap(R)(30.0) > less
    assert more + less == pytest.approx(2 * FlatCap(R)(30.0), rel=1e-12)


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.7, 0.0), (-0.3, 1.1)])
def test_mean_curvature_of_a_paraboloid_on_a_slope(slope):
    """Against the divergence of the unit normal, by differences."""
    c, h = 2e-3, 1e-3

    def normal(x, y):
        gx, gy = slope[0] + c * x, slope[1] + c * y  # z = slope . (x, y) + c (x^2 + y^2) / 2
        return np.array([gx, gy]) / math.sqrt(1 + gx * gx + gy * gy)

    divergence = (normal(h, 0)[0] - normal(-h, 0)[0] + normal(0, h)[1] - normal(0, -h)[1]) / (2 * h)
    up = 1 / math.sqrt(1 + slope[0] ** 2 + slope[1] ** 2)
    assert surface_curvature(up, c) == pytest.approx(0.5 * divergence, rel=1e-6)


def test_over_level_and_flat_ground_nothing_is_corrected():
    d = np.array([-1.0, 0.0, 1e-9, 5.0, 39.0, 41.0, 1e6])
    np.testing.assert_allclose(corrected_cap(d, 1.0, 0.0, r=40.0), FlatCap(40.0)(d), atol=1e-15)
    tail = corrected_tail(d, 1.0, 0.0, vertical=10.0)
    np.testing.assert_allclose(tail, GaussianTail(10.0)(d), atol=1e-15)
    tail = corrected_tail(d, 0.3, 0.0, vertical=0.0, isotropic=10.0)
    np.testing.assert_allclose(tail, GaussianTail(10.0)(d), atol=1e-15)


def test_a_vertical_error_counts_by_the_cosine_of_the_slope():
    """Over a plane: the height above it is d / up, and exceeds e as d exceeds e up."""
    rng = np.random.default_rng(3)
    slope, height, sigma = 0.8, 12.0, 9.0
    up = 1 / math.hypot(1.0, slope)
    e = rng.normal(0.0, sigma, 400_000)
    hits = (height - e <= 0.0).mean()
    found = corrected_tail(height * up, up, 0.0, vertical=sigma) + stats.norm.sf(4.0)
    assert found == pytest.approx(stats.norm.sf(height / sigma), rel=1e-12)
    assert found == pytest.approx(hits, abs=4 * math.sqrt(hits / len(e)))


@pytest.mark.parametrize("mean", [1e-3, -1e-3])
def test_position_errors_over_a_paraboloid_to_first_order_in_its_curvature(mean):
    """All three components of the error; the ground has curvatures 1.6 and 0.4 times the mean."""
    sigma, d = 10.0, 15.0
    nodes, weights = np.polynomial.hermite_e.hermegauss(40)
    weights = weights / weights.sum()
    u, v = sigma * nodes[:, None], sigma * nodes

    def exact(mean):
        gap = d - mean * (0.8 * u * u + 0.2 * v * v)  # the error along the normal, integrated
        return float(weights @ stats.norm.sf(gap / sigma) @ weights)

    change = exact(mean) - exact(0.0)
    tails = [corrected_tail(d, 1.0, k, vertical=0.0, isotropic=sigma) for k in (mean, 0.0)]
    assert tails[0] - tails[1] == pytest.approx(change, rel=0.02)
    map_s = mean / float(surface_curvature(0.6, 1.0))  # on a slope, of the same ground
    steep = corrected_tail(d, 0.6, map_s, vertical=0.0, isotropic=sigma)
    assert steep == pytest.approx(tails[0], rel=1e-12)


@given(st.floats(0.1, 99.0), st.floats(0.01, 10.0), st.floats(0.2, 1.0), st.floats(-5e-3, 5e-3))
def test_neither_increases_with_distance_where_the_curve_is_wide(d, step, up, curvature):
    near, far = np.array([d, d + step])
    for g in (
        lambda d: corrected_cap(d, up, curvature, r=R),
        lambda d: corrected_tail(d, up, curvature, vertical=20.0, isotropic=5.0),
    ):
        assert g(near) >= g(far) >= 0.0
        assert g(near) <= 1.0


def test_shapes_broadcast_and_collisions_are_infinite():
    d, up = np.array([[-1.0, 0.0, 20.0]]), np.array([[0.9], [0.5]])
    for f in (
        corrected_cap(d, up, 1e-3),
        corrected_tail(d, up, 1e-3, vertical=15.0, isotropic=2.0),
    ):
        assert f.shape == (2, 3)
        assert np.isinf(f[:, :2]).all()
        assert (f[:, 2] > 0).all()
    assert corrected_tail(5.0, 0.0, 0.0, vertical=9.0) == 0.0  # a wall: its height is no matter


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: corrected_cap(1.0, 1.0, 0.0, r=0.0), "r = 0.0"),
        (lambda: corrected_cap(math.nan, 1.0, 0.0), "d = nan"),
        (lambda: corrected_cap(1.0, [1.0, math.nan], 0.0), "up = nan"),
        (lambda: corrected_cap(1.0, 1.0, math.inf), "curvature = inf"),
        (lambda: corrected_tail(1.0, 1.0, 0.0, vertical=-1.0), "vertical = -1.0"),
        (lambda: corrected_tail(1.0, 1.0, 0.0, vertical=1.0, isotropic=math.inf), "isotropic"),
        (lambda: corrected_tail(1.0, 1.0, 0.0, vertical=0.0), "vertical"),
    ],
)
def test_bad_arguments_are_named(call, named):
    with pytest.raises(ArgumentError) as error:
        call()
    assert named in str(error.value)
