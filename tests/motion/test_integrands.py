"""Avoidance functions in compiled code: against definitions, dense sampling and brute force."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk._kernels import integrand, motions
from ompl_risk.avoidance import (
    Avoidance,
    FlatCap,
    GaussianTail,
    InverseDistance,
    checked_distance,
)
from ompl_risk.avoidance.compiled import compiled_form
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, SampledBatch, TerrainBatch, TerrainMotion, motion_batch
from ompl_risk.motion.terrain import kernel_parameters
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain

SPEED = 20.0
FUNCTIONS = [
    InverseDistance(30.0),
    FlatCap(30.0),
    GaussianTail(7.5),
    GaussianTail(3.0, d0=20.0),
    GaussianTail(30.0, d0=30.0),
]
NEW = FUNCTIONS[1:]
NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]

functions = pytest.mark.parametrize("f", FUNCTIONS, ids=repr)
new_functions = pytest.mark.parametrize("f", NEW, ids=repr)
norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
batches = pytest.mark.parametrize("kind", [TerrainBatch, SampledBatch], ids=["terrain", "sampled"])


@dataclass(frozen=True)
class Ramp(Avoidance):
    """Of the user's own: compiled code does not know it."""

    d0: float = 30.0

    def __call__(self, d):
        d = checked_distance(d)
        return np.where(d <= 0, np.inf, np.maximum(1.0 - d / self.d0, 0.0))

    def derivative(self, d):
        d = checked_distance(d)
        return np.where(d <= 0, -np.inf, np.where(d < self.d0, -1.0 / self.d0, 0.0))


@pytest.fixture(scope="module")
def clearance():
    y, x = np.mgrid[0:40, 0:40] / 40
    heights = 20 * np.sin(7 * x) * np.cos(9 * y) + 8 * np.sin(23 * x + 17 * y)
    return TerrainClearance(Terrain(heights, spacing=(10.0, 10.0)), radius=2.0, threads=1)


@pytest.fixture(scope="module")
def dense(clearance):
    """Motions, and the clearances at 8,001 places along each."""
    a, b = some_motions(clearance, 40)
    s = np.linspace(0, 1, 8001)[:, None]
    return a, b, np.array([clearance(p + s * (q - p)) for p, q in zip(a, b, strict=True)])


def some_motions(clearance, n, seed=0, low=3.0, high=50.0, length=150.0):
    rng = np.random.default_rng(seed)
    xmin, xmax, ymin, ymax = clearance.terrain.extent
    a, b = np.empty((2, n, 3))
    a[:, :2] = rng.uniform((xmin, ymin), (xmax, ymax), (n, 2))
    b[:, :2] = np.clip(a[:, :2] + rng.normal(0, length, (n, 2)), (xmin, ymin), (xmax, ymax))
    for ends in (a, b):
        ends[:, 2] = clearance.terrain.height(*ends[:, :2].T) + rng.uniform(low, high, n)
    return a, b


def risk_of(f, norm=None, **options):
    return Risk(f, norm or Sobolev(1), **{"speed": SPEED, "duration_weight": 0.0, **options})


def numbers(f):
    form = compiled_form(f)
    assert form is not None
    return form


def bounds(length, d_a, d_b, risk):
    """Lower bounds from the lengths of ways and the clearances at their ends alone."""
    d_a, d_b, length = (np.array(x, dtype=float) for x in np.broadcast_arrays(d_a, d_b, length))
    a, out = np.zeros((len(length), 3)), np.empty(len(length))
    b = a.copy()
    b[:, 0] = length
    motions.heuristics(a, b, d_a, d_b, kernel_parameters(0.0, risk), out)
    return out


# values and derivatives


@functions
def test_kernels_compute_the_function(f):
    d = np.concatenate([np.geomspace(1e-4, 1.0, 200), f.d0 * np.linspace(1e-3, 1.2, 500)])
    d = np.append(d, [f.d0, np.nextafter(f.d0, 0), math.inf])
    out = np.empty(len(d))
    integrand.values(d, numbers(f), out)
    np.testing.assert_allclose(out, f(d), rtol=1e-13, atol=1e-16)


@functions
def test_kernels_compute_its_derivatives_and_go_on_along_the_tangent(f):
    low, scale = 0.02 * f.d0, 0.7
    d = f.d0 * np.array([-3.0, 0.0, 0.01, 0.0201, 0.1, 0.4, 0.9, 0.999, 1.001, 3.0])
    value, slope, bend = np.empty((3, len(d)))
    integrand.tangents(d, numbers(f), low, scale, value, slope, bend)
    above = d > low
    np.testing.assert_allclose(value[above], f(d[above]) / scale, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(slope[above], f.derivative(d[above]) / scale, rtol=1e-12)
    h = 1e-5 * d[above]
    second = (f.derivative(d[above] + h) - f.derivative(d[above] - h)) / (2 * h * scale)
    np.testing.assert_allclose(bend[above], second, rtol=1e-6, atol=1e-12 / f.d0)
    tangent = (f(low) + f.derivative(low) * (d[~above] - low)) / scale
    np.testing.assert_allclose(value[~above], tangent, rtol=1e-12)
    np.testing.assert_allclose(slope[~above], f.derivative(low) / scale, rtol=1e-12)
    assert (bend[~above] == 0.0).all()


# costs


@functions
@norms
@batches
def test_costs_are_the_powers_of_the_norm_of_densely_sampled_f(kind, f, norm, clearance, dense):
    risk = risk_of(f, norm)
    a, b, d = dense
    costs, t = kind(clearance, risk).costs(a, b), np.linalg.norm(b - a, axis=1) / SPEED
    free = d.min(axis=1) > 0.2
    assert np.isfinite(costs[free]).all()
    assert np.isinf(costs[d.min(axis=1) <= 0.0]).all()
    expected = np.array(
        [norm.power(np.linspace(0, t[k], d.shape[1]), f(d[k])) for k in np.flatnonzero(free)]
    )
    small = risk.negligible * t[free]
    if risk.time_scale:  # what dipping just below d0 costs
        small = small + 1e-2 * (risk.time_scale * SPEED * f.derivative(f.d0 - 1e-9)) ** 2
    assert (np.abs(costs[free] - expected) <= 1e-2 * expected + small).all()
    assert (expected > 100 * risk.negligible).sum() > 10


@functions
def test_level_flight_over_flat_ground_in_closed_form(f):
    flat = TerrainClearance(Terrain(np.zeros((9, 9)), spacing=(50.0, 50.0)))
    a, b = np.array([[10.0, 10.0, 9.0]]), np.array([[310.0, 210.0, 9.0]])
    seconds, value = math.hypot(300, 200) / SPEED, float(f(9.0))
    for p in (1.0, 2.0, 3.5):
        costs = TerrainBatch(flat, risk_of(f, Lp(p), duration_weight=0.5)).costs(a, b)
        assert costs[0] == pytest.approx((value**p + 0.5) * seconds, rel=1e-12)
    assert TerrainBatch(flat, risk_of(f, Lp(math.inf))).costs(a, b)[0] == pytest.approx(value)


def test_descent_in_closed_form():
    """From r to the ground f is a polynomial, and so are its square and that of its derivative."""
    flat, r, tau = TerrainClearance(Terrain(np.zeros((9, 9)), spacing=(50.0, 50.0))), 30.0, 2.0
    a, b = np.array([[100.0, 100.0, r]]), np.array([[100.0, 100.0, 0.1 * r]])
    f = np.polynomial.Polynomial([2, -3, 0, 1]) / 4
    square, steep = ((g * g).integ() for g in (f, f.deriv()))
    expected = (square(1) - square(0.1)) * r / SPEED
    expected += tau**2 * (steep(1) - steep(0.1)) * SPEED / r
    risk = risk_of(FlatCap(r), Sobolev(1, time_scale=tau), tolerance=1e-4)
    assert TerrainBatch(flat, risk).costs(a, b)[0] == pytest.approx(expected, rel=1e-4)


@batches
@pytest.mark.parametrize("end", [27.0, 29.0])
def test_the_jump_of_the_derivative_at_d0_is_found_wherever_it_lies(kind, end):
    """The H1 risk of descents to just below d0 over flat ground, in closed form."""
    flat = TerrainClearance(Terrain(np.zeros((3, 3)), spacing=(600.0, 600.0)))
    f, c, tau, tolerance = InverseDistance(30.0), 1.0 / 30.0, 3.0, 1e-3
    a = np.full((3001, 3), 100.0)
    a[:, 2] = np.linspace(30.0, 130.0, len(a))
    b = np.full_like(a, 100.0)
    b[:, 2] = end
    square = 1.0 / end - c - 2.0 * c * math.log(f.d0 / end) + c * c * (f.d0 - end)
    expected = square / SPEED + tau**2 * SPEED * (end**-3 - c**3) / 3.0
    # the jump is in a piece this long; what its chords leave is 3/28 of it at most
    piece = 0.5 * tolerance * f.d0
    unknown = 3.0 / 28.0 * piece * tau**2 * SPEED * c**4
    costs = kind(flat, risk_of(f, Sobolev(1, time_scale=tau), tolerance=tolerance)).costs(a, b)
    np.testing.assert_allclose(costs, expected, rtol=tolerance, atol=unknown)


@functions
@batches
def test_a_needle_is_not_jumped_over(kind, f):
    """However little f changes close to obstacles, pieces leave no room for one between samples."""
    heights = np.zeros((3, 2001))
    heights[:, 817] = 28.0
    needle = TerrainClearance(Terrain(heights, spacing=(1.0, 1.0)), threads=1)
    a, b = np.array([[0.0, 1.0, 27.0]]), np.array([[2000.0, 1.0, 27.0]])
    up = np.array([0, 0, 1.5])
    for norm in (Lp(1), Sobolev(1), Lp(math.inf)):
        batch = kind(needle, risk_of(f, norm))
        assert batch.costs(a, b)[0] == math.inf
        assert batch.costs(a + up, b + up)[0] < math.inf


@new_functions
def test_close_to_the_ground_pieces_are_no_shorter_than_f_asks_for(f):
    asked = []

    def counting(points):
        asked.append(len(points))
        return points[:, 2]

    a, b = np.array([[0.0, 0.0, 0.3]]), np.array([[300.0, 0.0, 0.3]])
    counts = []
    for each in (InverseDistance(30.0), f):
        asked.clear()
        SampledBatch(counting, risk_of(each)).costs(a, b)
        counts.append(sum(asked))
    assert counts[1] < counts[0] / 4


# lower bounds


@functions
@given(
    d_a=st.floats(0.01, 60.0),
    d_b=st.floats(0.01, 60.0),
    length=st.just(0.0) | st.floats(1e-9, 100.0),
    p=st.sampled_from([1.0, 2.0, 3.5, math.inf]),
)
@settings(max_examples=60, deadline=None)
def test_bounds_are_below_the_least_integral_and_close_to_it(f, d_a, d_b, length, p):
    """No way is safer than one on which d grows at the speed until it has to fall to d_b."""
    risk = risk_of(f, Lp(p))
    bound = bounds([length], d_a, d_b, risk)[0]
    s = np.linspace(0.0, length, 4001)
    values = f(np.minimum(d_a + s, d_b + length - s))
    if math.isinf(p):
        assert bound == pytest.approx(max(float(f(d_a)), float(f(d_b))), rel=1e-12, abs=1e-16)
        return
    exact = np.trapezoid(values**p, s / SPEED)
    scale = risk.negligible * length / SPEED
    assert bound <= exact * (1 + 1e-3) + 1e-9 * scale
    if f.steady is not None and 1e-3 < length <= 2 * f.steady:
        assert bound >= 0.9 * exact - scale


@functions
@given(
    seed=st.integers(0, 10_000),
    tau=st.sampled_from([0.0, 0.1, 1.0, 10.0]),
    weight=st.sampled_from([0.0, 1e-4]),
)
@settings(max_examples=60, deadline=None)
def test_no_way_of_a_thousand_costs_less_than_its_bound(f, seed, tau, weight):
    """Clearances that change as they like, but no faster than the vehicle moves."""
    rng = np.random.default_rng(seed)
    n, step = 400, rng.uniform(0.01, 0.3)
    moves = step * np.repeat(rng.uniform(-1, 1, n // 10), 10) * rng.choice([0.2, 1.0])
    d = np.maximum(rng.uniform(0.05, 40.0) + np.concatenate([[0.0], np.cumsum(moves)]), 0.05)
    t = np.arange(n + 1) * step / SPEED
    length = step * n * rng.uniform(0.3, 1.0)  # the straight way is shorter
    for norm in (Lp(1), Lp(1.7), Lp(2), Sobolev(1, time_scale=tau or 1.0)):
        risk = risk_of(f, norm, duration_weight=weight)
        cost = norm.power(t, f(d)) + weight * t[-1]
        ends = np.maximum([d[0], d[-1]], 0.0)
        assert bounds([length], *ends, risk)[0] <= cost * (1 + 1e-3)


@new_functions
@norms
@batches
def test_heuristics_stay_below_the_costs_of_straight_and_of_bent_ways(kind, f, norm, clearance):
    risk = risk_of(f, norm, tolerance=1e-3)
    batch = kind(clearance, risk)
    (a, b), (c, _) = (some_motions(clearance, 60, *k) for k in ((2, 3, 30), (3, 20, 60)))
    lower = batch.heuristics(a, b, batch.clearances(a), batch.clearances(b))
    straight, legs = batch.costs(a, b), (batch.costs(a, c), batch.costs(c, b))
    bent = np.maximum(*legs) if math.isinf(norm.exponent) else legs[0] + legs[1]
    for costs in (straight, bent):
        assert (lower <= costs * 1.001).all()
        assert np.isfinite(costs).sum() > 5
    assert (lower > 0.0).mean() > 0.3


# who answers


@functions
def test_every_function_of_the_library_runs_compiled(f, clearance):
    assert isinstance(motion_batch(clearance, risk_of(f), threads=1), TerrainBatch)


def test_a_function_of_the_user_s_own_is_sampled(clearance, dense):
    f = Ramp()
    batch = motion_batch(clearance, risk_of(f, Lp(2)))
    assert isinstance(batch, SampledBatch)
    a, b, d = dense
    costs, t = batch.costs(a, b), np.linalg.norm(b - a, axis=1) / SPEED
    free = d.min(axis=1) > 0.2
    expected = [
        Lp(2).power(np.linspace(0, t[k], d.shape[1]), f(d[k])) for k in np.flatnonzero(free)
    ]
    np.testing.assert_allclose(costs[free], expected, rtol=1e-2, atol=1e-4)


def test_compiled_code_refuses_a_function_that_it_does_not_know(clearance):
    for kind in (TerrainBatch, TerrainMotion):
        with pytest.raises(ArgumentError, match=r"risk\.avoidance = Ramp"):
            kind(clearance, risk_of(Ramp()))


def test_the_tie_break_is_a_billionth_of_what_is_typical():
    for f in FUNCTIONS:
        risk = Risk(f, Lp(2), speed=1.0)
        assert risk.weight == pytest.approx(1e-9 * float(f(f.d0 / 2)) ** 2, rel=1e-12)
    assert Risk(InverseDistance(30.0), Lp(3), speed=1.0).weight == pytest.approx(1e-9 / 30.0**3)


def test_great_exponents_do_not_overflow():
    risk = risk_of(InverseDistance(1e-3), Lp(400))
    assert 1e200 < risk.negligible < math.inf
    assert risk_of(GaussianTail(1.0), Lp(400)).negligible == 0.0
