"""From plans to probabilities: common random numbers, blocks, rules when to stop."""

from __future__ import annotations

import math

import loop_scene
import numpy as np
import pytest
from level_plan import LevelPlan, flat
from scipy import stats

from ompl_risk import Trajectory
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation import closed_loop
from ompl_risk.simulation.closed_loop import as_plans, closed_loop_probability
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.intervals import counted
from ompl_risk.simulation.estimates.paired import compare
from ompl_risk.simulation.estimates.until import Count, Decided, Narrow
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan
from ompl_risk.simulation.loop.rollouts import fly

SIGMA = 10.0
CONSTANT = Disturbances(terrain=TerrainError(SIGMA, math.inf, waves=8))
WAVY = Disturbances(terrain=TerrainError(SIGMA, 300.0, waves=16))


def height(p: float) -> float:
    """Clearance that a constant error of the map exceeds with probability p."""
    return float(SIGMA * stats.norm.isf(p))


def probability(plans, disturbances=CONSTANT, **rest):
    return closed_loop_probability(plans, flat(), disturbances, threads=1, **rest)


def test_the_normal_tail_within_its_interval():
    (found,) = probability(LevelPlan(height(0.1), "A"), rollouts=2000, confidence=0.999)
    assert found.low < 0.1 < found.high
    assert (found.name, found.rollouts, found.seed, found.confidence) == ("A", 2000, 0, 0.999)
    assert found.weights is None
    assert (found.low, found.high) == pytest.approx(counted(found.hits, 2000, 0.0005))


def test_every_plan_meets_the_same_ground():
    """One plan 1 m above the other: d differs by 1 m in every single rollout that is free."""
    low, high = probability([LevelPlan(15.0, "low"), LevelPlan(16.0, "high")], WAVY, rollouts=300)
    free = ~low.collides
    assert (high.least - low.least)[free] == pytest.approx(np.ones(free.sum()), abs=1e-9)
    assert compare(low, high).less == 0


def test_a_rollout_does_not_depend_on_how_many_there_are_nor_on_the_other_plans():
    plans = [LevelPlan(15.0, "A", shake=3.0), LevelPlan(16.0, "B", shake=3.0)]
    many, few = probability(plans, WAVY, rollouts=200), probability(plans[1], WAVY, rollouts=50)
    assert np.array_equal(many[1].least[:50], few[0].least)
    assert not np.array_equal(
        probability(plans[1], WAVY, rollouts=50, seed=1)[0].least, few[0].least
    )


def test_blocks_join_to_what_one_block_gives():
    plan = LevelPlan(30.0, "A", shake=3.0)
    (blocks,) = probability(plan, WAVY, until=Narrow(1e-9, first=50, most=300))
    (whole,) = probability(plan, WAVY, rollouts=300)
    for field in ("least", "when", "where", "collided", "endings"):
        assert np.array_equal(getattr(blocks, field), getattr(whole, field))
    assert blocks.looks == 4  # 50, 100, 200, 300
    assert blocks.high > whole.high


def test_estimates_are_reported_as_they_come():
    said = []
    found = probability([LevelPlan(20.0), LevelPlan(25.0)], rollouts=20, on_plan=said.append)
    assert tuple(said) == found
    assert [each.name for each in said] == ["plan 1", "plan 2"]


def test_portions_are_reported_and_join_to_the_same(monkeypatch):
    plan, flown = LevelPlan(30.0, "A", shake=3.0), []
    (whole,) = probability(plan, WAVY, rollouts=100)
    monkeypatch.setattr(closed_loop, "PORTION", 30)
    (parts,) = probability(plan, WAVY, rollouts=100, on_rollouts=flown.append)
    assert flown == [30, 60, 90, 100]
    for field in ("least", "when", "where", "collided", "endings"):
        assert np.array_equal(getattr(parts, field), getattr(whole, field))


def test_narrow_stops_at_the_first_look_that_is_narrow_enough():
    plan = LevelPlan(height(0.3), "A")
    (found,) = probability(plan, until=Narrow(0.1, first=64, most=4096))
    assert found.high - found.low <= 0.1
    assert found.looks == 7
    half = found.rollouts // 2
    before = counted(int(found.collides[:half].sum()), half, 0.025 / 7)
    assert before[1] - before[0] > 0.1
    (most,) = probability(plan, until=Narrow(1e-6, first=64, most=100))
    assert most.rollouts == 100


@pytest.mark.parametrize(("p", "side"), [(1e-5, "below"), (0.2, "above"), (0.5, "above")])
def test_a_threshold_is_decided_with_few_rollouts(p, side):
    rule = Decided(0.01)
    (found,) = probability(LevelPlan(height(p), "A"), until=rule)
    assert found.decided(0.01) == side
    assert found.rollouts == rule.looks(0.95)[2 if side == "below" else 0]


def test_near_the_threshold_it_may_stay_open():
    (found,) = probability(LevelPlan(height(0.01), "A"), until=Decided(0.01, most=600))
    assert found.decided(0.01) == "open"
    assert found.rollouts == 600


@pytest.mark.parametrize("threshold", [0.5, 0.3, 0.01, 1e-3, 1e-5])
@pytest.mark.parametrize("confidence", [0.8, 0.95, 0.999])
def test_looks_are_placed_where_no_hit_decides(threshold, confidence):
    looks = Decided(threshold).looks(confidence)
    error = (1.0 - confidence) / len(looks)
    deciding = [n for n in looks if counted(0, n, error)[1] <= threshold]
    assert deciding
    assert counted(0, deciding[0] - 1, error)[1] > threshold * (1.0 - 0.02)
    assert list(looks) == sorted(set(looks))


@pytest.mark.parametrize("p", [0.02, 0.0201])
def test_stopping_early_does_not_make_decisions_wrong_too_often(p):
    """Simulated counts at the threshold itself, where the wrong side is decided most easily."""
    rng, rule, runs = np.random.default_rng(0), Decided(0.02), 1000
    looks, wrong = rule.looks(0.9), {"below": 0, "above": 0}
    error = 0.1 / len(looks)
    for _ in range(runs):
        hits = np.cumsum(rng.random(looks[-1]) < p)[np.array(looks) - 1]
        for n, k in zip(looks, hits, strict=True):
            low, high = counted(int(k), n, error)
            if high <= 0.02 or low > 0.02:
                wrong["below" if high <= 0.02 else "above"] += 1
                break
    limit = stats.binom.ppf(0.9999, runs, 0.1)
    assert wrong["below"] <= limit
    assert p > 0.02 or wrong["above"] <= limit


def test_count_is_a_fixed_number():
    (counts,) = probability(LevelPlan(20.0, "A"), until=Count(70))
    (fixed,) = probability(LevelPlan(20.0, "A"), rollouts=70)
    assert counts.to_dict() == fixed.to_dict()
    assert probability(LevelPlan(20.0, "A"))[0].rollouts == 1000


def test_what_serves_as_a_plan():
    path = Trajectory([0.0, 10.0], [[0.0, 0.0, 50.0], [200.0, 0.0, 50.0]], name="path")
    names, plans = zip(*as_plans([path, LevelPlan(1.0)]), strict=True)
    assert names == ("path", "plan 2")
    assert plans[0].positions[-1] == pytest.approx([200.0, 0.0, 50.0], abs=1.0)
    single = LevelPlan(1.0, "one")
    assert as_plans(single) == [("one", single)]


def test_a_flight_is_flown_by_its_helicopter():
    one, calm = loop_scene.flight(seconds=3.0), Disturbances.level("calm")
    (found,) = closed_loop_probability(one, loop_scene.ground(), calm, rollouts=12, threads=1)
    direct = fly(HelicopterPlan(one), loop_scene.ground(), calm, Draws.make(12, 0, calm), threads=1)
    assert np.array_equal(found.least, direct.least)
    assert found.name == "plan 1"
    assert len(set(found.least.tolist())) == 12


@pytest.mark.parametrize(
    ("plans", "argument"),
    [
        (3, "plans"),
        ([], "plans"),
        ([LevelPlan(1.0, "A"), 3], "plans[1]"),
        ([LevelPlan(1.0, "A"), LevelPlan(2.0, "A")], "plans[1]"),
    ],
)
def test_what_does_not(plans, argument):
    with pytest.raises(ArgumentError) as caught:
        probability(plans)
    assert caught.value.argument == argument


@pytest.mark.parametrize(
    ("rest", "argument"),
    [
        ({"rollouts": 0}, "rollouts"),
        ({"rollouts": 10.0}, "rollouts"),
        ({"rollouts": 10, "until": Count(10)}, "rollouts"),
        ({"until": 10}, "until"),
        ({"seed": -1}, "seed"),
        ({"confidence": 1.0}, "confidence"),
        ({"importance": True}, "importance"),
        ({"disturbances": None}, "disturbances"),
    ],
)
def test_wrong_arguments_are_named(rest, argument):
    with pytest.raises(ArgumentError) as caught:
        probability(LevelPlan(9.0, "A"), **rest)
    assert caught.value.argument == argument


def test_a_clearance_must_be_callable():
    with pytest.raises(ArgumentError, match="clearance"):
        closed_loop_probability(LevelPlan(9.0), 3, CONSTANT)


@pytest.mark.parametrize(
    ("rule", "argument"),
    [
        (lambda: Count(0), "rollouts"),
        (lambda: Count(True), "rollouts"),
        (lambda: Narrow(0.0), "width"),
        (lambda: Narrow(0.1, first=0), "first"),
        (lambda: Narrow(0.1, first=10, most=9), "most"),
        (lambda: Decided(0.0), "threshold"),
        (lambda: Decided(1.0), "threshold"),
        (lambda: Decided(0.1, most=0), "most"),
    ],
)
def test_wrong_rules_are_refused(rule, argument):
    with pytest.raises(ArgumentError) as caught:
        rule()
    assert caught.value.argument == argument
