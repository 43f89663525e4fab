"""Differences between two plans that met the same disturbances."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_estimates import estimate, some
from scipy import stats

from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.estimates.intervals import paired_counts, paired_weights
from ompl_risk.simulation.estimates.paired import compare


def test_paired_bounds_of_a_published_example():
    """Airway reactivity of 21 children: Fagerland, Lydersen and Laake, Stat. in Medicine 33."""
    low, high = paired_counts(1, 7, 21, 0.025)
    assert (round(low, 3), round(high, 3)) == (-0.517, -0.026)


@given(st.integers(0, 20), st.integers(0, 20), st.integers(0, 50), st.floats(0.001, 0.2))
def test_paired_bounds_mirror_and_hold_the_estimate(more, less, same, tail):
    n = max(1, more + less + same)
    low, high = paired_counts(more, less, n, tail)
    assert -1.0 <= low <= (more - less) / n <= high <= 1.0
    assert paired_counts(less, more, n, tail) == pytest.approx((-high, -low), abs=1e-12)


def test_paired_intervals_hold_the_truth_as_often_as_they_say():
    rng, runs, n, more, less = np.random.default_rng(4), 2000, 200, 0.06, 0.02
    counts = rng.multinomial(n, [more, less, 1.0 - more - less], size=runs)
    bounds = np.array([paired_counts(int(b), int(c), n, 0.025) for b, c, _ in counts])
    wrong = ((bounds[:, 0] > more - less) | (bounds[:, 1] < more - less)).sum()
    assert stats.binom.ppf(1e-4, runs, 0.05) <= wrong <= stats.binom.ppf(0.9999, runs, 0.06)


def test_paired_weights_without_a_difference_in_weight_agree_with_counts_for_rare_hits():
    by_weights = paired_weights(np.ones(60), np.ones(20), 10**6, 0.025, 1.0)
    assert by_weights == pytest.approx(paired_counts(60, 20, 10**6, 0.025), rel=0.1)


def test_compare_counts_rollouts_where_only_one_collides():
    first = estimate([1, 1, 1, 0, 0, 0, 0, 0, 0, 0])
    second = estimate([0, 0, 1, 1, 0, 0, 0, 0, 0, 0], name="B")
    found = compare(first, second)
    assert (found.more, found.less, found.rollouts) == (2, 1, 10)
    assert found.difference == pytest.approx(0.1)
    assert (found.low, found.high) == pytest.approx(paired_counts(2, 1, 10, 0.025))
    assert found.p_value == 1.0
    assert not found.certain
    assert "P(A) - P(B) = 0.1" in str(found)
    assert json.loads(json.dumps(found.to_dict(), allow_nan=False))["more"] == 2


def test_common_random_numbers_make_a_small_difference_certain():
    first, second = np.arange(1000) < 300, np.arange(1000) < 285
    found = compare(estimate(first), estimate(second))
    assert found.certain
    assert found.p_value == pytest.approx(2.0 * 0.5**15)
    assert estimate(first).low < estimate(second).high  # which their intervals do not show


def test_the_error_of_a_difference_is_shared_out_among_the_looks_too():
    first, second = some(9, 100, looks=5), some(2, 100, name="B", looks=2)
    found = compare(first, second)
    assert (found.low, found.high) == pytest.approx(paired_counts(7, 0, 100, 0.005))
    assert found.p_value == pytest.approx(5 * 2.0 * 0.5**7)


def test_compare_weighs_hits():
    weights = np.linspace(0.1, 2.0, 50)
    first = estimate(np.arange(50) % 2 == 0, weights=weights, heaviest=4.0)
    second = estimate(np.arange(50) % 4 == 0, weights=weights, heaviest=4.0)
    found = compare(first, second)
    assert found.difference == pytest.approx(first.probability - second.probability, rel=1e-12)
    assert found.p_value is None
    assert found.low < found.difference < found.high


@pytest.mark.parametrize(
    ("rest", "argument"),
    [
        ({"seed": 4}, "second.seed"),
        ({"confidence": 0.9}, "second.confidence"),
        ({"weights": np.ones(9)}, "second.weights"),
    ],
)
def test_compare_refuses_other_disturbances(rest, argument):
    with pytest.raises(ArgumentError) as caught:
        compare(some(2, 9), some(3, 9, **rest))
    assert caught.value.argument == argument


def test_compare_refuses_other_numbers_of_rollouts_and_unknown_seeds():
    with pytest.raises(ArgumentError, match=r"second\.rollouts = 8"):
        compare(some(2, 9), some(3, 8))
    with pytest.raises(ArgumentError, match=r"second\.seed = None"):
        compare(some(2, 9, seed=None), some(3, 9, seed=None))
    one, other = (some(2, 9, weights=np.full(9, w)) for w in (1.0, 2.0))
    with pytest.raises(ArgumentError, match=r"second\.weights"):
        compare(one, other)
