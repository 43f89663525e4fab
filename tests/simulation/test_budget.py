"""The fastest candidate within a risk budget: planted probabilities, and real rollouts."""

import numpy as np
import pytest

from ompl_risk import TerrainClearance, Trajectory, terrains
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation import budget as module
from ompl_risk.simulation.budget import fastest_within
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.estimate import CollisionEstimate


def planted(monkeypatch, probabilities):
    """Rollouts that collide with these probabilities, by candidate."""
    asked = []

    def stand_in(place, _clearance, _disturbances, *, seed, confidence, until, **_):
        asked.append((place, confidence, seed))
        random = np.random.default_rng([seed, place])
        looks = until.looks(confidence)
        hit = random.random(looks[-1]) < probabilities[place]
        for n in looks:
            collided = np.where(hit[:n], 1.0, np.inf)
            found = CollisionEstimate(
                str(place), np.where(hit[:n], 0.0, 1.0), np.zeros(n), np.zeros((n, 3)), collided,
                confidence=confidence, looks=len(looks),
            )  # fmt: skip
            if until.done(found):
                break
        return (found,)

    monkeypatch.setattr(module, "closed_loop_probability", stand_in)
    return asked


def search(probabilities, **options):
    given = {"budget": 1e-2, "most": 20_000, **options}
    allowed = given.pop("budget")
    return fastest_within(lambda k: k, len(probabilities), None, Disturbances(), allowed, **given)


@pytest.mark.parametrize("first", [0, 1, 17, 63, 98, 99])
def test_falling_probabilities_give_the_fastest(monkeypatch, first):
    planted(monkeypatch, np.where(np.arange(100) < first, 0.05, 1e-3))
    found = search(np.where(np.arange(100) < first, 0.05, 1e-3))
    assert found.chosen == first
    assert found.estimate.upper_bound() <= 1e-2
    assert len(found.tried) <= 16 + 7


def test_none_keeps_to_it(monkeypatch):
    planted(monkeypatch, [0.3, 0.2, 0.05])
    found = search([0.3, 0.2, 0.05])
    assert found.chosen is None
    assert found.estimate is None
    assert found.nearest == 2
    assert "none keeps to 0.01" in str(found)


def test_doubtful_candidates_are_not_chosen(monkeypatch):
    planted(monkeypatch, [9.9e-3, 1e-4])  # 20,000 rollouts cannot tell the first from 1e-2
    assert search([9.9e-3, 1e-4]).chosen == 1


def test_error_is_shared_out_among_the_trials(monkeypatch):
    asked = planted(monkeypatch, [0.05] * 40)
    search([0.05] * 40, confidence=0.9)
    assert all(confidence == pytest.approx(1 - 0.1 / (16 + 6)) for _, confidence, _ in asked)


def test_each_trial_has_random_numbers_of_its_own(monkeypatch):
    """With common ones a lucky sample would choose the next trial as well as pass it."""
    probabilities = np.where(np.arange(40) < 30, 0.05, 1e-3)
    asked = planted(monkeypatch, probabilities)
    search(probabilities, seed=3)
    once = {place: seed for place, _, seed in asked}
    assert len(set(once.values())) == len(asked) > 10
    asked.clear()
    search(probabilities, seed=3)
    assert {place: seed for place, _, seed in asked} == once
    asked.clear()
    search(probabilities, seed=4)
    assert not {seed for _, _, seed in asked} & set(once.values())


def test_confidence_holds_over_many_searches(monkeypatch):
    """All candidates are a little worse than allowed: few searches may accept any."""
    probabilities = [0.0115] * 20
    planted(monkeypatch, probabilities)
    wrong = sum(search(probabilities, seed=s, most=4000).chosen is not None for s in range(150))
    assert wrong <= 13  # P(more than 13 of 150 at 5 %) is 0.02


def test_flights_over_an_uncertain_plain():
    """Ground that is higher by one normal number: P(collision) = Q((height - radius) / sigma)."""
    plain = terrains.Terrain(np.zeros((41, 41)), spacing=(50.0, 50.0))
    clearance = TerrainClearance(plain, radius=5.0)
    error = TerrainError(deviation=5.0, correlation_length=1e7)

    def flight(k):
        z = 8.0 + 4.0 * k
        return Trajectory([0.0, 10.0], [[800.0, 1000.0, z], [1000.0, 1000.0, z]], f"{z:g} m")

    found = fastest_within(flight, 6, clearance, Disturbances(terrain=error), 0.02)
    # Q(0.6), Q(1.4), Q(2.2) = 0.014 is near the budget, Q(3.0) = 0.0013 keeps to it
    assert found.chosen in (2, 3)
    assert found.tried[0].decided(0.02) == "above"
    assert found.tried[1].decided(0.02) == "above"


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"budget": 0.0}, "budget"),
        ({"budget": 1.0}, "budget"),
        ({"confidence": 1.0}, "confidence"),
        ({"most": 0}, "most"),
        ({"seed": -1}, "seed"),
    ],
)
def test_wrong_values_are_refused(options, named):
    with pytest.raises(ArgumentError, match=named):
        search([0.1], **options)


def test_no_candidates_are_refused():
    with pytest.raises(ArgumentError, match="candidates"):
        search([])
