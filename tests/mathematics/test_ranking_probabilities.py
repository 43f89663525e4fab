"""A ranking with probabilities that whole trajectories end in collision."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from ompl_risk import InverseDistance, Trajectory, rank
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation import CollisionEstimate


def estimate(p, half=0.01):
    return SimpleNamespace(probability=p, low=max(p - half, 0.0), high=min(p + half, 1.0))


@pytest.fixture(scope="module")
def flights():
    return [
        Trajectory([0.0, 10.0], [[0.0, 0.0, z], [200.0, 0.0, z]], name)
        for name, z in (("low", 20.0), ("high", 60.0), ("middle", 40.0))
    ]


def above_plane(points):
    return points[:, 2]


def ranked(flights, probability):
    return rank(flights, above_plane, InverseDistance(100.0), probability=probability)


class Profile:
    t = np.array([0.0, 10.0])
    p = np.array([0.1, 0.1])


def test_estimates_are_ranked_and_compared(flights):
    ranking = ranked(flights, [estimate(0.3), estimate(0.01), estimate(0.1)])
    assert ranking.probability_order == ("high", "middle", "low")
    assert ranking.probability_agreement.tau[:, 0] == pytest.approx([1.0] * 4)
    assert not ranking.has_probability
    turned = ranked(flights, {"low": estimate(0.0), "high": estimate(0.5), "middle": estimate(0.1)})
    assert turned.probability_order == ("low", "middle", "high")
    assert turned.probability_agreement.tau[:, 0] == pytest.approx([-1.0] * 4)
    assert turned["high"].estimate.probability == 0.5


def test_profile_and_estimate_together(flights):
    ranking = ranked(flights, [(Profile(), estimate(p)) for p in (0.3, 0.01, 0.1)])
    assert ranking.has_probability
    assert ranking.has_estimates
    assert ranking["low"].pc_norms["L1"] == pytest.approx(1.0)


def test_without_estimates_nothing_is_claimed(flights):
    ranking = ranked(flights, None)
    assert ranking.probability_order == ()
    assert ranking.probability_agreement is None
    assert "robability" not in str(ranking)


def test_a_zero_is_never_bare(flights):
    text = str(ranked(flights, [estimate(0.3), estimate(0.0), estimate(0.1)]))
    line = next(row for row in text.splitlines() if "none seen" in row)
    assert "high" in line
    assert "0.01" in line


def test_all_of_the_least_are_marked(flights):
    text = str(ranked(flights, [estimate(0.3), estimate(0.0), estimate(0.0)]))
    assert text.count("* none seen") == 2


def flown(name, hits, weight=None):
    collided = np.full(100, np.inf)
    collided[:hits] = 1.0
    weights = None if weight is None else np.full(100, weight)
    nothing = np.zeros(100)
    return CollisionEstimate(
        name, nothing, nothing, np.zeros((100, 3)), collided, weights=weights, heaviest=4.0
    )


def test_weighted_rollouts_say_what_they_may_have_missed(flights):
    estimates = [flown(one.name, 5, 1e-3) for one in flights]
    text = str(ranked(flights, estimates))
    assert text.count("5 of 100 rollouts, weighted") == 3
    assert text.count(f"whatever was missed at most {estimates[0].upper_bound():.3g}") == 3
    plain = str(ranked(flights, [flown(one.name, 5) for one in flights]))
    assert "5 of 100 rollouts" in plain
    assert "weighted" not in plain


def test_exports_say_what_estimates_rest_on(flights):
    ranking = ranked(flights, [flown(one.name, 5) for one in flights])
    said = json.loads(ranking.to_json())["trajectories"][0]["probability"]
    assert (said["hits"], said["rollouts"], said["confidence"]) == (5, 100, 0.95)
    assert ranking.to_pandas().loc["low", "rollouts"] == 100


def test_an_estimate_of_another_trajectory_is_refused(flights):
    estimates = [flown(one.name, k) for k, one in enumerate(flights)]
    assert ranked(flights, estimates).probability_order == ("low", "high", "middle")
    with pytest.raises(ArgumentError, match=r"\['low'\] = \"that of 'middle'\""):
        ranked(flights, estimates[::-1])
    assert ranked(flights, [flown("", k) for k in range(3)]).has_estimates


def test_exports(flights):
    ranking = ranked(flights, [estimate(0.3), estimate(0.01), estimate(0.1)])
    data = json.loads(ranking.to_json())
    assert data["probability_order"] == ["high", "middle", "low"]
    assert data["trajectories"][0]["probability"]["probability_high"] == pytest.approx(0.31)
    frame = ranking.to_pandas()
    assert frame.loc["middle", "probability"] == 0.1


@pytest.mark.parametrize(
    ("given", "named"),
    [
        (estimate(0.1), "probability = .*must be a list"),
        ("high", "probability = 'high'"),
        ([estimate(0.1)], r"len\(probability\)"),
        ({"low": estimate(0.1)}, "probability"),
        ([0.3, 0.1, 0.2], r"probability\['low'\]"),
        ([(), estimate(0.1), estimate(0.1)], r"probability\['low'\]"),
        ([(estimate(0.1), estimate(0.1))] * 3, r"probability\['low'\]"),
        ([Profile(), estimate(0.1), estimate(0.1)], r"probability\['high'\]"),
        ([estimate(0.1), estimate(float("nan")), estimate(0.1)], r"probability\['high'\]"),
    ],
)
def test_wrong_probabilities_are_refused(flights, given, named):
    with pytest.raises(ArgumentError, match=named):
        ranked(flights, given)
