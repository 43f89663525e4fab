"""Estimates of a probability of collision and their bounds."""

from __future__ import annotations

import json
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_estimates import estimate, some
from scipy import stats

from ompl_risk._kernels.air import LEFT_MAP, LOST_CONTROL, TOUCHED
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.estimates.estimate import CollisionEstimate
from ompl_risk.simulation.estimates.intervals import counted, weighed


@pytest.mark.parametrize(("hits", "n"), [(0, 50), (3, 50), (50, 50)])
def test_bounds_without_weights_invert_the_binomial_tails(hits, n):
    found = some(hits, n, confidence=0.9)
    assert found.probability == hits / n
    if hits:
        assert stats.binom.sf(hits - 1, n, found.low) == pytest.approx(0.05, rel=1e-9)
    else:
        assert found.low == 0.0
    if hits < n:
        assert stats.binom.cdf(hits, n, found.high) == pytest.approx(0.05, rel=1e-9)
        assert stats.binom.cdf(hits, n, found.upper_bound(0.99)) == pytest.approx(0.01, rel=1e-9)
    else:
        assert found.high == found.upper_bound(0.99) == 1.0


def test_one_sided_bounds_are_the_ends_of_the_interval_of_half_the_error():
    found = some(7, 300, confidence=0.9)
    assert found.upper_bound(0.95) == pytest.approx(found.high, rel=1e-12)
    assert found.lower_bound(0.95) == pytest.approx(found.low, rel=1e-12)
    assert found.upper_bound() < found.high


def test_a_probability_of_0_always_comes_with_what_it_may_be():
    assert str(some(0, 10_000)) == "A: 0 of 10,000, at most 3.69e-4 (95 %)"
    assert str(some(0, 10, name="")) == "0 of 10, at most 0.308 (95 %)"
    assert "nan" not in str(some(0, 10, weights=np.full(10, 0.5), heaviest=4.0))
    assert str(some(12, 1000)) == "A: 0.012, 0.00622 to 0.0209 (95 %), 12 of 1,000"


def test_hits_that_are_no_contact_are_told_apart():
    endings = np.array([TOUCHED, LEFT_MAP, LEFT_MAP, LOST_CONTROL, 0])
    found = some(4, 5, endings=endings)
    assert found.ended == {"touched": 1, "left the map": 2, "lost control": 1}
    assert str(found).endswith("4 of 5, 2 left the map, 1 lost control")
    assert some(4, 5).ended == {"touched": 4, "left the map": 0, "lost control": 0}


def test_looks_share_out_the_error():
    once, often = some(2, 400, confidence=0.95), some(2, 400, confidence=0.95, looks=5)
    assert (often.low, often.high) == pytest.approx(counted(2, 400, 0.005))
    assert often.upper_bound() == pytest.approx(counted(2, 400, 0.01)[1])
    assert often.low < once.low < once.high < often.high


def test_a_threshold_is_decided_only_when_the_bounds_say_so():
    found = some(5, 1000)
    assert found.decided(found.upper_bound()) == "below"
    assert found.decided(np.nextafter(found.upper_bound(), 0.0)) == "open"
    assert found.decided(found.lower_bound()) == "open"
    assert found.decided(np.nextafter(found.lower_bound(), 0.0)) == "above"
    assert found.decided(found.probability) == "open"


def test_times_places_and_quantiles():
    found = estimate([True, False, False, True])
    assert found.times.tolist() == [1.0, 4.0]
    assert found.places[:, 0].tolist() == [1.0, 4.0]
    assert found.quantiles([0.0, 0.5, 0.75, 1.0]).tolist() == [-1.0, -1.0, 2.0, 3.0]


def test_weighted_quantiles_are_those_of_a_sample_with_repetitions():
    rng = np.random.default_rng(0)
    least, repeats = rng.normal(size=40), rng.integers(1, 6, size=40)
    zeros = np.zeros(40)
    found = CollisionEstimate(
        "A", least, zeros, np.zeros((40, 3)), zeros + np.inf, weights=repeats / 7.0
    )
    levels = np.array([0.02, 0.31, 0.5, 0.87, 1.0])
    expected = np.quantile(np.repeat(least, repeats), levels, method="inverted_cdf")
    assert found.quantiles(levels).tolist() == expected.tolist()


def test_equal_weights_give_the_exact_bounds_of_a_poisson_count():
    low, high = weighed(np.full(4, 0.5), 1000, 0.025, 0.5)
    assert stats.poisson.sf(3, low * 2000.0) == pytest.approx(0.025, rel=1e-9)
    assert stats.poisson.cdf(4, high * 2000.0) == pytest.approx(0.025, rel=1e-9)


@given(
    st.lists(st.floats(1e-9, 4.0), max_size=30),
    st.floats(0.001, 0.4),
    st.floats(1.0, 10.0),
)
def test_weighted_bounds_hold_the_estimate_and_scale(weights, tail, factor):
    w = np.array(weights)
    low, high = weighed(w, 10**6, tail, 4.0)
    assert 0.0 <= low <= w.sum() / 1e6 * (1.0 + 1e-9) <= high * (1.0 + 1e-9)
    scaled = weighed(factor * w, 10**6, tail, factor * 4.0)
    assert scaled == pytest.approx((factor * low, factor * high), rel=1e-9)
    assert weighed(w, 10**6, 0.5 * tail, 4.0)[1] >= high
    assert weighed(w, 10**6, tail, 5.0)[1] >= high


def test_without_weighted_hits_the_bound_is_that_of_the_heaviest():
    found = some(0, 1000, weights=np.full(1000, 0.1), heaviest=4.0)
    assert found.high == pytest.approx(-math.log(0.025) * 4.0 / 1000, rel=1e-9)
    assert found.probability == found.low == 0.0


def tilted(n: int, shift: float, share: float, rng: np.random.Generator) -> tuple:
    """Hits and weights for P(z > shift): a share is drawn from N(0, 1), the rest shifted."""
    z = rng.normal(size=n) + np.where(rng.random(n) < share, 0.0, shift)
    weights = 1.0 / (share + (1.0 - share) * np.exp(shift * z - 0.5 * shift**2))
    return z > shift, weights


@pytest.mark.parametrize(("n", "shift"), [(30, 3.0), (300, 2.0), (300, 4.75)])
def test_weighted_intervals_hold_the_truth_as_often_as_they_say(n, shift):
    rng, truth, runs = np.random.default_rng(1), stats.norm.sf(shift), 2000
    below = above = 0
    for _ in range(runs):
        hits, weights = tilted(n, shift, 0.25, rng)
        heaviest = weights[hits].max(initial=0.0) or 4.0
        low, high = weighed(weights[hits], n, 0.025, heaviest)
        below, above = below + (truth < low), above + (truth > high)
    most = stats.binom.ppf(0.9999, runs, 0.025)
    assert below <= most
    assert above <= most


def test_the_upper_bound_of_weighted_rollouts_allows_for_collisions_that_none_met():
    """A second way of colliding, of which the shifted rollouts know nothing and few are drawn."""
    rng, n, share, other = np.random.default_rng(2), 400, 0.25, 2e-3
    truth = stats.norm.sf(4.0) + other
    wrong = sure_wrong = 0
    for _ in range(500):
        hits, weights = tilted(n, 4.0, share, rng)
        nominal = rng.random(n) < other
        hits |= nominal & (weights > 0.5 / share)
        found = estimate(hits, weights=weights, heaviest=1.0 / share)
        wrong += found.high < truth
        sure_wrong += found.upper_bound(0.95) < truth
    assert wrong > 250  # low and high do take it that there is no such way
    assert sure_wrong <= stats.binom.ppf(0.9999, 500, 0.05)


def test_sample_sizes_that_weights_amount_to():
    hits, weights = tilted(20_000, 3.0, 0.25, np.random.default_rng(3))
    found = estimate(hits, weights=weights)
    p = stats.norm.sf(3.0)
    assert found.probability == pytest.approx(p, rel=0.05)
    assert found.effective_rollouts == pytest.approx(weights.sum() ** 2 / (weights**2).sum())
    # exact variance of a term by quadrature over z > 3
    z = np.linspace(3.0, 12.0, 20_001)
    w = 1.0 / (0.25 + 0.75 * np.exp(3.0 * z - 4.5))
    second = np.trapezoid(w * stats.norm.pdf(z), z)
    assert found.equivalent_rollouts == pytest.approx(20_000 * p / (second - p**2), rel=0.05)
    assert some(3, 50).effective_rollouts == some(3, 50).equivalent_rollouts == 50.0


def test_plain_data_are_strict_json():
    found = some(2, 40, weights=np.full(40, 0.5), heaviest=4.0, endings=np.arange(40) < 2)
    data = json.loads(json.dumps(found.to_dict(), allow_nan=False))
    assert data["hits"] == 2
    assert data["collisions"]["times"] == [1.0, 2.0]
    assert data["upper_bound"] > data["high"] > data["probability"] > data["low"] > 0.0
    empty = CollisionEstimate("", [math.inf], [0.0], np.zeros((1, 3)), [math.inf])
    assert (
        json.loads(json.dumps(empty.to_dict(), allow_nan=False))["least_clearance"]["0.5"] == "inf"
    )


def test_estimates_survive_pickling_and_stay_read_only():
    found = pickle.loads(pickle.dumps(some(3, 20, weights=np.ones(20), looks=3)))
    assert found.to_dict() == some(3, 20, weights=np.ones(20), looks=3).to_dict()
    for array in (found.least, found.when, found.where, found.collided, found.weights):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("least", np.array([])),
        ("least", np.array([0.0, math.nan])),
        ("when", np.zeros(3)),
        ("where", np.zeros((2, 2))),
        ("collided", np.array([math.nan, 0.0])),
        ("collided", np.zeros(3)),
        ("weights", np.array([-1.0, 1.0])),
        ("weights", np.ones(3)),
        ("endings", np.zeros(3)),
        ("confidence", 1.0),
        ("confidence", True),
        ("heaviest", 0.0),
        ("looks", 0),
        ("looks", 1.0),
    ],
)
def test_wrong_values_are_named(field, value):
    good = {"name": "A", "least": np.zeros(2), "when": np.zeros(2), "where": np.zeros((2, 3))}
    with pytest.raises(ArgumentError) as caught:
        CollisionEstimate(**good | {"collided": np.zeros(2)} | {field: value})
    assert caught.value.argument.startswith(field)


def test_wrong_confidences_and_levels_are_refused():
    for call in (some(1, 5).upper_bound, some(1, 5).lower_bound):
        with pytest.raises(ArgumentError, match="confidence"):
            call(0.0)
    with pytest.raises(ArgumentError, match="levels"):
        some(1, 5).quantiles([1.5])
