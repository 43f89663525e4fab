"""Avoidance functions in compiled code: against definitions, dense sampling and brute force."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from integrand_pieces import (
    FUNCTIONS,
    SPEED,
    batches,
    functions,
    new_functions,
    norms,
    numbers,
    risk_of,
    some_motions,
)

from ompl_risk._kernels import integrand
from ompl_risk.avoidance import (
    Avoidance,
    FlatCap,
    GaussianTail,
    InverseDistance,
    checked_distance,
)
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, SampledBatch, TerrainBatch, TerrainMotion, motion_batch
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain


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
def dense(hills_for_one):
    """Motions, and the clearances at 8,001 places along each."""
    a, b = some_motions(hills_for_one, 40)
    s = np.linspace(0, 1, 8001)[:, None]
    return a, b, np.array([hills_for_one(p + s * (q - p)) for p, q in zip(a, b, strict=True)])


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


@functions
@norms
@batches
def test_costs_are_the_powers_of_the_norm_of_densely_sampled_f(kind, f, norm, hills_for_one, dense):
    risk = risk_of(f, norm)
    a, b, d = dense
    costs, t = kind(hills_for_one, risk).costs(a, b), np.linalg.norm(b - a, axis=1) / SPEED
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


@functions
def test_every_function_of_the_library_runs_compiled(f, hills_for_one):
    assert isinstance(motion_batch(hills_for_one, risk_of(f), threads=1), TerrainBatch)


def test_a_function_of_the_user_s_own_is_sampled(hills_for_one, dense):
    f = Ramp()
    batch = motion_batch(hills_for_one, risk_of(f, Lp(2)))
    assert isinstance(batch, SampledBatch)
    a, b, d = dense
    costs, t = batch.costs(a, b), np.linalg.norm(b - a, axis=1) / SPEED
    free = d.min(axis=1) > 0.2
    expected = [
        Lp(2).power(np.linspace(0, t[k], d.shape[1]), f(d[k])) for k in np.flatnonzero(free)
    ]
    np.testing.assert_allclose(costs[free], expected, rtol=1e-2, atol=1e-4)


def test_compiled_code_refuses_a_function_that_it_does_not_know(hills_for_one):
    for kind in (TerrainBatch, TerrainMotion):
        with pytest.raises(ArgumentError, match=r"risk\.avoidance = Ramp"):
            kind(hills_for_one, risk_of(Ramp()))


def test_the_tie_break_is_a_billionth_of_what_is_typical():
    for f in FUNCTIONS:
        risk = Risk(f, Lp(2), speed=1.0)
        assert risk.weight == pytest.approx(1e-9 * float(f(f.d0 / 2)) ** 2, rel=1e-12)
    assert Risk(InverseDistance(30.0), Lp(3), speed=1.0).weight == pytest.approx(1e-9 / 30.0**3)


def test_great_exponents_do_not_overflow():
    risk = risk_of(InverseDistance(1e-3), Lp(400))
    assert 1e200 < risk.negligible < math.inf
    assert risk_of(GaussianTail(1.0), Lp(400)).negligible == 0.0
