"""Batches of helicopter connections: what a roadmap is told about them, and of what kinds."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from primitive_scene import (
    D0,
    FASTEST,
    LIBRARY,
    TABLES,
    TRACKS,
    Elsewhere,
    batch_of,
    bumpy_terrain,
    flown,
    kinds,
    pairs,
    risk_of,
)

from ompl_risk._kernels.pieces import MOST_PIECES
from ompl_risk.avoidance import Avoidance, InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.helicopter.batch import STEP, PrimitiveBatch
from ompl_risk.motion import Risk
from ompl_risk.norms import Lp, Sobolev

NORMS = [Lp(1), Lp(2), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]

norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


@pytest.fixture(scope="module")
def terrain():
    return bumpy_terrain()


def every_answer(batch, a, b):
    d_a, d_b = batch.clearances(a), batch.clearances(b)
    bounds, exact = batch.edge_bounds(a, b, d_a, d_b)
    low, high = batch.extents(a, b)
    return {
        "clearances": d_a,
        "are_free": batch.are_free(a, b),
        "costs": batch.costs(a, b),
        "durations": batch.durations(a, b),
        "least_durations": batch.least_durations(a, b),
        "heuristics": batch.heuristics(a, b, d_a, d_b),
        "edge_bounds": bounds,
        "edge_durations": exact,
        "low": low,
        "high": high,
    }


@norms
@kinds
def test_costs_agree_with_the_norm_along_what_is_flown(kind, norm, terrain):
    clearance = kind(terrain, radius=2.0)
    a, b = pairs(terrain, 12, seed=1, low=20.0)
    batch = batch_of(clearance, norm, tolerance=1e-3, duration_weight=0.0)
    costs, free, durations = batch.costs(a, b), batch.are_free(a, b), batch.durations(a, b)
    assert batch.compiled == (kind is TerrainClearance)
    for k in np.flatnonzero(np.isfinite(durations)):
        t, places = flown(a[k], b[k])
        d = clearance(places)
        assert free[k] == np.isfinite(costs[k]) == (d.min() > 0.0)
        assert durations[k] == pytest.approx(t[-1], abs=1e-9)
        assert places[-1] == pytest.approx(b[k, :3], abs=1e-3)
        if free[k]:
            expected = norm.power(t, InverseDistance(D0)(d))
            assert costs[k] == pytest.approx(expected, rel=5e-3, abs=1e-4 * D0**-2)
    assert 3 < free.sum() < len(a)


@norms
def test_compiled_and_generic_agree(norm, terrain):
    a, b = pairs(terrain, 80, seed=2, low=4.0, high=40.0)
    kinds = [TerrainClearance(terrain, radius=2.0), Elsewhere(terrain, radius=2.0)]
    compiled, generic = (
        every_answer(batch_of(c, norm, tolerance=1e-3), a, b) for c in kinds
    )  # fmt: skip
    for name in ("are_free", "durations", "least_durations", "low", "high"):
        assert np.array_equal(compiled[name], generic[name]), name
    assert np.array_equal(np.isinf(compiled["costs"]), np.isinf(generic["costs"]))
    fine = np.isfinite(compiled["costs"])
    assert generic["costs"][fine] == pytest.approx(compiled["costs"][fine], rel=5e-3)
    assert 0.1 < fine.mean() < 0.9


@norms
@kinds
@given(seed=st.integers(0, 10_000))
@settings(max_examples=8, deadline=None)
def test_no_bound_exceeds_what_it_bounds(kind, norm, terrain, seed):
    weight = 1e-6 if norm.exponent < 9 else None
    batch = batch_of(kind(terrain, radius=2.0), norm, tolerance=1e-3, duration_weight=weight)
    a, b = pairs(terrain, 40, seed=seed, low=4.0)
    found = every_answer(batch, a, b)
    assert (found["heuristics"] <= found["costs"] * 1.002).all()
    assert (found["edge_bounds"] <= found["costs"] * 1.002).all()
    assert (found["least_durations"] <= found["durations"]).all()
    assert np.array_equal(found["edge_durations"], found["durations"])
    assert np.isinf(found["edge_bounds"]).tolist() == np.isinf(found["durations"]).tolist()


def test_bounds_of_a_connection_know_its_duration(terrain):
    weight = 1e-4
    batch = batch_of(TerrainClearance(terrain), duration_weight=weight)
    a, b = pairs(terrain, 300, seed=3, low=4.0, high=30.0)
    found = every_answer(batch, a, b)
    fine = np.isfinite(found["costs"])
    detour = (found["durations"] - found["least_durations"])[fine]
    gain = (found["edge_bounds"] - found["heuristics"])[fine]
    assert (gain >= weight * detour * (1 - 1e-9)).all()
    assert np.median(detour) > 2.0
    assert np.median(found["edge_bounds"][fine] / found["costs"][fine]) > 0.1


@kinds
def test_samples_tell_the_way_at_equal_time_steps(kind, terrain):
    clearance = kind(terrain, radius=2.0)
    batch = batch_of(clearance, Lp(2), duration_weight=0.0)
    a, b = pairs(terrain, 40, seed=4, low=30.0)
    samples, durations, costs = batch.samples(a, b), batch.durations(a, b), batch.costs(a, b)
    for k, states in enumerate(samples):
        if math.isinf(durations[k]):
            assert states.shape == (0, 5)
            continue
        assert np.array_equal(states[0], a[k])
        assert np.array_equal(states[-1], b[k])
        t = np.linspace(0.0, durations[k], len(states))
        assert t[1] <= STEP * (1 + 1e-9)
        fine_t, places = flown(a[k], b[k])
        expected = np.column_stack([np.interp(t, fine_t, p) for p in places.T])
        assert np.abs(states[:, :3] - expected).max() < 0.02
        speeds = np.interp(states[:, 4], np.arange(4), LIBRARY.speeds)
        steps = np.linalg.norm(np.diff(states[:, :2], axis=0), axis=1) / t[1]
        assert np.abs(steps - 0.5 * (speeds[1:] + speeds[:-1])).max() < 1.0
        change = np.diff(np.exp(1j * states[:, 3]))
        assert np.abs(change).max() < 0.2  # the heading does not jump, but by whole turns
        if np.isfinite(costs[k]):
            f = InverseDistance(D0)(clearance(states[:, :3]))
            assert np.trapezoid(f * f, t) == pytest.approx(costs[k], rel=3e-2, abs=1e-7)
    assert np.isfinite(costs).sum() > 5


def test_boxes_hold_the_ways_and_no_more(terrain):
    batch = batch_of(TerrainClearance(terrain))
    a, b = pairs(terrain, 40, seed=5)
    low, high = batch.extents(a, b)
    durations = batch.durations(a, b)
    for k in range(len(a)):
        places = np.array([a[k, :3], b[k, :3]])
        if math.isfinite(durations[k]):
            places = np.vstack([places, flown(a[k], b[k])[1]])
        assert low[k] == pytest.approx(places.min(axis=0), abs=2e-3)
        assert high[k] == pytest.approx(places.max(axis=0), abs=2e-3)


@kinds
def test_a_row_does_not_depend_on_the_others_nor_on_layout_or_threads(kind, terrain):
    clearance = kind(terrain, radius=2.0)
    a, b = pairs(terrain, 1100, seed=6)
    whole = every_answer(batch_of(clearance), a, b)
    threads = PrimitiveBatch(TABLES, TRACKS, clearance, risk_of(), threads=3)
    padded = np.full((1100, 12), np.nan)
    padded[:, 1:11:2] = b
    some = np.arange(700, 740)
    alone = every_answer(batch_of(clearance), a[some], b[some])
    for name, answer in every_answer(threads, np.asfortranarray(a), padded[:, 1:11:2]).items():
        assert np.array_equal(answer, whole[name]), name
        assert alone[name] == pytest.approx(whole[name][some], rel=1e-12), name


@kinds
def test_no_rows_are_answered_by_none(kind, terrain):
    batch = batch_of(kind(terrain))
    none = np.empty((0, 5))
    for name, answer in every_answer(batch, none, none).items():
        assert len(answer) == 0, name
    assert batch.samples(none, none) == []


@norms
@kinds
def test_a_way_to_where_the_vehicle_is_costs_nothing_unless_in_collision(kind, norm, terrain):
    batch = batch_of(kind(terrain), norm)
    a, _ = pairs(terrain, 3, seed=7)
    a[1, 2] = -100.0
    assert batch.durations(a, a).tolist() == [0.0, 0.0, 0.0]
    assert batch.are_free(a, a).tolist() == [True, False, True]
    costs = batch.costs(a, a)
    f = InverseDistance(D0)(batch.clearances(a[[0, 2]]))
    expected = f if math.isinf(norm.exponent) else [0.0, 0.0]
    assert costs[[0, 2]] == pytest.approx(expected, abs=0.0)
    assert math.isinf(costs[1])
    assert [len(states) for states in batch.samples(a, a)] == [2, 2, 2]


def test_where_there_is_no_connection_nothing_is_promised(terrain):
    batch = batch_of(TerrainClearance(terrain))
    a = np.array([[500.0, 500.0, 100.0, 0.0, 3.0]])
    b = a + np.array([10.0, 0.0, 90.0, 0.0, 0.0])  # 10 m on but 90 m higher
    found = every_answer(batch, a, b)
    assert math.isinf(found["durations"][0])
    assert math.isinf(found["costs"][0])
    assert not found["are_free"][0]
    assert found["least_durations"][0] == pytest.approx(math.hypot(10.0, 90.0) / FASTEST)
    assert np.array_equal([found["low"][0], found["high"][0]], [a[0, :3], b[0, :3]])
    assert not batch.symmetric
    assert (batch.width, MOST_PIECES) == (5, 40)


def test_fastest_is_that_of_trims_and_manoeuvres():
    speeds = [math.hypot(t.speed, t.climb) for t in LIBRARY.trims if t.turn == 0.0]
    least = max(*speeds, *TRACKS.fastest)
    assert least <= FASTEST <= max(least, *(m.fastest for m in LIBRARY.manoeuvres)) + 1e-9


class Steep(Avoidance):
    """2 f: not what the kernels compute."""

    d0 = D0

    def __call__(self, d):
        return 2.0 * InverseDistance(D0)(d)

    def derivative(self, d):
        return 2.0 * InverseDistance(D0).derivative(d)


def test_another_avoidance_is_not_bypassed(terrain):
    clearance = TerrainClearance(terrain)
    a, b = pairs(terrain, 30, seed=8, low=25.0)
    twice = Risk(Steep(), Sobolev(1), speed=FASTEST, duration_weight=0.0, tolerance=1e-3)
    batch = PrimitiveBatch(TABLES, TRACKS, clearance, twice)
    expected = 4.0 * batch_of(clearance, duration_weight=0.0, tolerance=1e-3).costs(a, b)
    costs = batch.costs(a, b)
    assert not batch.compiled
    fine = np.isfinite(expected)
    assert costs[fine] == pytest.approx(expected[fine], rel=5e-3)
    d_a, d_b = batch.clearances(a), batch.clearances(b)
    assert (batch.edge_bounds(a, b, d_a, d_b)[0] <= costs * 1.002).all()
