"""Rates of collision against simulated Gaussian processes, closed forms and quadrature."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy import integrate, stats

from ompl_risk.errors import ArgumentError
from ompl_risk.probability.crossings import CrossingRate

SIGMA, TAU = 8.0, 2.5
RATE = CrossingRate(SIGMA, correlation_time=TAU)
T = np.linspace(0.0, 25.0, 301)  # 30 steps in tau
DISTANCES = {
    "level": np.full(len(T), 14.0),
    "near": np.full(len(T), 4.0),
    "dive and climb": 10.0 + 1.6 * np.abs(T - 12.5),
    "wave": 14.0 + 6.0 * np.sin(1.1 * T),
    "retreat": 5.0 + 3.0 * T,
}
each = pytest.mark.parametrize("d", DISTANCES.values(), ids=DISTANCES.keys())


@pytest.fixture(scope="module")
def errors():
    """30,000 paths of a process whose correlation is exp(-s^2 / (2 tau^2))."""
    s = T[:, None] - T
    values, vectors = np.linalg.eigh(np.exp(-0.5 * (s / TAU) ** 2))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    keep = values > 1e-13 * values.max()
    drawn = np.random.default_rng(11).normal(size=(30_000, int(keep.sum())))
    return SIGMA * drawn @ root[:, keep].T


@each
def test_expected_collisions_are_the_mean_number_of_entries(d, errors):
    inside = d + errors < 0.0
    entries = inside[:, 0] + (inside[:, 1:] & ~inside[:, :-1]).sum(axis=1)
    deviation = entries.std() / math.sqrt(len(entries))
    assert RATE.expected_collisions(T, d) == pytest.approx(entries.mean(), abs=3.5 * deviation)


@each
def test_the_bound_holds_and_is_not_idle(d, errors):
    hit = (d + errors < 0.0).any(axis=1).mean()
    deviation = math.sqrt(hit / len(errors))
    found = RATE.along(T, d)
    assert hit <= found.bound + 3.5 * deviation
    assert found.bound <= 2.0 * hit
    assert found.independent <= found.bound
    assert found.independent == pytest.approx(hit, rel=0.25)


def test_entries_come_when_the_rate_says(errors):
    d = DISTANCES["dive and climb"]
    inside = d + errors < 0.0
    counts = (inside[:, 1:] & ~inside[:, :-1]).sum(axis=0)
    expected = RATE.rate(T, d) * np.diff(T) * len(errors)
    blocks = [each.reshape(20, 15).sum(axis=1) for each in (counts, expected)]
    squares = (blocks[0] - blocks[1]) ** 2 / np.maximum(blocks[1], 1.0)
    assert squares.sum() < stats.chi2.ppf(1 - 1e-4, 20)


def test_constant_distance_in_closed_form():
    """Rice: exp(-d^2 / (2 sigma^2)) / (2 pi tau) a second."""
    d = 14.0
    found = RATE.along([0.0, 3.0, 10.0], [d, d, d])
    rate = math.exp(-0.5 * (d / SIGMA) ** 2) / (2 * math.pi * TAU)
    np.testing.assert_allclose(found.rate, rate, rtol=1e-14)
    assert found.initial == pytest.approx(stats.norm.sf(d / SIGMA), rel=1e-14)
    assert found.expected == pytest.approx(found.initial + 10 * rate, rel=1e-14)
    np.testing.assert_allclose(found.cumulative, found.initial + rate * found.t, rtol=1e-14)
    assert RATE.rate_at(d, 0.0) == pytest.approx(rate, rel=1e-14)


def test_an_error_that_never_changes_is_met_once():
    """Then P(collision) is that of the least distance, and so is the expected number."""
    slow = CrossingRate(SIGMA, correlation_time=1e7)
    d = DISTANCES["dive and climb"]
    assert slow.expected_collisions(T, d) == pytest.approx(stats.norm.sf(10.0 / SIGMA), rel=1e-4)


@given(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0), st.floats(0.01, 30.0))
@example(-8.5, -8.48, 1.0)
def test_intervals_are_integrated_exactly(x0, x1, seconds):
    d0, d1 = SIGMA * x0, SIGMA * x1
    slope = (d1 - d0) / seconds
    exact = integrate.quad(
        lambda t: float(RATE.rate_at(d0 + slope * t, slope)), 0.0, seconds, epsabs=0, limit=200
    )[0]
    found = RATE.rate([0.0, seconds], [d0, d1])[0] * seconds
    assert found == pytest.approx(exact, rel=1e-7, abs=1e-30)


@given(st.floats(-6.0, 30.0), st.floats(-12.0, 12.0), st.integers(2, 40))
def test_cutting_a_straight_flight_changes_nothing(x, slope, n):
    whole = np.array([0.0, 1.0])
    fine = np.linspace(0.0, 1.0, n)
    totals = [RATE.expected_collisions(t, SIGMA * x + slope * t) for t in (whole, fine)]
    assert totals[0] == pytest.approx(totals[1], rel=1e-9, abs=1e-300)


@given(st.floats(-20.0, 20.0), st.floats(-300.0, 300.0))
def test_rates_are_never_negative_and_turning_round_leaves_the_difference_of_tails(x, slope):
    """Entries less exits are what the probability of being inside grows by."""
    d = SIGMA * x
    entries, exits = RATE.rate_at(d, slope), RATE.rate_at(d, -slope)
    assert entries >= 0.0
    growth = -slope / SIGMA * stats.norm.pdf(x)
    assert entries - exits == pytest.approx(growth, rel=1e-9, abs=1e-12 * exits)


def test_a_field_of_errors_flown_over_twice_as_fast_changes_twice_as_fast():
    rate = CrossingRate(SIGMA, correlation_length=60.0, speed=30.0)
    assert rate == CrossingRate(SIGMA, correlation_time=2.0)
    assert rate.rate_deviation == 4.0
    assert CrossingRate(SIGMA, correlation_length=60.0, speed=60.0).correlation_time == 1.0


def test_certain_collision_is_bounded_by_one():
    found = RATE.along([0.0, 100.0], [-200.0, -200.0])
    assert found.initial == 1.0
    assert found.bound == found.independent == 1.0
    many = RATE.along([0.0, 1000.0], [0.0, 0.0])
    assert many.expected > 60
    assert many.bound == 1.0


def test_results_are_read_only():
    found = RATE.along([0.0, 1.0], [5.0, 6.0])
    for array in (found.t, found.rate):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: CrossingRate(0.0, correlation_time=1.0), "sigma = 0.0"),
        (lambda: CrossingRate(1.0), "correlation_time"),
        (lambda: CrossingRate(1.0, correlation_time=1.0, correlation_length=1.0), "one of the two"),
        (lambda: CrossingRate(1.0, correlation_time=1.0, speed=1.0), "speed = 1.0"),
        (lambda: CrossingRate(1.0, correlation_time=math.nan), "correlation_time = nan"),
        (lambda: CrossingRate(1.0, correlation_length=1.0), "speed"),
        (lambda: CrossingRate(1.0, correlation_length=0.0, speed=1.0), "correlation_length = 0.0"),
        (lambda: CrossingRate(1.0, correlation_length=1.0, speed=-1.0), "speed = -1.0"),
        (lambda: RATE.rate([0.0, 1.0], [1.0, 2.0, 3.0]), "d.shape"),
        (lambda: RATE.rate([0.0, 0.0], [1.0, 2.0]), "t[1]"),
        (lambda: RATE.rate([0.0, 1.0], [1.0, math.inf]), "d[1]"),
    ],
)
def test_bad_arguments_are_named(call, named):
    with pytest.raises(ArgumentError) as error:
        call()
    assert named in str(error.value)
