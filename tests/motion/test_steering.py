"""Steered motions against dense sampling, closed forms and straight motions at another speed."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from steered_motions import D0, SPEED, Arc, grazing, norms, pairs, risk_of

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import MeshClearance, TerrainClearance
from ompl_risk.motion import (
    Connection,
    Risk,
    SampledBatch,
    SteeredBatch,
    Steering,
    StraightSteering,
    TerrainBatch,
    motion_batch,
)
from ompl_risk.norms import Sobolev
from ompl_risk.terrains import Terrain


class ClimbFirst(Steering):
    """Straight up or down to the other's height, then level; both take the same time."""

    def connect(self, a, b):
        corner = np.array([a[0], a[1], b[2]])
        longest = max(abs(b[2] - a[2]), math.dist(corner, b))
        return Connection(2 * longest / SPEED, [a, corner, b])


class Slow(Steering):
    """Straight, `factor` times as long as at full speed, in some pieces."""

    symmetric = True

    def __init__(self, factor, pieces=1):
        self._factor, self._s = factor, np.linspace(0, 1, pieces + 1)[:, None]

    def connect(self, a, b):
        return Connection(self._factor * math.dist(a, b) / SPEED, a + self._s * (b - a))


class Hover(Steering):
    """Stays for 5 s, and goes nowhere."""

    def connect(self, a, b):
        return Connection(5.0, [a, a]) if np.array_equal(a, b) else Connection.none()


def dense(connection, clearance, n=10_000):
    """Times [s] and clearances [m] at n states or so, among them all samples."""
    samples = connection.samples
    steps = len(samples) - 1
    n //= steps
    t = np.linspace(0.0, steps, n * steps + 1)
    states = np.column_stack([np.interp(t, range(steps + 1), column) for column in samples.T])
    return t * connection.duration / steps, clearance(states)


@norms
@pytest.mark.parametrize("steering", [ClimbFirst(), Arc(), Arc(upwards=True)])
@pytest.mark.parametrize("compiled", [True, False])
def test_costs_are_those_of_dense_sampling(steering, norm, compiled, hills):
    risk, n = risk_of(norm), 12
    batch = SteeredBatch(steering, hills if compiled else hills.__call__, risk)
    a, b = pairs(hills, n, seed=1, low=12.0)
    costs, durations, free = batch.costs(a, b), batch.durations(a, b), batch.are_free(a, b)
    compared = 0
    for k in range(n):
        connection = steering.connect(a[k], b[k])
        t, d = dense(connection, hills)
        assert durations[k] == pytest.approx(connection.duration, rel=1e-14)
        if d.min() <= 0.0:
            assert costs[k] == math.inf
            assert not free[k]
        elif d.min() > 0.5:
            assert free[k]
            expected = norm.power(t, risk.avoidance(d))
            allowed = 1e-3 * grazing(norm, SPEED)
            assert costs[k] == pytest.approx(expected, rel=5e-3, abs=allowed)
            compared += 1
    assert compared >= 5


@norms
@pytest.mark.parametrize("factor", [1.0, 1.5, 8.0])
def test_flying_slower_is_exactly_what_straight_motions_cost_at_that_speed(norm, factor, hills):
    risk = risk_of(norm, tolerance=1e-4, duration_weight=None)
    a, b = pairs(hills, 60, seed=2)
    slow = motion_batch(hills, replace(risk, speed=SPEED / factor))
    expected = slow.costs(a, b)
    flown = np.isfinite(expected)
    assert 10 < flown.sum() < 60
    for pieces in (1, 7):
        steered = SteeredBatch(Slow(factor, pieces), hills, risk)
        assert np.array_equal(steered.are_free(a, b), slow.are_free(a, b))
        costs = steered.costs(a, b)
        assert np.array_equal(np.isfinite(costs), flown)
        # kinks of f end the halving early: the errors of both, 1e-3 each at this tolerance
        allowed = 1e-3 * grazing(norm, SPEED / factor)
        assert costs[flown] == pytest.approx(expected[flown], rel=2e-3, abs=allowed)
        assert steered.durations(a, b) == pytest.approx(slow.durations(a, b))


def test_a_slow_descent_in_closed_form():
    """d falls linearly from 25 to 5 at v / 4: f^2 and f'^2 = (v / 4)^2 / d^4 integrate by hand."""
    v, tau, near, far = SPEED / 4, 2.0, 5.0, 25.0
    square = (1 / near - 1 / far - 2 * math.log(far / near) / D0 + (far - near) / D0**2) / v
    slope = v * (near**-3 - far**-3) / 3
    risk = risk_of(Sobolev(1, time_scale=tau), tolerance=1e-4)
    batch = SteeredBatch(Slow(4.0), lambda p: p[:, 2], risk)
    a, b = np.array([[0.0, 0.0, far]]), np.array([[0.0, 0.0, near]])
    assert batch.costs(a, b)[0] == pytest.approx(square + tau**2 * slope, rel=1e-3)


@norms
def test_hovering_costs_f_to_the_p_for_as_long_as_it_takes(norm):
    weight = 0.5 if norm.exponent < math.inf else 0.0
    batch = SteeredBatch(Hover(), lambda p: p[:, 2], risk_of(norm, duration_weight=weight))
    a = np.array([[1.0, 2.0, 12.0], [1.0, 2.0, 90.0], [1.0, 2.0, -1.0]])
    f = 1 / 12 - 1 / D0
    expected = f if math.isinf(norm.exponent) else f**norm.exponent * 5.0 + 5.0 * weight
    assert batch.costs(a, a).tolist() == pytest.approx([expected, 5.0 * weight, math.inf])
    assert batch.are_free(a, a).tolist() == [True, True, False]


@pytest.fixture(scope="module")
def tower():
    """Free but for a tower 50 m high at (100, 100)."""
    heights = np.zeros((41, 41))
    heights[19:22, 19:22] = 50.0
    return TerrainClearance(Terrain(heights, spacing=(5.0, 5.0)), radius=2.0)


@norms
def test_a_collision_on_the_way_counts_not_one_on_the_straight_line(norm, tower):
    batch, straight = (
        SteeredBatch(ClimbFirst(), tower, risk_of(norm)),
        TerrainBatch(tower, risk_of()),
    )
    over, beside = [60.0, 100.0, 60.0], [60.0, 60.0, 30.0]
    # straight over the tower's edge, while descending first leads into it
    a, b = np.array([[100.0, 60.0, 110.0]]), np.array([[100.0, 180.0, 20.0]])
    assert straight.are_free(a, b).tolist() == [True]
    assert batch.are_free(a, b).tolist() == [False]
    assert batch.costs(a, b).tolist() == [math.inf]
    # straight into the tower, while climbing first leads over it
    a, b = np.array([beside]), np.array([[140.0, 140.0, 61.0]])
    assert straight.are_free(a, b).tolist() == [False]
    assert batch.are_free(a, b).tolist() == [True]
    assert batch.costs(a, b)[0] < math.inf
    # in one batch, both at once
    a = np.array([over, beside, [100.0, 60.0, 110.0]])
    b = np.array([[140.0, 100.0, 61.0], [140.0, 140.0, 61.0], [100.0, 180.0, 20.0]])
    assert batch.are_free(a, b).tolist() == [True, True, False]
    assert np.isinf(batch.costs(a, b)).tolist() == [False, False, True]


def test_a_directed_steering_costs_another_amount_on_the_way_back(tower):
    a, b = np.array([[100.0, 60.0, 110.0]]), np.array([[100.0, 180.0, 20.0]])
    directed = SteeredBatch(ClimbFirst(), tower, risk_of())
    assert not directed.symmetric
    assert directed.costs(a, b)[0] == math.inf
    assert directed.costs(b, a)[0] < math.inf
    both_ways = SteeredBatch(Arc(upwards=True), tower, risk_of(tolerance=1e-4))
    assert both_ways.symmetric
    assert both_ways.costs(a, b)[0] < math.inf
    assert both_ways.costs(a, b) == pytest.approx(both_ways.costs(b, a), rel=1e-3)


@norms
@pytest.mark.parametrize("weight", [0.0, 1e-3])
def test_where_there_is_no_way(norm, weight, hills):
    weight = 0.0 if math.isinf(norm.exponent) else weight
    steering = Arc(upwards=True, reach=20.0)
    risk = risk_of(norm, duration_weight=weight)
    batch = SteeredBatch(steering, hills, risk)
    a, b = pairs(hills, 40, seed=3)
    near = np.linalg.norm(b - a, axis=1) <= 40.0
    assert 3 < near.sum() < 37
    with np.errstate(all="raise"):
        costs, durations = batch.costs(a, b), batch.durations(a, b)
    assert np.isinf(costs[~near]).all()
    assert np.array_equal(np.isfinite(durations), near)
    assert not batch.are_free(a, b)[~near].any()
    assert [len(states) for states in batch.samples(a, b)] == np.where(near, 25, 0).tolist()
    assert all(states.shape[1] == 3 for states in batch.samples(a, b))
    assert (batch.least_durations(a, b) < math.inf).all()
    alone = SteeredBatch(Arc(upwards=True, reach=20.0), hills, risk)
    assert alone.costs(a[near], b[near]) == pytest.approx(costs[near])
    assert np.isinf(alone.costs(a[~near], b[~near])).all()


@norms
@pytest.mark.parametrize("steering", [ClimbFirst(), Arc(), Slow(2.5)])
def test_lower_bounds_hold(steering, norm, hills):
    risk = risk_of(norm, duration_weight=1e-6 if norm.exponent < math.inf else None)
    batch = SteeredBatch(steering, hills, risk)
    a, b = pairs(hills, 200, seed=4)
    lower = batch.heuristics(a, b, batch.clearances(a), batch.clearances(b))
    costs = batch.costs(a, b)
    assert (lower <= 1.001 * costs).all()
    assert np.isfinite(costs).sum() > 40
    assert (lower > 0.0).mean() > 0.5
    assert (batch.least_durations(a, b) <= batch.durations(a, b) * (1 + 1e-12)).all()
    assert batch.least_durations(a, b) == pytest.approx(np.linalg.norm(b - a, axis=1) / SPEED)


def test_a_body_that_turns_on_its_way():
    """Beside the wall the rod must not turn: first past it, then turning, is free."""

    class TurnLast(Steering):
        def connect(self, a, b):
            corner = np.concatenate([b[:3], a[3:]])
            longest = max(math.dist(a[:3], b[:3]), clearance.reach * math.pi / 2)
            return Connection(2 * longest / 1.0, [a, corner, b])

    wall = trimesh.creation.box((1, 6, 20))
    wall.apply_translation((4, 0, 0))
    clearance = MeshClearance(wall, body=trimesh.creation.box((0.2, 10, 0.2)))
    risk = Risk(InverseDistance(20.0), speed=1.0, duration_weight=0.0)
    turned = [0, 0, math.sin(math.pi / 4), math.cos(math.pi / 4)]
    a, b = np.array([[1.0, 0, 0, 0, 0, 0, 1]]), np.array([[1.0, 60, 0, *turned]])
    batch = SteeredBatch(TurnLast(), clearance, risk, 7)
    assert batch.are_free(a, b).tolist() == [True]
    assert batch.are_free(b, a).tolist() == [False]
    lower = batch.heuristics(a, b, batch.clearances(a), batch.clearances(b))
    assert 0.0 < lower[0] <= batch.costs(a, b)[0] < math.inf
    assert batch.durations(a, b).tolist() == [120.0]
    straight = SteeredBatch(StraightSteering(1.0, clearance.reach), clearance, risk, 7)
    plain = SampledBatch(clearance, risk, 7)
    assert straight.durations(a, b) == pytest.approx(plain.durations(a, b))
    assert straight.costs(a, b) == pytest.approx(plain.costs(a, b), rel=2e-2)
