"""Scores of a set against their definitions, and judges against independent computations."""

import math

import numpy as np
import pytest
from evidence_tables import no_difference, units, write
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binomtest

from benchmarks.evidence.analysis.ceiling import halves, repeated
from benchmarks.evidence.analysis.metrics import kendall_tau, ranks, scores
from benchmarks.evidence.analysis.table import MEMBERS, read
from benchmarks.evidence.analysis.truth import certain, closed_loop, decided, mcnemar, paper
from ompl_risk import Lp, Sobolev
from ompl_risk.ranking.agreement import kendall_tau as library_tau

FIVE = st.lists(st.sampled_from([0.0, 0.1, 0.2, 0.5, 0.9, 7.0]), min_size=5, max_size=5)


def by_definition(values, truth):
    """Safest, riskiest, tau, regret of one set, as one would write them down."""
    picks = [k for k in range(5) if values[k] == min(values)]
    worst = [k for k in range(5) if values[k] == max(values)]
    return (
        np.mean([truth[k] == min(truth) for k in picks]),
        np.mean([truth[k] == max(truth) for k in worst]),
        library_tau(values, truth),
        np.mean([truth[k] - min(truth) for k in picks]),
    )


@settings(max_examples=200, deadline=None)
@given(FIVE, FIVE)
def test_scores_are_what_they_are_defined_as(values, truth):
    found = scores(np.array(values), np.array(truth))
    np.testing.assert_allclose(found, by_definition(values, truth), atol=1e-12)


def test_scores_of_many_settings_by_many_judges():
    random = np.random.default_rng(0)
    values, truth = random.integers(0, 4, (3, 7, 5)), random.integers(0, 4, (2, 7, 5))
    found = scores(values[:, None].astype(float), truth.astype(float))
    for metric in found:
        assert metric.shape == (3, 2, 7)
    for s, j, u in np.ndindex(3, 2, 7):
        expected = by_definition(values[s, u].tolist(), truth[j, u].tolist())
        np.testing.assert_allclose([m[s, j, u] for m in found], expected, atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(FIVE, FIVE)
def test_a_perfect_and_a_reversed_setting(values, truth):
    truth = [t + k for k, t in enumerate(sorted(truth))]
    assert scores(np.array(truth), np.array(truth))[:3] == (1.0, 1.0, 1.0)
    assert scores(np.array(truth), np.array(truth)).regret == 0.0
    turned = scores(-np.array(truth), np.array(truth))
    assert (turned.safest, turned.riskiest, turned.tau) == (0.0, 0.0, -1.0)
    assert turned.regret == pytest.approx(max(truth) - min(truth))
    both = kendall_tau(ranks(values), ranks(truth))
    assert both == kendall_tau(ranks(truth), ranks(values))
    assert -1.0 <= both <= 1.0


def test_ties_to_rounding_are_ties_and_others_are_not():
    assert ranks([1.0, 1.0 + 1e-9, 2.0, 1.0 + 1e-4, 0.0]).tolist() == [1, 1, 3, 2, 0]
    assert ranks([math.inf, 1.0, math.inf, 0.0, 0.0]).tolist() == [2, 1, 2, 0, 0]


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Units whose flights collide with probabilities that differ from nothing to much."""

    def rule(five, level):
        return (
            np.array([0.02, 0.02, 0.05, 0.1, 0.3]) if five[0].duration > 35.0 else np.full(5, 0.1)
        )

    path = tmp_path_factory.mktemp("evidence") / "t.parquet"
    return read(write(path, units(12, rule, rollouts=300, independent=True)))


def test_mcnemar_is_the_binomial_test_of_discordant_rollouts(table):
    found = mcnemar(table)
    for level, unit in np.ndindex(found.shape):
        hits = table.hits[level, unit]
        high, low = int(hits.argmax()), int(hits.argmin())
        patterns = table.patterns[level, unit]
        b = int(patterns[(MEMBERS[:, high] == 1) & (MEMBERS[:, low] == 0)].sum())
        c = int(patterns[(MEMBERS[:, high] == 0) & (MEMBERS[:, low] == 1)].sum())
        expected = binomtest(min(b, c), b + c, 0.5).pvalue if b + c else 1.0
        assert found[level, unit] == pytest.approx(expected)


def test_sets_that_differ_are_decided_and_sets_that_do_not_are_not(table):
    differ = np.array([len({*np.round(p, 1)}) > 2 for p in table.hits[0] / 300])
    found = decided(table)
    assert found[:, differ].all()
    assert 0 < differ.sum() < len(differ)
    assert found[:, ~differ].mean() <= 0.05


def test_too_few_hits_decide_nothing(tmp_path):
    def rule(five, level):
        return np.array([0.0, 0.0, 0.0, 0.0, 9.0 / 900.0])

    few = read(write(tmp_path / "t.parquet", units(4, rule, rollouts=700)))
    assert few.hits.max() >= 1
    assert not decided(few)[few.hits.max(axis=-1) < 10].any()


def test_judges_are_shares_of_rollouts_and_the_librarys_norms_of_pc(table):
    np.testing.assert_array_equal(closed_loop(table).values, table.hits / 300)
    judge = paper(table)
    for name, norm, values in zip(
        judge.names, (Lp(1), Lp(2), Lp(math.inf), Sobolev(1)), judge.values, strict=True
    ):
        assert name == f"{norm.label} of P_c"
        flights = map(table.profiles.flight, range(len(table.profiles)))
        alone = [norm(flight["t"], flight["pc"]) for flight in flights]
        np.testing.assert_allclose(values.ravel(), alone, rtol=1e-9)


def rare(tmp_path, probabilities, rollouts):
    rows = units(
        20, lambda five, level: np.array(probabilities), rollouts=rollouts, independent=True,
        splits=("test",),
    )  # fmt: skip
    return read(write(tmp_path / "t.parquet", rows))


def test_a_judge_that_sees_clearly_predicts_itself(tmp_path):
    table = rare(tmp_path, [0.05, 0.2, 0.4, 0.6, 0.9], 400)
    for found in (halves(table), repeated(table)):
        assert found.safest.mean() == pytest.approx(1.0)
        assert found.tau.mean() == pytest.approx(1.0, abs=0.01)
        assert found.regret.mean() == pytest.approx(0.0)


def test_halves_of_a_judge_that_sees_nothing_agree_by_chance(tmp_path):
    found = halves(rare(tmp_path, [0.5] * 5, 2001))
    assert found.safest.mean() == pytest.approx(0.2, abs=0.06)
    assert found.tau.mean() == pytest.approx(0.0, abs=0.06)
    again = repeated(rare(tmp_path, [0.5] * 5, 2001))
    assert again.safest.mean() > 0.4  # takes noise for truth, which is why it is the upper figure


def test_ceilings_are_the_same_each_time(table):
    for ceiling in (halves, repeated):
        for one, other in zip(ceiling(table), ceiling(table), strict=True):
            np.testing.assert_array_equal(one, other)
    assert not np.array_equal(halves(table).tau, halves(table, seed=1).tau)


def test_flights_that_collide_alike_share_the_honour(tmp_path):
    rows = units(3, no_difference, rollouts=200, splits=("test",))
    table = read(write(tmp_path / "t.parquet", rows))  # common numbers: all five or none
    assert (table.hits == table.hits[..., :1]).all()
    judge = closed_loop(table)
    assert not judge.decided.any()
    found = scores(np.arange(5.0), judge.values)
    assert (found.safest == 1.0).all()
    assert (found.regret == 0.0).all()
    assert (found.tau == 0.0).all()


@pytest.mark.parametrize(
    ("chances", "is_certain"),
    [([0.05, 0.3, 0.4, 0.5, 0.6], True), ([0.05, 0.05, 0.4, 0.5, 0.6], False), ([0.1] * 5, False)],
)
def test_the_safest_is_certain_only_where_it_differs_from_every_other(
    tmp_path, chances, is_certain
):
    made = units(6, lambda _five, _level: np.array(chances), rollouts=600, independent=True)
    table = read(write(tmp_path / "t.parquet", made))
    assert certain(table).mean() == (1.0 if is_certain else 0.0)
    if not is_certain and chances[0] != chances[-1]:
        assert decided(table).all()  # the riskiest does differ
