"""Steerings and their duties: one that breaks them is named, and nothing is asked in vain."""

import math
import pickle

import numpy as np
import pytest
from steered_motions import SPEED, Arc, grazing, norms, pairs, risk_of

from ompl_risk.errors import ArgumentError
from ompl_risk.motion import (
    Connection,
    SampledBatch,
    SteeredBatch,
    Steering,
    StraightSteering,
    TerrainBatch,
    motion_batch,
    steered_batch,
)


def test_rows_do_not_depend_on_each_other_nor_on_layout(hills):
    batch = SteeredBatch(Arc(reach=25.0), hills, risk_of())
    a, b = pairs(hills, 30, seed=5)
    costs, durations = batch.costs(a, b), batch.durations(a, b)
    for k in range(30):
        one = slice(k, k + 1)
        assert batch.costs(a[one], b[one])[0] == pytest.approx(costs[k])
        assert batch.durations(a[one], b[one])[0] == durations[k]
    assert batch.costs(np.asfortranarray(a), np.repeat(b, 2, axis=0)[::2]) == pytest.approx(costs)
    none = np.empty((0, 3))
    for answer in (batch.costs, batch.durations, batch.are_free, batch.least_durations):
        assert answer(none, none).shape == (0,)
    assert batch.samples(none, none) == []


def test_samples_are_the_connections(hills):
    batch, a_b = SteeredBatch(Arc(), hills, risk_of()), pairs(hills, 5, seed=6)
    for k, states in enumerate(batch.samples(*a_b)):
        assert np.array_equal(states, Arc().connect(a_b[0][k], a_b[1][k]).samples)
        assert not states.flags.writeable


def test_the_same_pairs_are_connected_once_and_changed_ones_anew(hills):
    steering = Arc()
    batch = SteeredBatch(steering, hills, risk_of())
    a, b = pairs(hills, 20, seed=7)
    first = batch.costs(a, b)
    batch.durations(a, b)[0] = -1.0
    batch.samples(a, b), batch.are_free(a.copy(), b.copy())
    assert steering.asked == 20
    assert batch.durations(a, b)[0] > 0.0
    b[0] += 5.0
    assert batch.costs(a, b)[0] != first[0]
    assert steering.asked == 40


def faulty(connection):
    class Faulty(Steering):
        def connect(self, a, b):
            return connection(a, b)

    return SteeredBatch(Faulty(), lambda p: p[:, 2] + 100, risk_of())


@pytest.mark.parametrize(
    ("connection", "names"),
    [
        (lambda a, b: Connection(1.0, [a, b]), r"speed of .* = 25.0: must be at most .* 20 m/s"),
        (lambda a, b: Connection(0.0, [a, b]), "speed of .* = inf"),
        (lambda a, b: Connection(9.0, [a + 1e-3, b]), r"samples\[0\].*must be a = "),
        (lambda a, b: Connection(9.0, [a, a]), r"samples\[-1\].*must be b = "),
        (lambda a, b: Connection(9.0, np.zeros((2, 7))), r"samples\[0\]"),
        (lambda a, b: None, r"connect\(a, b\) = None: must be a Connection, or Connection.none"),
    ],
)
def test_a_steering_that_breaks_its_duties_is_named(connection, names):
    with pytest.raises(ArgumentError, match=names):
        faulty(connection).costs(np.zeros((2, 3)), np.tile([25.0, 0.0, 0.0], (2, 1)))


def test_a_steering_cannot_change_the_states_it_is_given():
    def connect(a, b):
        a[0] = 7.0

    with pytest.raises(ValueError, match="read-only"):
        faulty(connect).costs(np.zeros((1, 3)), np.ones((1, 3)))


@pytest.mark.parametrize(
    ("duration", "samples", "names"),
    [
        (-1.0, np.zeros((2, 3)), "duration = -1.0"),
        (math.inf, np.zeros((2, 3)), "duration = inf: .*Connection.none"),
        (math.nan, np.zeros((2, 3)), "duration = nan"),
        (1.0, np.zeros((1, 3)), "samples.shape"),
        (1.0, np.zeros((2, 2)), "samples.shape"),
        (1.0, np.zeros(3), "samples.shape"),
        (1.0, [[0, 0, 0], [0, math.nan, 0]], r"samples\[1, 1\]"),
    ],
)
def test_a_bad_connection_is_named(duration, samples, names):
    with pytest.raises(ArgumentError, match=names):
        Connection(duration, samples)


def test_a_connection_is_read_only_and_survives_pickling():
    states = np.zeros((2, 3))
    connection = Connection(1, states)
    states[0] = 9.0
    for copy in (connection, pickle.loads(pickle.dumps(connection))):
        assert copy.exists
        assert copy.duration == 1.0
        assert not copy.samples.any()
        assert not copy.samples.flags.writeable
    for none in (Connection.none(), pickle.loads(pickle.dumps(Connection.none()))):
        assert not none.exists
        assert none.duration == math.inf
        assert len(none.samples) == 0


def test_straight_steering():
    steering = StraightSteering(30.0)
    way = steering.connect(np.zeros(3), np.array([60.0, 0.0, 80.0]))
    assert steering.symmetric
    assert way.duration == pytest.approx(100.0 / 30.0)
    assert way.samples.tolist() == [[0, 0, 0], [60, 0, 80]]
    nowhere = steering.connect(np.zeros(3), np.zeros(3))
    assert nowhere.exists
    assert nowhere.duration == 0.0
    for options in ({"speed": 0.0}, {"speed": math.inf}, {"speed": 1.0, "reach": -1.0}):
        with pytest.raises(ArgumentError, match=list(options)[-1]):
            StraightSteering(**options)


@norms
def test_straight_motions_need_no_steered_batch(norm, hills):
    risk = risk_of(norm)
    a, b = pairs(hills, 30, seed=8)
    plain = motion_batch(hills, risk).costs(a, b)
    chosen = steered_batch(StraightSteering(SPEED), hills, risk)
    assert isinstance(chosen, TerrainBatch)
    assert np.array_equal(chosen.costs(a, b), plain)
    steered = SteeredBatch(StraightSteering(SPEED), hills, risk)
    allowed = 1e-3 * grazing(norm, SPEED)
    assert steered.costs(a, b) == pytest.approx(plain, rel=5e-3, abs=allowed)
    assert isinstance(steered_batch(StraightSteering(SPEED), lambda p: p[:, 2], risk), SampledBatch)
    slower = steered_batch(StraightSteering(SPEED / 2), hills, risk)
    assert isinstance(slower, TerrainBatch)
    assert slower.durations(a, b) == pytest.approx(2 * chosen.durations(a, b))
    with pytest.raises(ArgumentError, match=r"steering\.speed = 21\.0"):
        steered_batch(StraightSteering(21.0), hills, risk)


def test_a_derived_straight_steering_is_not_bypassed(hills):
    class Roundabout(StraightSteering):
        def connect(self, a, b):
            return Connection.none()

    batch = steered_batch(Roundabout(SPEED), hills, risk_of())
    assert isinstance(batch, SteeredBatch)
    assert np.isinf(batch.durations(*pairs(hills, 3))).all()
    assert isinstance(steered_batch(Arc(), hills, risk_of()), SteeredBatch)


def test_bad_arguments_are_named(hills):
    with pytest.raises(ArgumentError, match="steering = "):
        steered_batch(lambda a, b: None, hills, risk_of())
    batch = SteeredBatch(Arc(), hills, risk_of())
    with pytest.raises(ArgumentError, match=r"b.shape = \(4, 3\)"):
        batch.costs(np.zeros((5, 3)), np.zeros((4, 3)))
    with pytest.raises(ArgumentError, match=r"a.shape = \(5, 7\)"):
        batch.costs(np.zeros((5, 7)), np.zeros((5, 7)))
