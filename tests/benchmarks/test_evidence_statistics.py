"""The bootstrap against resampling by hand and against what theory says of its spread."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.evidence.analysis.statistics import Bootstrap, Interval, mean
from ompl_risk.errors import ArgumentError


def test_each_draw_is_the_mean_over_the_sets_of_the_units_drawn():
    random = np.random.default_rng(1)
    scores, counted = random.uniform(size=(4, 3, 9)), random.uniform(size=(3, 9)) < 0.6
    draws = Bootstrap.of(np.arange(9), resamples=50)
    found = draws.means(scores, counted)
    assert found.shape == (4, 50)
    for b, weights in enumerate(draws.weights):
        units = np.repeat(np.arange(9), weights.astype(int))
        assert len(units) == 9
        for s in range(4):
            drawn = np.concatenate([scores[s, counted[:, u], u] for u in units])
            assert found[s, b] == pytest.approx(drawn.mean())


def test_groups_are_drawn_whole():
    groups = ["a", "b", "b", "c", "c", "c"]
    weights = Bootstrap.of(groups, resamples=200).weights
    assert (weights[:, 1] == weights[:, 2]).all()
    assert (weights[:, 3:] == weights[:, 3:4]).all()
    assert (weights[:, [0, 1, 3]].sum(axis=1) == 3).all()


def test_the_interval_has_the_width_that_theory_gives():
    random = np.random.default_rng(2)
    scores = random.normal(5.0, 2.0, (1, 1, 400))
    found = Bootstrap.of(np.arange(400)).intervals(scores, np.ones((1, 400), dtype=bool))[0]
    error = scores.std() / 20.0
    assert found.mean == pytest.approx(scores.mean())
    assert found.high - found.mean == pytest.approx(1.96 * error, rel=0.06)
    assert found.mean - found.low == pytest.approx(1.96 * error, rel=0.06)


def test_three_copies_of_a_set_say_no_more_than_one():
    """Levels of a unit that go together must not count as independent."""
    scores = np.random.default_rng(3).normal(size=(1, 1, 100))
    one = Bootstrap.of(np.arange(100)).intervals(scores, np.ones((1, 100), dtype=bool))[0]
    copies = np.repeat(scores, 3, axis=1)
    three = Bootstrap.of(np.arange(100)).intervals(copies, np.ones((3, 100), dtype=bool))[0]
    assert three == pytest.approx(one)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6))
def test_intervals_cover_the_truth_about_as_often_as_they_say(seed):
    random = np.random.default_rng(seed)
    counted, covered = np.ones((1, 60), dtype=bool), 0
    scores = random.binomial(1, 0.7, (200, 1, 60)).astype(float)
    for found in Bootstrap.of(np.arange(60), resamples=1000).intervals(scores, counted):
        covered += found.low <= 0.7 <= found.high
    assert 170 <= covered <= 200  # 95 % of 200, less what percentiles lose with 60 units


def test_differences_on_the_same_units_are_narrower_than_apart():
    random = np.random.default_rng(4)
    common = random.normal(size=(1, 1, 80))
    pair = np.concatenate([common, common + 0.1 + 0.01 * random.normal(size=(1, 1, 80))])
    draws, counted = Bootstrap.of(np.arange(80)), np.ones((1, 80), dtype=bool)
    gain = draws.intervals(pair[1:] - pair[:1], counted)[0]
    one, other = draws.intervals(pair, counted)
    assert gain.low > 0.0
    assert gain.excludes_zero
    assert one.high > other.low


def test_what_is_left_out_does_not_count():
    scores, counted = np.array([[[1.0, 100.0, 3.0]]]), np.array([[True, False, True]])
    assert mean(scores, counted) == pytest.approx([2.0])
    found = Bootstrap.of(np.arange(3)).intervals(scores, counted)[0]
    assert (found.low, found.high) == (1.0, 3.0)


def test_nothing_to_average_is_no_number_and_no_claim():
    scores, none = np.ones((2, 1, 3)), np.zeros((1, 3), dtype=bool)
    for found in Bootstrap.of(np.arange(3), resamples=20).intervals(scores, none):
        assert np.isnan(found).all()
        assert not found.excludes_zero


def test_the_same_seed_draws_the_same_and_no_groups_are_refused():
    one, other = Bootstrap.of(np.arange(5)), Bootstrap.of(np.arange(5))
    np.testing.assert_array_equal(one.weights, other.weights)
    assert one.weights.shape == (10_000, 5)
    with pytest.raises(ArgumentError, match="groups"):
        Bootstrap.of([])


@pytest.mark.parametrize(
    ("low", "high", "excludes"),
    [
        (0.1, 0.2, True),
        (-0.2, -0.1, True),
        (-0.1, 0.1, False),
        (0.0, 0.1, False),
        (-0.1, 0.0, False),
    ],
)
def test_an_interval_that_touches_zero_excludes_nothing(low, high, excludes):
    assert Interval(0.0, low, high).excludes_zero is excludes
