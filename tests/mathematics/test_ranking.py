import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

from ompl_risk.avoidance import InverseDistance
from ompl_risk.errors import ArgumentError, CollisionError, DurationWarning
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.ranking import DEFAULT_NORMS, rank
from ompl_risk.trajectory import Trajectory

AVOIDANCE = InverseDistance(100.0)
T = np.linspace(0.0, 10.0, 11)


def above_ground(points):
    return points[:, 2]


def flight(heights, name, t=T):
    """Level flight at given heights: f is known at the samples."""
    z = np.broadcast_to(np.asarray(heights, dtype=float), t.shape)
    return Trajectory(t, np.stack([30 * t, 0 * t, z], axis=1), name)


def ranked(trajectories, norms=DEFAULT_NORMS, **options):
    return rank(trajectories, above_ground, AVOIDANCE, norms, max_step=None, **options)


HIGH, LOW, DEEP = flight(80, "high"), flight(50, "low"), flight([90] * 5 + [20] + [90] * 5, "deep")


def test_norms_of_level_flight_in_closed_form():
    """f = 1/50 - 1/100 for 10 s."""
    low = ranked([LOW])["low"]
    expected = {"L1": 0.1, "L2": 0.01 * math.sqrt(10), "L∞": 0.01, "H1": 0.01 * math.sqrt(10)}
    assert low.norms == pytest.approx(expected, rel=1e-14)
    assert (low.duration, low.length, low.min_clearance) == (10.0, 300.0, 50.0)
    assert not low.collides
    np.testing.assert_array_equal(low.f, [1 / 50 - 1 / 100] * 11)


def test_orders_safest_riskiest_best():
    ranking = ranked([DEEP, LOW, HIGH])
    assert ranking.orders["L1"] == ("high", "deep", "low")
    assert ranking.orders["L∞"] == ("high", "low", "deep")
    assert ranking.safest("L1") == "high"
    assert ranking.riskiest("L1") == "low"
    assert ranking.riskiest("L∞") == "deep"
    assert ranking.best("H1") is HIGH
    assert [a.name for a in ranking.assessments] == ["deep", "low", "high"]
    assert ranking["deep"].min_clearance == 20.0
    assert ranking["deep"].min_clearance_time == 5.0
    np.testing.assert_array_equal(ranking["deep"].min_clearance_position, [150, 0, 20])


def test_ties_go_to_the_shorter_duration_then_to_the_order_of_input():
    quick, slow = flight(200, "quick", 0.99 * T), flight(200, "slow")
    again = flight(150, "again")
    ranking = ranked([slow, again, quick])
    assert ranking.orders["H1"] == ("quick", "slow", "again")


def test_collisions_come_last_and_say_where():
    hit = flight([60] * 3 + [0, -5] + [60] * 6, "hit")
    ranking = ranked([hit, LOW])
    assert ranking.orders["L1"] == ("low", "hit")
    found = ranking["hit"]
    assert found.collides
    assert found.norms == dict.fromkeys(ranking.labels, math.inf)
    assert found.collision_time == 3.0
    np.testing.assert_array_equal(found.collision_position, [90, 0, 0])
    assert found.min_clearance == -5.0
    assert ranking.pareto("L1") == ("low",)


def test_no_safest_among_collisions():
    ranking = ranked([flight(0, "a"), flight(-1, "b")])
    for question in (ranking.safest, ranking.best):
        with pytest.raises(CollisionError, match=r"none of .* a, b"):
            question("L1")
    assert ranking.orders["L1"] == ("a", "b")
    assert ranking.pareto("L1") == ()


def test_durations_within_the_tolerance_are_silent():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ranking = ranked([flight(50, "a"), flight(50, "b", 1.04 * T)])
    assert ranking.durations_comparable
    assert ranking.duration_spread == pytest.approx(0.04)


def test_durations_beyond_the_tolerance_are_reported():
    pair = [flight(50, "a", 1.2 * T), flight(50, "b")]
    with pytest.warns(DurationWarning, match=r"20 %, more than 5 %: b takes 10 s, a 12 s.*pareto"):
        ranking = ranked(pair)
    assert not ranking.durations_comparable
    assert (ranking.fastest.name, ranking.slowest.name) == ("b", "a")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ranked(pair, duration_tolerance=0.25)


def test_the_warning_points_at_the_caller():
    with pytest.warns(DurationWarning) as caught:
        rank([flight(50, "a"), flight(50, "b", 2 * T)], above_ground, AVOIDANCE)
    assert caught[0].filename == __file__


def test_pareto_set_of_duration_and_norm():
    """L-infinity depends on the height alone: (duration, height) are chosen freely."""
    plan = {
        "a": (10, 20),
        "b": (11, 40),
        "c": (11, 30),
        "d": (12, 40),
        "e": (13, 60),
        "e2": (13, 60),
    }
    trajectories = [flight(z, name, T * duration / 10) for name, (duration, z) in plan.items()]
    ranking = ranked(trajectories, duration_tolerance=1.0)
    assert ranking.pareto("L∞") == ("a", "b", "e", "e2")


def test_probability_is_ranked_by_the_same_norms():
    def profile(level):
        return SimpleNamespace(t=T, p=np.full(11, level))

    by_name = {"low": profile(0.1), "high": profile(0.2)}
    ranking = ranked([LOW, HIGH], probability=by_name)
    assert ranking["low"].pc_norms["L1"] == pytest.approx(1.0)
    assert ranking["high"].pc_norms["L∞"] == pytest.approx(0.2)
    assert ranking.pc_orders["L2"] == ("low", "high")
    assert ranking.orders["L2"] == ("high", "low")
    assert ranking.pc_agreement["L2", "L1"] == -1.0
    in_order = ranked([LOW, HIGH], probability=[profile(0.1), profile(0.2)])
    assert in_order.pc_orders == ranking.pc_orders
    without = ranked([LOW, HIGH])
    assert without.pc_orders == {}
    assert without.pc_agreement is None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"trajectories": []}, "trajectories = .*at least one"),
        ({"trajectories": [LOW, HIGH, LOW]}, r"trajectories\[2\] = 'low'.*\[0\] too"),
        ({"trajectories": ["low"]}, "class Trajectory"),
        ({"norms": []}, "norms = .*at least one"),
        ({"norms": [Lp(2), Sobolev(1), Lp(2)]}, r"norms\[2\] = 'L2'.*\[0\] too"),
        ({"norms": [max]}, "class Norm"),
        ({"norms": "H1"}, r"norms = 'H1'.*a list.*Sobolev\(1\)"),
        ({"duration_tolerance": -0.1}, "duration_tolerance = -0.1"),
        ({"duration_tolerance": math.nan}, "duration_tolerance = nan"),
        ({"max_step": 0}, "max_step = 0"),
        ({"max_step": "fine"}, "max_step = 'fine'.*auto"),
        ({"window_share": 0.0}, "window_share = 0.0"),
        ({"window_share": 1.1}, "window_share = 1.1"),
        ({"probability": []}, r"len\(probability\) = 0: must be 1"),
        ({"probability": {"high": None}}, r"probability = \['high'\].*\['low'\]"),
    ],
)
def test_what_rank_refuses(options, words):
    arguments = {"trajectories": [LOW], "clearance": above_ground, "avoidance": AVOIDANCE} | options
    with pytest.raises(ArgumentError, match=words):
        rank(**arguments)


def test_unknown_labels_and_names():
    ranking = ranked([LOW])
    for question in (ranking.safest, ranking.riskiest, ranking.best, ranking.pareto):
        with pytest.raises(ArgumentError, match="label = 'H7': must be one of L1, L2, L∞, H1"):
            question("H7")
    with pytest.raises(KeyError):
        ranking["A"]
