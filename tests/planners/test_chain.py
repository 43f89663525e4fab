"""The function that refinement minimises: value, gradient, second derivatives, and the solver."""

import math

import numpy as np
import pytest
from flown_paths import hills
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk._kernels import chain as curvatures
from ompl_risk._kernels import refine as kernels
from ompl_risk.avoidance import FlatCap, GaussianTail, InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.improve.chain import Chain, Surroundings
from ompl_risk.planners.improve.fields import SampledField, TerrainField, clearance_field
from ompl_risk.terrains import Terrain

NORMS = [Sobolev(1), Sobolev(1, time_scale=3.0), Lp(1), Lp(1.5), Lp(2), Lp(5)]
D0, SPEED = 80.0, 9.0


BALL = np.array([0.0, 0.0, -10.0])


def ball(points):
    """Distance from a ball of 30 m: smooth wherever paths here go."""
    return np.linalg.norm(points - BALL, axis=1) - 30.0


def chain(field, corners, norm, *, counts=None, gate=None, margin=0.0, weight=0.3, f=None):
    counts = np.full(len(corners) - 1, 7) if counts is None else counts
    around = Surroundings(
        field,
        gate,
        margin,
        InverseDistance(D0) if f is None else f,
        SPEED,
        getattr(norm, "time_scale", 0.0),
    )
    durations = np.linalg.norm(np.diff(corners, axis=0), axis=1) / SPEED
    return Chain(
        around,
        exponent=norm.exponent,
        scale=0.01,
        weight=weight,
        counts=counts,
        durations=durations,
    )


def arch(n=9, height=40.0):
    """A path over the ball, partly in the field of risk and partly out of it."""
    angle = np.linspace(0.15, math.pi - 0.15, n)
    rng = np.random.default_rng(n)
    along = np.column_stack([-150 * np.cos(angle), 9 * np.sin(3 * angle), height * np.sin(angle)])
    return along + rng.normal(0, 1.0, (n, 3))


def differences(function, corners, h=1e-5):
    """Gradient of a function of a path, by central differences."""
    gradient = np.empty_like(corners)
    for index in np.ndindex(*corners.shape):
        ahead, behind = corners.copy(), corners.copy()
        ahead[index] += h
        behind[index] -= h
        gradient[index] = (function(ahead) - function(behind)) / (2 * h)
    return gradient


class Steep(InverseDistance):
    """Another f than the compiled one."""

    def __call__(self, d):
        return super().__call__(d) * 2.0

    def derivative(self, d):
        return super().derivative(d) * 2.0


OTHERS = {"another f": Steep(D0), "cap": FlatCap(D0), "tail": GaussianTail(D0 / 4)}


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
@pytest.mark.parametrize(
    "case", ["plain", "repelled", "own gate", "deep", "uneven", "another f", "cap", "tail"]
)
def test_the_gradient_is_that_of_central_differences(norm, case):
    field = SampledField(ball, lambda p: (p - BALL) / (ball(p) + 30)[:, None], 1e-4)
    corners, options = arch(), {}
    if case == "repelled":
        options["margin"] = ball(corners).min() - 1.0  # the buffer is 1.6 m deep
    if case == "own gate":
        options["gate"] = SampledField(
            lambda p: ball(p) - ball(corners).min() + 1.0,
            lambda p: (p - BALL) / (ball(p) + 30)[:, None],
            1e-4,
        )
    if case == "deep":
        corners = arch(height=14.0)  # below LOWEST, where f goes on straight
    if case == "uneven":
        options["counts"] = np.array([2, 9, 3, 5, 4, 2, 7, 3])
    if case in OTHERS:
        options["f"] = OTHERS[case]
    model = chain(field, corners, norm, **options)
    point = model.at(corners)
    numerical = differences(lambda x: model.at(x).cost, corners)
    np.testing.assert_allclose(
        point.by_corners, numerical, rtol=2e-5, atol=2e-6 * np.abs(numerical).max()
    )
    longer = differences(lambda x: model.at(x).duration, corners)
    np.testing.assert_allclose(point.longer, longer, atol=1e-8)
    if case == "deep":
        assert ball(corners).min() < 0.02 * D0
    if case in ("repelled", "own gate"):
        assert point.repelled is not None


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
def test_over_terrain_the_gradient_is_that_of_differences_away_from_kinks(norm):
    """Over a roof d is smooth: it is convex, so every point above has one nearest point."""
    x = np.arange(0.0, 401.0, 20.0)
    roof = Terrain(-0.4 * np.abs(x - 200.0) * np.ones((21, 1)), spacing=(20.0, 20.0))
    clearance = TerrainClearance(roof, radius=2.0, threads=1)
    rng = np.random.default_rng(0)
    corners = np.column_stack(
        [np.linspace(60, 340, 8), 200 + rng.normal(0, 20, 8), 30 + rng.normal(0, 5, 8)]
    )
    model = chain(TerrainField(clearance), corners, norm)
    point = model.at(corners)
    numerical = differences(lambda c: model.at(c).cost, corners, 1e-4)
    np.testing.assert_allclose(
        point.by_corners, numerical, rtol=1e-4, atol=1e-5 * np.abs(numerical).max()
    )


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
def test_the_value_converges_to_the_norm(norm):
    corners = arch()
    legs = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    reached = np.concatenate([[0], np.cumsum(legs)])
    t = np.interp(np.arange(8 * 4000 + 1) / 4000, np.arange(9), reached) / SPEED
    points = np.column_stack([np.interp(t * SPEED, reached, corners[:, k]) for k in range(3)])
    exact = norm.power(t, np.maximum(1 / ball(points) - 1 / D0, 0.0) / 0.01)
    field = SampledField(ball, None, 1e-4)
    errors = [
        abs(chain(field, corners, norm, counts=np.full(8, m), weight=0.0).at(corners).cost - exact)
        for m in (20, 80, 320)
    ]
    assert errors[0] < 0.05 * exact
    assert errors[2] < 1e-3 * exact
    assert errors[2] < errors[0] / 4


def dense_matrix(diagonal, coupling):
    n = len(diagonal)
    matrix = np.zeros((3 * n, 3 * n))
    for e in range(n):
        matrix[3 * e : 3 * e + 3, 3 * e : 3 * e + 3] = diagonal[e]
    for e in range(n - 1):
        matrix[3 * e + 3 : 3 * e + 6, 3 * e : 3 * e + 3] = coupling[e]
        matrix[3 * e : 3 * e + 3, 3 * e + 3 : 3 * e + 6] = coupling[e].T
    return matrix


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
def test_second_derivatives_are_exact_where_f_is_linear_in_the_corners(norm):
    """f = f0 + slope n.x at each sample, durations held: Gauss and Newton leave nothing out."""
    rng = np.random.default_rng(3)
    n, counts = 5, np.array([3, 1, 4, 2])
    samples = counts.sum() + 1
    normals = rng.normal(0, 1, (samples, 3))
    slope, start = -rng.uniform(0.05, 0.1, samples), rng.uniform(1.0, 2.0, samples)
    durations, p, tau = rng.uniform(1, 3, n - 1), norm.exponent, getattr(norm, "time_scale", 0.0)
    place = np.empty((samples, 3))

    def f_of(corners):
        kernels.place_samples(corners, counts, place)
        return start + slope * np.einsum("ij,ij->i", normals, place)

    def gradient(flat):
        corners = flat.reshape(n, 3)
        by_f, by_leg, out = np.empty(samples), np.empty(n - 1), np.zeros((n, 3))
        kernels.path_risk(f_of(corners), counts, durations, p, tau, by_f, by_leg)
        kernels.spread(counts, by_f * slope, normals, out)
        return out.ravel()

    at, h = rng.normal(0, 0.3, 3 * n), 1e-6
    numerical = np.array(
        [(gradient(at + h * e) - gradient(at - h * e)) / (2 * h) for e in np.eye(3 * n)]
    )
    diagonal, coupling = np.zeros((n, 3, 3)), np.zeros((n - 1, 3, 3))
    f = f_of(at.reshape(n, 3))
    curvatures.couple(f, slope, counts, durations, p, tau, normals, diagonal, coupling)
    np.testing.assert_allclose(dense_matrix(diagonal, coupling), numerical, atol=1e-6)


def test_stiffening_adds_the_second_derivative_of_springs():
    rng = np.random.default_rng(4)
    counts = np.array([2, 3, 1])
    normals, stiffness = rng.normal(0, 1, (7, 3)), rng.uniform(0, 1, 7)
    diagonal, coupling = np.zeros((4, 3, 3)), np.zeros((3, 3, 3))
    curvatures.stiffen(counts, stiffness, normals, diagonal, coupling)
    place, springs = np.empty((7, 3)), []
    for unit in np.eye(12):
        kernels.place_samples(unit.reshape(4, 3), counts, place)
        springs.append(np.einsum("ij,ij->i", normals, place))
    stretch = np.array(springs)
    np.testing.assert_allclose(
        dense_matrix(diagonal, coupling), (stretch * stiffness) @ stretch.T, atol=1e-12
    )


@settings(deadline=None)
@given(st.integers(0, 10_000), st.integers(3, 12))
def test_the_chain_is_solved_as_a_dense_matrix_is(seed, n):
    rng = np.random.default_rng(seed)
    lower = rng.normal(0, 1, (3 * n, 3 * n))
    block = np.add.outer(np.arange(3 * n) // 3, -(np.arange(3 * n) // 3))
    lower = np.where((block == 0) | (block == 1), np.tril(lower), 0.0)
    matrix = lower @ lower.T + 0.1 * np.eye(3 * n)
    diagonal = np.array([matrix[3 * e : 3 * e + 3, 3 * e : 3 * e + 3] for e in range(n)])
    coupling = np.array([matrix[3 * e + 3 : 3 * e + 6, 3 * e : 3 * e + 3] for e in range(n - 1)])
    right, fixed = rng.normal(0, 1, (2, n, 3)), rng.random((n, 3)) < 0.3
    out = np.empty_like(right)
    assert curvatures.solve_chain(diagonal, coupling, fixed, right, out)
    held = fixed.copy()
    held[[0, -1]] = True
    free = np.flatnonzero(~held.ravel())
    expected = np.zeros((2, 3 * n))
    expected[:, free] = np.linalg.solve(
        matrix[np.ix_(free, free)], right.reshape(2, -1)[:, free].T
    ).T
    np.testing.assert_allclose(out.reshape(2, -1), expected, rtol=1e-6, atol=1e-8)
    if len(free):
        diagonal[free[0] // 3] -= 1e3 * np.eye(3)
        assert not curvatures.solve_chain(diagonal, coupling, fixed, right, out)


def test_a_terrain_field_is_the_clearance_and_its_gradient():
    clearance = TerrainClearance(hills(5), radius=3.0, threads=1)
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.uniform(0, 800, (400, 2)), rng.uniform(-20, 160, 400)])
    d, normals = TerrainField(clearance)(points, math.inf)
    np.testing.assert_allclose(d, clearance(points), atol=1e-9)
    np.testing.assert_allclose(normals, clearance.gradient(points), atol=1e-6)
    assert (d < -3.0).any()
    near, some = TerrainField(clearance)(points, 20.0)
    np.testing.assert_allclose(near, np.minimum(d, 20.0), atol=1e-9)
    assert (some[d > 20.0] == 0.0).all()
    np.testing.assert_allclose(some[d < 20.0], normals[d < 20.0], atol=1e-6)
    outside, none = TerrainField(clearance)(np.array([[-1.0, 5.0, 99.0]]), 20.0)
    assert outside[0] == -math.inf
    assert (none == 0.0).all()


def test_samples_between_corners_on_the_edge_of_the_map_lie_on_it():
    counts, out = np.array([7]), np.empty((8, 3))
    edge = 7499.999999999999
    kernels.place_samples(np.array([[edge, 0, 1], [edge, 9, 1.0]]), counts, out)
    assert (out[:, 0] == edge).all()


def test_numerical_gradients_agree_and_subclasses_are_not_bypassed():
    points = np.random.default_rng(6).normal(0, 60, (50, 3)) - 12 * BALL
    d, slopes = SampledField(ball, None, 1e-3)(points, math.inf)
    np.testing.assert_allclose(d, ball(points))
    np.testing.assert_allclose(slopes, (points - BALL) / (d + 30)[:, None], atol=1e-6)

    class WithTower(TerrainClearance):
        def __call__(self, points, **options):
            tower = np.hypot(points[:, 0] - 200, points[:, 1] - 200) - 20
            return np.minimum(super().__call__(points, **options), tower)

    tower = WithTower(hills(1), threads=1)
    field = clearance_field(tower, gradient=None, step=1e-3)
    d, slopes = field(np.array([[230.0, 200.0, 300.0]]), 50.0)
    assert d[0] == pytest.approx(10.0)
    np.testing.assert_allclose(slopes, [[1, 0, 0]], atol=1e-6)
    assert isinstance(
        clearance_field(TerrainClearance(hills(1)), gradient=None, step=1.0), TerrainField
    )
