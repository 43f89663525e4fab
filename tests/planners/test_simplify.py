"""Simplifying paths: no more risk, no more time, fewer and blunter corners."""

import math
from itertools import pairwise

import numpy as np
import pytest
from flown_paths import D0, NORMS, dense, hills, left_open, power, power_along, walk
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk
from ompl_risk.norms import Lp
from ompl_risk.planners.improve import Outcome, simplify
from ompl_risk.planners.improve.corners import CUTS, cut_corners, drop_corners
from ompl_risk.planners.improve.judge import FINE, Judge, Recollection
from ompl_risk.planners.improve.thinning import thinned
from ompl_risk.terrains import Terrain


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000), corners=st.integers(2, 9), margin=st.sampled_from([0.0, 7.0]))
def test_neither_norm_nor_duration_ever_rises(norm, seed, corners, margin):
    clearance = TerrainClearance(hills(seed), radius=1.0, threads=1)
    path, risk = walk(clearance, seed, corners), Risk(InverseDistance(D0), norm, speed=12.0)
    obstacles = clearance.with_radius(1.0 + margin)
    result = simplify(path, clearance=clearance, risk=risk, obstacles=obstacles)
    new = result.positions
    np.testing.assert_array_equal(new[[0, -1]], path[[0, -1]])
    assert (new >= path.min(axis=0)).all()
    assert (new <= path.max(axis=0)).all()
    assert dense(clearance, new)[1].min() > margin
    (old, u), (after, v) = (power_along(clearance, p, norm, 12.0) for p in (path, new))
    unknown = left_open(risk, result.before.duration) + u + v
    # sums may only fall; a maximum is compared to the accuracy that norms are computed to
    slack = FINE if norm == Lp(math.inf) else 0.0
    assert after <= old * (1 + slack) + unknown
    assert dense(clearance, new)[0][-1] <= dense(clearance, path)[0][-1] * (1 + 1e-12)
    assert result.after.norm <= result.before.norm * (1 + 1e-12)
    assert result.improved == (result.outcome is Outcome.IMPROVED)
    assert power(norm, result.before.norm) == pytest.approx(old, rel=3e-3, abs=unknown)
    assert result.before.clearance == pytest.approx(dense(clearance, path)[1].min(), rel=2e-3)


@pytest.fixture(scope="module")
def flat():
    return TerrainClearance(Terrain(np.zeros((3, 3)), spacing=(500.0, 500.0)), threads=1)


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
def test_a_level_zigzag_becomes_straight(flat, norm):
    """At one height f is the same everywhere, so the time alone counts."""
    zigzag = np.array([[100, 100, 30], [300, 500, 30], [500, 100, 30], [700, 500, 30.0]])
    result = simplify(zigzag, clearance=flat, risk=Risk(InverseDistance(D0), norm, speed=10.0))
    np.testing.assert_array_equal(result.positions, zigzag[[0, -1]])
    assert result.after.length == pytest.approx(math.hypot(600, 400))


def test_where_the_straight_way_is_riskier_the_detour_stays():
    x = np.arange(0.0, 1001.0, 25.0)
    ridge = 80.0 * np.exp(-(((x - 500.0) / 60.0) ** 2)) * np.ones((41, 1))
    clearance = TerrainClearance(Terrain(ridge, spacing=(25.0, 25.0)), threads=1)
    over = np.array([[100, 500, 50], [500, 500, 170], [900, 500, 50.0]])
    near = np.array([[100, 500, 50], [500, 500, 90], [900, 500, 50.0]])
    risk = Risk(InverseDistance(40.0), Lp(math.inf), speed=10.0)
    kept = simplify(over, clearance=clearance, risk=risk)
    assert kept.after.norm == 0.0
    assert kept.after.duration < kept.before.duration
    assert len(kept.positions) > 2
    assert simplify(near, clearance=clearance, risk=risk).after.clearance >= 8.0


def test_the_corner_of_a_path_without_risk_is_cut_until_it_grazes_d0():
    """Round a pillar, along two tangents and the arc between them at distance d0."""

    def pillar(points):
        return np.hypot(points[:, 0], points[:, 1]) - 10.0

    path = np.array([[-100, 0, 0], [-100, 100, 0], [100, 100, 0], [100, 0, 0.0]])
    risk = Risk(InverseDistance(20.0), Lp(1), speed=1.0)
    result = simplify(path, clearance=pillar, risk=risk, rounds=8)
    shortest = 2.0 * math.sqrt(100.0**2 - 30.0**2) + 2.0 * 30.0 * math.asin(30.0 / 100.0)
    assert result.after.norm == 0.0
    assert result.after.clearance > 20.0 - 0.1
    assert shortest <= result.after.length < 1.02 * shortest
    assert not result.compiled


def test_any_callable_gives_what_compiled_code_gives():
    clearance = TerrainClearance(hills(3), threads=1)
    path, risk = walk(clearance, 3, 7), Risk(InverseDistance(D0), speed=12.0)
    compiled = simplify(path, clearance=clearance, risk=risk)
    sampled = simplify(path, clearance=clearance.__call__, risk=risk)
    np.testing.assert_allclose(sampled.positions, compiled.positions)
    assert compiled.compiled
    assert not sampled.compiled
    assert "not compiled" in str(sampled)


def test_duplicates_and_corners_on_a_line_go_whatever_the_norm(flat):
    a, b = np.array([100.0, 100.0, 30.0]), np.array([800.0, 700.0, 50.0])
    shares = [0.0, 0.1, 0.1, 0.3, 0.6, 0.9, 1.0, 1.0]
    path = np.array([a + s * (b - a) for s in shares])
    for norm in NORMS:
        risk = Risk(InverseDistance(D0), norm, speed=10.0)
        result = simplify(path, clearance=flat, risk=risk)
        np.testing.assert_array_equal(result.positions, [path[0], path[-1]])
    still = simplify(path[[0, 0, 0]], clearance=flat, risk=Risk(speed=10.0))
    assert still.after.duration == 0.0


def test_a_path_that_cannot_get_better_comes_back_as_it_is(flat):
    path = np.array([[100, 100, 30], [800, 700, 50.0]])
    result = simplify(path, clearance=flat, risk=Risk(speed=10.0))
    assert result.outcome is Outcome.UNCHANGED
    np.testing.assert_array_equal(result.positions, path)
    assert result.gain == 0.0
    assert "unchanged" in str(result)


def test_a_path_in_collision_comes_back_with_the_motion_that_is_not_free(flat):
    path = np.array([[100, 100, 30], [300, 100, 30], [500, 100, -5], [700, 100, 30.0]])
    result = simplify(path, clearance=flat, risk=Risk(speed=10.0))
    assert result.outcome is Outcome.UNCHANGED
    assert "motion 1 of it is not free" in result.reason
    assert result.before.norm == math.inf
    assert result.before.clearance == 0.0
    margin = simplify(
        path[:2], clearance=flat, risk=Risk(speed=10.0), obstacles=flat.with_radius(40.0)
    )
    assert "motion 0" in margin.reason


def test_dropping_chooses_the_best_of_all_ways(flat):
    """By brute force over all subsets of the corners, at d >= d0 so that the time alone counts."""
    rng = np.random.default_rng(5)

    def pillars(points):
        centres = np.array([[30.0, 0.0], [60.0, 10.0], [90.0, -5.0]])
        gaps = np.linalg.norm(points[:, None, :2] - centres, axis=2) - 9.0
        return gaps.min(axis=1)

    judge = Judge(pillars, Risk(InverseDistance(1e-3), Lp(1), speed=1.0))
    path = np.array(
        [[0, -20, 0], [25, 14, 0], [45, 16, 0], [62, 30, 0], [95, 12, 0], [120, 0, 0.0]]
    )
    path[1:-1] += rng.normal(0, 1, (4, 3))
    lengths = []
    for bits in range(16):
        kept = [0, *(k for k in range(1, 5) if bits >> (k - 1) & 1), 5]
        if math.isfinite(judge.norm(path[kept])):
            lengths.append(judge.duration(path[kept]))
    assert len(lengths) > 1
    assert judge.duration(drop_corners(path, judge)) == pytest.approx(min(lengths))


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
def test_no_single_change_raises_the_risk_of_what_it_replaces(norm):
    """On winding paths at hills' feet, where many changes gain time and cost a little risk."""
    dropped = cut = 0
    for seed in range(6):
        clearance = TerrainClearance(hills(seed), threads=1)
        judge = Judge(clearance, Risk(InverseDistance(D0), norm, speed=12.0))
        path = np.column_stack([np.linspace(50, 750, 30), np.linspace(100, 700, 30), np.zeros(30)])
        path[:, :2] += np.random.default_rng(seed).normal(0, 8, (30, 2))
        path[:, 2] = clearance.terrain.height(path[:, 0], path[:, 1]) + 25.0
        legs = judge.powers(path[:-1], path[1:])
        if not np.isfinite(legs).all():
            continue
        fewer = drop_corners(path, judge)
        at = [int(np.flatnonzero((path == corner).all(axis=1))[0]) for corner in fewer]
        for (i, j), new in zip(pairwise(at), judge.powers(fewer[:-1], fewer[1:]), strict=True):
            assert new <= judge.risk.combine(legs[i:j]) * (1 + 1e-12)
        blunter = cut_corners(path, judge)
        assert judge.norm(blunter) <= judge.norm(path) * (1 + FINE)
        assert judge.duration(blunter) <= judge.duration(path)
        dropped, cut = dropped + len(path) - len(fewer), cut + len(blunter) - len(path)
    assert dropped > 0
    assert cut > 0


def test_cutting_takes_the_scale_that_saves_most(flat):
    judge = Judge(flat, Risk(InverseDistance(D0), Lp(1), speed=1.0))
    path = np.array([[100, 100, 30], [500, 100, 30], [500, 500, 30.0]])
    p, q = cut_corners(path, judge)[1:3]
    np.testing.assert_allclose(p, path[1] + CUTS[0] * (path[0] - path[1]))
    np.testing.assert_allclose(q, path[1] + CUTS[0] * (path[2] - path[1]))


def test_a_motion_is_measured_once(flat):
    class Counting(Judge):
        asked = 0

        def powers(self, a, b):
            self.asked += len(a)
            return super().powers(a, b)

    judge = Counting(flat, Risk(speed=1.0))
    remembering = Recollection(judge)
    a, b = np.random.default_rng(0).uniform(100, 900, (2, 6, 3))
    first = remembering.powers(a, b)
    again = remembering.powers(a[::-1], b[::-1])
    assert judge.asked == 6
    np.testing.assert_array_equal(first, again[::-1])
    np.testing.assert_array_equal(first, Judge(flat, Risk(speed=1.0)).powers(a, b))


@settings(deadline=None)
@given(st.integers(0, 1000), st.floats(0.0, 3.0))
def test_thinning_leaves_no_corner_farther_off_than_allowed(seed, off):
    rng = np.random.default_rng(seed)
    path = np.cumsum(rng.normal(0, 1, (40, 3)), axis=0)
    few = thinned(path, off)
    np.testing.assert_array_equal(few[[0, -1]], path[[0, -1]])
    at = [int(np.flatnonzero((path == corner).all(axis=1))[0]) for corner in few]
    assert at == sorted(at)
    s = np.linspace(0, 1, 2001)[:, None]
    for i, j in pairwise(at):
        line = path[i] + s * (path[j] - path[i])
        for corner in path[i + 1 : j]:
            assert np.linalg.norm(line - corner, axis=1).min() <= off + 1e-2


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({"positions": np.zeros((3, 2))}, "positions.shape"),
        ({"positions": np.ones((1, 3))}, "positions.shape"),
        ({"positions": [[0, 0, 5], [1, math.nan, 5]]}, "positions[1, 1]"),
        ({"rounds": -1}, "rounds = -1"),
        ({"rounds": 1.5}, "rounds = 1.5"),
        ({"clearance": None}, "clearance"),
        ({"risk": Lp(1)}, "risk"),
        ({"clearance": lambda p: np.full(len(p), np.nan)}, "nan"),
    ],
)
def test_bad_input_is_named(flat, change, names):
    given_ = {
        "positions": [[100, 100, 30], [800, 700, 50]],
        "clearance": flat,
        "risk": Risk(speed=1.0),
    }
    with pytest.raises(ArgumentError) as error:
        simplify(**(given_ | change))
    assert names in str(error.value)
