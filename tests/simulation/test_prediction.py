"""Probabilities predicted from stated errors, against rollouts."""

import math

import numpy as np
import pytest

from ompl_risk import TerrainClearance, Trajectory, terrains
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.closed_loop import closed_loop_probability
from ompl_risk.simulation.disturbances import Disturbances
from ompl_risk.simulation.disturbances.gusts import DrydenGusts
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.prediction import errors_of, predicted_probability


@pytest.fixture(scope="module")
def plain():
    ground = terrains.Terrain(np.zeros((81, 81)), spacing=(50.0, 50.0))
    return TerrainClearance(ground, radius=5.0)


def flight(height, name="", length=1500.0):
    return Trajectory(
        [0.0, length / 25.0], [[1000.0, 2000.0, height], [1000.0 + length, 2000.0, height]], name
    )


def test_errors_follow_from_the_disturbances():
    model = errors_of(Disturbances.level("moderate"), 25.0)
    heave, of_map = 0.1 * 30.0 * 1852 / 3600, 16 / 1.645
    assert model.passing == pytest.approx(math.hypot(of_map, heave))
    rate = math.hypot(of_map * 25.0 / 300.0, heave)
    assert model.passing / model.correlation_time == pytest.approx(rate)
    assert model.lasting == pytest.approx(13.0 / 1.959964, rel=0.01)


def test_a_constant_error_of_the_map_is_the_normal_tail(plain):
    error = TerrainError(deviation=6.0, correlation_length=1e9)
    found = predicted_probability(flight(17.0, "A"), plain, Disturbances(terrain=error))
    assert found == {"A": pytest.approx(0.5 * math.erfc(2.0 / math.sqrt(2.0)), rel=0.05)}


@pytest.mark.parametrize("level", ["calm", "moderate", "severe"])
def test_rollouts_agree_within_a_factor_of_two(plain, level):
    """A point mass over a plain, high enough that collisions are not the rule."""
    heights = {"calm": 18.0, "moderate": 30.0, "severe": 45.0}
    disturbances = Disturbances.level(level)
    plan = flight(heights[level], level)
    (flown,) = closed_loop_probability(plan, plain, disturbances, rollouts=2000, seed=3)
    predicted = predicted_probability(plan, plain, disturbances)[level]
    assert flown.hits > 20
    assert 0.5 * flown.low < predicted < 2.0 * flown.high


def test_order_is_that_of_the_heights(plain):
    plans = [flight(h, f"{h:g}") for h in (40.0, 20.0, 30.0)]
    found = predicted_probability(plans, plain, Disturbances.level("moderate"))
    assert list(found) == ["40", "20", "30"]
    assert found["40"] < found["30"] < found["20"]


def test_nothing_to_err_by_is_no_danger(plain):
    assert predicted_probability(flight(20.0, "A"), plain, Disturbances())["A"] < 1e-12
    still = Disturbances(gusts=DrydenGusts(1e-3))
    assert predicted_probability(flight(20.0, "A"), plain, still)["A"] < 1e-12


def test_plans_that_collide_or_leave_the_map_are_certain(plain):
    plans = [flight(4.0, "low"), flight(50.0, "off", length=4000.0)]
    assert predicted_probability(plans, plain, Disturbances()) == {"low": 1.0, "off": 1.0}


def test_wrong_arguments_are_refused(plain):
    with pytest.raises(ArgumentError, match="clearance"):
        predicted_probability(flight(20.0), lambda points: points[:, 2], Disturbances())
    with pytest.raises(ArgumentError, match="disturbances"):
        predicted_probability(flight(20.0), plain, "moderate")
    with pytest.raises(ArgumentError, match="speed"):
        errors_of(Disturbances(), 0.0)
