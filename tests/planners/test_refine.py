"""Refining paths: less risk, no more time, verified; the gradient behind it."""

import math
from itertools import pairwise

import numpy as np
import pytest
from flown_paths import (
    D0,
    NORMS,
    dense,
    hills,
    least_norm_over_flat_ground,
    left_open,
    norm_along,
    power,
    power_along,
    walk,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.improve import Outcome, improve_path, refine
from ompl_risk.planners.improve.judge import FINE
from ompl_risk.terrains import Terrain

SPEED = 12.0
HIGH = np.array([0.0, 0.0, 70.0])


def level(heights, spacing=25.0):
    return TerrainClearance(Terrain(heights, spacing=(spacing, spacing)), threads=1)


@pytest.fixture(scope="module")
def flat():
    return level(np.zeros((41, 41)))


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 10_000), corners=st.integers(2, 9), margin=st.sampled_from([0.0, 7.0]))
def test_neither_norm_nor_duration_ever_rises(norm, seed, corners, margin):
    clearance = TerrainClearance(hills(seed), radius=1.0, threads=1)
    path, risk = walk(clearance, seed, corners), Risk(InverseDistance(D0), norm, speed=SPEED)
    low, high = path.min(axis=0) - 20.0, path.max(axis=0) + np.array([20.0, 20.0, 0.0])
    result = refine(
        path,
        clearance=clearance,
        risk=risk,
        obstacles=clearance.with_radius(1.0 + margin),
        low=low,
        high=high,
        seconds=60.0,
    )
    new = result.positions
    np.testing.assert_array_equal(new[[0, -1]], path[[0, -1]])
    assert (new >= low).all()
    assert (new <= high).all()
    assert dense(clearance, new)[1].min() > margin
    (old, u), (after, v) = (power_along(clearance, p, norm, SPEED) for p in (path, new))
    unknown = left_open(risk, result.before.duration) + u + v
    assert after <= old + unknown
    assert dense(clearance, new)[0][-1] <= dense(clearance, path)[0][-1] * (1 + 1e-12)
    assert power(norm, result.before.norm) == pytest.approx(old, rel=3e-3, abs=unknown)
    assert result.after.clearance == pytest.approx(dense(clearance, new)[1].min(), rel=2e-3)
    if result.outcome is Outcome.UNCHANGED:
        assert result.reason
        np.testing.assert_array_equal(new, path)
    else:
        assert after < old + unknown


@pytest.mark.parametrize("slack", [1.01, 1.05])
@pytest.mark.parametrize("norm", [Sobolev(1), Sobolev(1, time_scale=5.0), Lp(1), Lp(2), Lp(4)])
def test_over_flat_ground_it_comes_close_to_the_optimum(flat, norm, slack):
    longest = slack * 800.0 / SPEED
    with np.errstate(all="ignore"):  # trial values of the root finder
        least = least_norm_over_flat_ground(norm, 200.0, 30.0, 800.0, longest, SPEED)
    path = np.array([[100, 500, 30], [500, 600, 35], [900, 500, 30.0]])
    risk = Risk(InverseDistance(200.0), norm, speed=SPEED)
    result = refine(path, clearance=flat, risk=risk, longest=longest, seconds=60.0)
    assert result.after.duration <= longest
    assert least * (1 - FINE) <= result.after.norm <= 1.03 * least


def test_in_a_valley_the_path_goes_to_the_middle():
    """Both sides are equally near there: a kink of d, and the best that the ceiling allows."""
    across = np.abs(np.arange(-20, 21) * 25.0)[:, None] * np.ones(81)
    valley = level(across)
    path = np.array([[100, 540, 80], [700, 550, 80], [1300, 450, 80], [1900, 460, 80.0]])
    for norm in (Sobolev(1), Lp(1), Lp(2)):
        result = refine(
            path,
            clearance=valley,
            risk=Risk(InverseDistance(100.0), norm, speed=SPEED),
            high=[2000, 1000, 80],
            longest=1.1 * 1900 / SPEED,
            seconds=60.0,
        )
        inner = np.linspace(600.0, 1400.0, 50)
        order = result.positions[np.argsort(result.positions[:, 0])]
        middle, height = (np.interp(inner, order[:, 0], order[:, k]) for k in (1, 2))
        np.testing.assert_allclose(middle, 500.0, atol=3.0)
        np.testing.assert_allclose(height, 80.0, atol=1.0)


def test_a_ridge_in_the_way_is_passed_at_its_end_where_time_allows():
    x, y = np.arange(0, 2001, 25.0), np.arange(0, 1001, 25.0)
    crest = 150.0 * np.exp(-(((x - 1000) / 120.0) ** 2)) / (1 + np.exp((y[:, None] - 600) / 40.0))
    ridge = level(crest)
    path = np.array([[200, 500, 60], [900, 500, 190], [1100, 500, 190], [1800, 500, 60.0]])
    risk = Risk(InverseDistance(100.0), Sobolev(1), speed=SPEED)
    box = {"low": [0, 0, 0], "high": [2000, 1000, 190]}
    result = refine(path, clearance=ridge, risk=risk, seconds=60.0, **box)
    longer = refine(path, clearance=ridge, risk=risk, longest=150.0, seconds=60.0, **box)
    assert result.gain > 0.2
    assert result.positions[:, 1].max() > 520.0
    assert longer.after.norm < result.after.norm
    assert longer.after.duration <= 150.0
    assert len(result.positions) < 40


def test_nothing_to_gain_is_said(flat):
    straight = np.array([[100, 500, 30], [900, 500, 30.0]])
    detour = np.array([[100, 500, 30], [500, 800, 30], [900, 500, 30.0]])
    risk = Risk(InverseDistance(D0), speed=SPEED)
    for path, change, reason in (
        (straight, {}, "leaves no time"),
        (straight, {"longest": 100.0, "high": [1000, 1000, 30]}, "nothing better is near"),
        (straight + HIGH, {"longest": 100.0}, "no risk to lower"),
        (detour, {"longest": 66.0}, "the straight line takes 66.6667 s"),
        (detour - np.array([0.0, 0.0, 29.9995]), {}, "motion 0 of it is not free"),
        (straight, {"longest": 100.0, "risk": Risk(norm=Lp(math.inf), speed=SPEED)}, "start"),
        (straight[[0, 0]], {}, "leaves no time"),
    ):
        result = refine(path, **({"clearance": flat, "risk": risk, "seconds": 60.0} | change))
        assert result.outcome is Outcome.UNCHANGED
        assert reason in result.reason
        assert reason in str(result)
        np.testing.assert_array_equal(result.positions, path)
        assert result.after is result.before


def test_a_path_slower_than_allowed_becomes_fast_enough(flat):
    detour = np.array([[100, 500, 30], [500, 800, 55], [900, 500, 30.0]])
    risk = Risk(InverseDistance(D0), speed=SPEED)
    slow = refine(detour, clearance=flat, risk=risk, longest=70.0, seconds=60.0)
    assert slow.after.duration <= 70.0 < slow.before.duration
    assert slow.after.norm <= slow.before.norm
    free = refine(detour + HIGH, clearance=flat, risk=risk, longest=70.0, seconds=60.0)
    assert free.after.duration <= 70.0
    assert free.after.norm == 0.0


def test_a_dearer_second_makes_for_shorter_paths():
    clearance = TerrainClearance(hills(11), threads=1)
    path = walk(clearance, 4, 5)
    results = []
    for weight in (0.0, 1e-4, 1e-2):
        risk = Risk(InverseDistance(D0), speed=SPEED, duration_weight=weight)
        result = refine(path, clearance=clearance, risk=risk, seconds=60.0)
        costs = [m.norm**2 + weight * m.duration for m in (result.before, result.after)]
        assert costs[1] < costs[0]
        assert result.after.norm <= result.before.norm * (1 + 1e-12)
        results.append(result.after)
    durations = [after.duration for after in results]
    norms = [after.norm for after in results]
    assert durations == sorted(durations, reverse=True)
    assert norms == sorted(norms)
    assert durations[-1] < 0.98 * durations[0]


def test_the_maximum_norm_goes_by_way_of_high_powers():
    x = np.arange(0.0, 1001.0, 25.0)
    ridge = level(80.0 * np.exp(-(((x - 500.0) / 60.0) ** 2)) * np.ones((41, 1)))
    path = np.array([[100, 500, 70], [500, 700, 95], [900, 500, 70.0]])
    risk = Risk(InverseDistance(100.0), Lp(math.inf), speed=SPEED)
    result = refine(path, clearance=ridge, risk=risk, seconds=60.0)
    ends = 1 / 70 - 1 / 100
    assert result.before.norm > 1 / 16 - 1 / 100
    assert result.after.norm == pytest.approx(ends, rel=0.2)  # far above the crest
    assert "L8, L16, L32" in str(result)
    assert norm_along(ridge, result.positions, Lp(math.inf), SPEED, 100.0) == pytest.approx(
        result.after.norm, rel=FINE
    )


def test_any_callable_and_any_gradient_give_nearly_what_compiled_code_gives():
    clearance = TerrainClearance(hills(7), threads=1)
    path, risk = walk(clearance, 7, 5), Risk(InverseDistance(D0), speed=SPEED)
    obstacles = clearance.with_radius(6.0)
    compiled = refine(path, clearance=clearance, risk=risk, obstacles=obstacles, seconds=60.0)
    asked = [0]

    def gradient(points):
        asked[0] += len(points)
        return clearance.gradient(points)

    def d(points):
        return clearance(points)

    for change in (
        {"clearance": d},
        {"clearance": d, "gradient": gradient},
        {"obstacles": lambda points: clearance(points) - 6.0},
    ):
        given_ = {"clearance": clearance, "obstacles": obstacles} | change
        result = refine(path, risk=risk, seconds=60.0, **given_)
        assert result.after.norm == pytest.approx(compiled.after.norm, rel=0.02)
        assert not result.compiled
        assert "not compiled" in str(result)
    assert asked[0] > 0
    assert compiled.compiled


def test_obstacles_that_pose_no_risk_are_kept_off_too(flat):
    """A pillar that only `obstacles` knows stands where the least risk would be."""

    def pillar(points):
        return np.hypot(points[:, 0] - 500.0, points[:, 1] - 500.0) - 60.0

    path = np.array([[100, 500, 30], [500, 620, 30], [900, 500, 30.0]])
    risk = Risk(InverseDistance(D0), speed=SPEED)
    result = refine(path, clearance=flat, risk=risk, obstacles=pillar, seconds=60.0)
    s = np.linspace(0, 1, 2001)[:, None]
    for a, b in pairwise(result.positions):
        assert pillar(a + s * (b - a)).min() > 0.0
    assert result.improved


def test_time_that_is_up_still_gives_a_valid_path():
    clearance = TerrainClearance(hills(2), threads=1)
    path, risk = walk(clearance, 2, 8), Risk(InverseDistance(D0), speed=SPEED)
    result = refine(path, clearance=clearance, risk=risk, seconds=1e-6)
    assert "out of time" in result.reason
    assert result.after.norm <= result.before.norm * (1 + 1e-12)
    assert result.after.duration <= result.before.duration
    plenty = refine(path, clearance=clearance, risk=risk, seconds=600.0)
    assert plenty.seconds < 300.0  # ends by itself
    assert plenty.after.norm < result.after.norm
    again = refine(path, clearance=clearance, risk=risk, seconds=600.0)
    np.testing.assert_array_equal(again.positions, plenty.positions)


def test_a_path_of_a_problem(problem):
    middle = (problem.start + problem.goal) / 2
    around = np.array([problem.start, [middle[0], 500.0, 190.0], problem.goal])
    result = improve_path(problem, around, seconds=60.0)
    assert result.improved
    assert result.before.label == "H1"
    assert (result.positions <= problem.high).all()
    assert result.after.clearance > problem.min_clearance
    high = improve_path(problem, around, norm=Lp(math.inf), longest=1e4, seconds=60.0)
    assert high.before.label == "L∞"
    assert high.after.norm <= high.before.norm


def test_what_is_said_reads_well(flat):
    detour = np.array([[100, 500, 30], [500, 600, 35], [900, 500, 30.0]])
    result = refine(detour, clearance=flat, risk=Risk(InverseDistance(D0), speed=SPEED))
    before, after = result.before, result.after
    text = str(result)
    assert text.startswith(f"H1 {before.norm:.3g} -> {after.norm:.3g} (-{100 * result.gain:.1f} %)")
    assert f"{before.duration:.1f} s -> {after.duration:.1f} s, 3 -> {after.vertices}" in text
    assert result.gain == pytest.approx(1 - after.norm / before.norm)
    assert not result.positions.flags.writeable


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({"positions": np.zeros((3, 2))}, "positions.shape"),
        ({"longest": 0.0}, "longest = 0.0"),
        ({"longest": math.inf}, "longest = inf"),
        ({"seconds": -1.0}, "seconds = -1.0"),
        ({"seconds": math.nan}, "seconds = nan"),
        ({"low": [0, 0]}, "low.shape"),
        ({"low": [0, 0, math.nan]}, "low"),
        ({"high": [1000, 1000, -1], "low": [0, 0, 0]}, "high"),
        ({"high": [1000, 1000, 29]}, "positions[0]"),
        ({"clearance": 3}, "clearance"),
        ({"obstacles": "wall"}, "clearance"),
        ({"risk": None}, "risk"),
        ({"gradient": lambda p: p[:, :2]}, "gradient(points).shape"),
        ({"gradient": lambda p: np.full(p.shape, np.nan)}, "gradient(points)"),
        ({"clearance": lambda p: np.full(len(p), np.nan)}, "nan"),
    ],
)
def test_bad_input_is_named(flat, change, names):
    given_ = {
        "positions": [[100, 100, 30], [500, 700, 40], [800, 700, 50]],
        "clearance": flat,
        "risk": Risk(InverseDistance(D0), speed=1.0),
    }
    with pytest.raises(ArgumentError) as error:
        refine(**(given_ | change))
    assert names in str(error.value)
