import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.avoidance import InverseDistance
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.ranking import rank
from ompl_risk.ranking.attribution import shortest_window
from ompl_risk.trajectory import Trajectory

T = np.arange(0.0, 41.0)
RISK = np.interp(T, [0, 5, 6, 7, 29, 30, 33, 34, 40], [0, 0, 0.02, 0, 0, 0.06, 0.06, 0, 0])
HEIGHTS = 1 / (RISK + 0.01)
TWO_BUMPS = Trajectory(T, np.stack([10 * T, 0 * T + 7, HEIGHTS], axis=1), "A")


def ranked(**options):
    norms = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))
    return rank(
        [TWO_BUMPS], lambda p: p[:, 2], InverseDistance(100.0), norms, max_step=None, **options
    )["A"]


def test_f_is_what_the_example_means():
    np.testing.assert_allclose(ranked().f, RISK, atol=1e-12)


def test_shares_of_two_bumps():
    """Areas 0.02 (a triangle) and 0.24 (a trapezium of 3 s and two flanks)."""
    part = ranked().attribution["L1"]
    assert part.shares.sum() == pytest.approx(1.0, rel=1e-14)
    assert part.shares[:10].sum() == pytest.approx(0.02 / 0.26, rel=1e-9)
    assert part.shares[29:34].sum() == pytest.approx(0.24 / 0.26, rel=1e-9)


def test_window_holds_the_share_and_no_shorter_one_does():
    part = ranked(window_share=0.65).attribution["L1"]
    assert (part.start, part.end) == (30.0, 33.0)
    assert part.share == pytest.approx(0.18 / 0.26, rel=1e-9)
    assert part.time == 30.0
    assert part.clearance == pytest.approx(1 / 0.07)
    np.testing.assert_allclose(part.position, [300, 7, 1 / 0.07])
    assert part.sentence == (
        "69% of L1 between t = 30.0 s and 33.0 s, closest near (300, 7) m with 14.3 m to spare"
    )


def test_norms_differ_in_where_they_come_from():
    """The plateau makes L2, the flanks (slope 0.06) make H1 with a long time scale."""
    found = rank(
        [TWO_BUMPS],
        lambda p: p[:, 2],
        InverseDistance(100.0),
        (Lp(2), Sobolev(1, time_scale=100)),
        max_step=None,
        window_share=0.25,
    )["A"]
    assert 30 <= found.attribution["L2"].start < found.attribution["L2"].end <= 33
    flank = found.attribution["H1(τ=100 s)"]
    assert (flank.start, flank.end) == (29.0, 30.0)


def test_a_maximum_is_attributed_to_its_moment():
    part = ranked().attribution["L∞"]
    assert part.start == part.end == part.time
    assert 30 <= part.time <= 33
    assert part.share == 1.0
    assert part.sentence.startswith("L∞ is reached at t = 3")


def test_segments_of_equal_duration():
    part = ranked().attribution["L1"]
    np.testing.assert_allclose(
        part.segments(4), [0.02 / 0.26, 0, 0.03 / 0.26, 0.21 / 0.26], atol=1e-9
    )
    assert part.segments(1) == pytest.approx([1.0])
    assert part.segments(7).sum() == pytest.approx(1.0)
    with pytest.raises(ArgumentError, match="count = 0"):
        part.segments(0)


def test_no_risk_has_no_origin():
    far = Trajectory([0, 1], [[0, 0, 500], [1, 0, 500]], "far")
    found = rank([far], lambda p: p[:, 2], InverseDistance(100.0))["far"]
    assert found.attribution == dict.fromkeys(found.norms)


@given(
    st.lists(st.integers(0, 9), min_size=1, max_size=12).filter(any),
    st.data(),
    st.sampled_from([0.1, 0.5, 0.8, 1.0]),
)
def test_window_against_all_windows(weights, data, share):
    n = len(weights)
    steps = data.draw(st.lists(st.integers(1, 5), min_size=n, max_size=n))
    t = np.concatenate([[0.0], np.cumsum(steps)])
    shares = np.array(weights) / sum(weights)
    i, j = shortest_window(t, shares, share)
    assert shares[i:j].sum() >= share * (1 - 1e-9)
    wide_enough = [
        t[b] - t[a]
        for a in range(n)
        for b in range(a + 1, n + 1)
        if sum(weights[a:b]) >= share * sum(weights) * (1 - 1e-9)
    ]
    assert t[j] - t[i] == min(wide_enough)


def test_attributions_are_found_when_asked_for_and_once(monkeypatch):
    calls = []

    class Counted(Lp):
        def shares(self, t, f):
            calls.append(self.p)
            return super().shares(t, f)

    found = rank(
        [TWO_BUMPS], lambda p: p[:, 2], InverseDistance(100.0), [Counted(1), Counted(2)],
        max_step=None,
    )["A"]  # fmt: skip
    assert calls == []
    assert list(found.attribution) == list(found.norms)
    part = found.attribution["L2"]
    assert found.attribution["L2"] is part
    assert calls == [2.0]
    assert part.shares == pytest.approx(ranked().attribution["L2"].shares, rel=1e-15)
    with pytest.raises(KeyError):
        found.attribution["L7"]
    assert len(found.attribution) == 2
    assert "L1" in found.attribution
    assert repr(found.attribution) == "Attributions(L1, L2)"


def test_a_ranking_is_the_same_after_pickling():
    found = rank([TWO_BUMPS], HeightOnly(), InverseDistance(100.0), [Lp(1)], max_step=None)
    again = pickle.loads(pickle.dumps(found))
    assert again["A"].attribution["L1"].start == found["A"].attribution["L1"].start


class HeightOnly:
    def __call__(self, points):
        return points[:, 2]
