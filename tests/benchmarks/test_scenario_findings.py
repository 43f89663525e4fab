"""What is asked of the paper's scenario: claims, with ties and without, and shares."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenario_work import LABELS, NAMES, judged
from scipy import stats

from benchmarks.scenario.findings import CLAIMS, Share, claims, claims_with_ties, hits

ALL = {"L1": "ABCDE", "L2": "ABCDE", "L∞": "ABCDE", "H1": "ABCDE"}
PAPER = {"L1": "BACDE", "L2": "CABDE", "L∞": "DBCAE", "H1": "ACBDE"}
"""Orders of f as the paper found them: all end with E, only H1 begins with A."""


@pytest.mark.parametrize(
    ("orders", "pc_orders", "agree", "riskiest", "safest"),
    [
        (PAPER, ALL, True, True, True),
        (ALL, ALL, True, True, False),  # H1 finds it, and so do the others
        (PAPER | {"H1": "BACDE"}, ALL, True, True, False),  # nobody finds it
        (PAPER | {"L1": "ABCDE"}, ALL, True, True, False),  # one more finds it
        (PAPER | {"H1": "CABDE", "L2": "ABCDE"}, ALL, True, True, False),  # another finds it
        (PAPER | {"L∞": "DBCEA"}, ALL, True, False, True),
        (PAPER | {"H1": "ABCED"}, ALL, True, False, True),
        (PAPER, ALL | {"L∞": "ABDCE"}, False, True, True),
        # the L2 norm says which is which where they differ
        (PAPER, ALL | {"L2": "BACDE"}, False, True, False),
        (PAPER, ALL | {"L2": "ABCED"}, False, False, True),
        (PAPER, dict.fromkeys(ALL, "EDCBA"), True, False, False),
    ],
)
def test_claims(orders, pc_orders, agree, riskiest, safest):
    expected = (agree, riskiest, safest, agree and riskiest and safest)
    assert tuple(claims(orders, pc_orders).values()) == expected
    listed = [{label: list(order) for label, order in each.items()} for each in (orders, pc_orders)]
    assert tuple(claims(*listed).values()) == expected
    assert list(claims(orders, pc_orders)) == list(CLAIMS)


distinct = st.lists(st.integers(0, 99), min_size=5, max_size=5, unique=True)
tables = st.fixed_dictionaries(dict.fromkeys(LABELS, distinct))
tied = st.fixed_dictionaries(
    {label: st.lists(st.integers(0, 2), min_size=5, max_size=5) for label in LABELS}
)


@given(tables, tables)
def test_without_ties_they_change_nothing(norms, pc_norms):
    record = judged(0, norms, pc_norms)
    assert claims_with_ties(record) == record["claims"]


@given(tied, tied, st.randoms(use_true_random=False))
@settings(max_examples=50)
def test_ties_go_either_way(norms, pc_norms, random):
    """Whatever breaks them, what then holds of agreement or the riskiest also holds with ties."""
    record = judged(0, norms, pc_norms)
    truth = record["pc orders"]["L2"]
    broken = [
        {
            label: sorted(NAMES, key=lambda n, v=values: (v[NAMES.index(n)], random.random()))
            for label, values in table.items()
        }
        for table in (norms, pc_norms)
    ]
    found = claims(broken[0], broken[1] | {"L2": truth})
    held = claims_with_ties(record)
    for name in ("pc norms agree", "all find riskiest"):
        assert held[name] or not found[name]
    if held["only H1 finds safest"]:
        assert broken[0]["H1"][0] == truth[0] or norms["H1"].count(min(norms["H1"])) > 1
        assert all(broken[0][label][0] != truth[0] for label in ("L1", "L2", "L∞"))


def like(values):
    """The same norms of A to E for every label."""
    return {label: list(values) for label in LABELS}


def test_ties_at_the_ends():
    riskiest_is_d = [1, 2, 3, 5, 4]
    # D and E are tied by L-infinity of f, and the order puts E, which is longer, last
    record = judged(0, like(riskiest_is_d) | {"L∞": [1, 2, 3, 5, 5]}, like(riskiest_is_d))
    assert record["orders"]["L∞"][-1] == "E"
    assert not record["claims"]["all find riskiest"]
    assert claims_with_ties(record)["all find riskiest"]
    # the same by L-infinity of P_c
    record = judged(0, like(riskiest_is_d), like(riskiest_is_d) | {"L∞": [1, 2, 3, 5, 5]})
    assert not record["claims"]["pc norms agree"]
    assert claims_with_ties(record)["pc norms agree"]
    # B is the safest; L1 ties it with A, which is shorter, so L1 finds it too
    only_h1 = like([0, 1, 2, 3, 4]) | {"H1": [1, 0, 2, 3, 4], "L1": [0, 0, 2, 3, 4]}
    record = judged(0, only_h1, like([1, 0, 2, 3, 4]))
    assert record["claims"]["only H1 finds safest"]
    assert not claims_with_ties(record)["only H1 finds safest"]


@pytest.mark.parametrize("n", [1, 8, 197])
def test_the_interval_of_none_and_of_all(n):
    edge = 0.025 ** (1.0 / n)
    none, every = Share.of([False] * n), Share.of([True] * n)
    assert (none.count, none.total, none.low) == (0, n, 0.0)
    assert none.high == pytest.approx(1.0 - edge, rel=1e-9)
    assert (every.count, every.total, every.high) == (n, n, 1.0)
    assert every.low == pytest.approx(edge, rel=1e-9)


@given(st.integers(1, 40).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_leaves_out_an_eightieth_on_each_side(case):
    """At its ends what was found, or anything more extreme, has a probability of 2.5 %."""
    count, total = case
    share = Share.of([True] * count + [False] * (total - count))
    assert share.low <= count / total <= share.high
    if count > 0:
        assert stats.binom.sf(count - 1, total, share.low) == pytest.approx(0.025, abs=1e-9)
    if count < total:
        assert stats.binom.cdf(count, total, share.high) == pytest.approx(0.025, abs=1e-9)


def test_shares_in_words():
    assert str(Share.of([])) == "none"
    assert Share.of([]) == Share(0, 0, 0.0, 1.0)
    assert str(Share.of([True] * 2 + [False] * 6)) == "25 % [3, 65]"


def test_hits_by_hand():
    records = [
        {"orders": {"L1": "AB", "H1": "AB"}, "pc orders": {"L1": "AB", "H1": "BA"}},
        {"orders": {"L1": "AB", "H1": "BA"}, "pc orders": {"L1": "AB", "H1": "BA"}},
    ]
    counts = {f: {pc: s.count for pc, s in row.items()} for f, row in hits(records, 0).items()}
    assert counts == {"L1": {"L1": 2, "H1": 0}, "H1": {"L1": 1, "H1": 1}}
    three = [{"orders": {"L1": "ABC"}, "pc orders": {"L1": "ACB"}}]
    assert hits(three, 0)["L1"]["L1"] == Share.of([True])
    assert hits(three, -1)["L1"]["L1"] == Share.of([False])
    assert hits([], 0) == {}
