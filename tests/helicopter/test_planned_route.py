"""Routes as they were planned: from pieces to states at any time."""

import math

import numpy as np
import pytest
from flown_routes import Writer, apart, random_route
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from ompl_risk._kernels import rigid_body
from ompl_risk._kernels.pieces import DURATION, HEADING, KIND, NUMBER, SPEED, X
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flying import fly
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.planned_route import planned_route
from ompl_risk.helicopter.steering import HelicopterSteering

LIBRARY = default_library()
START = (500.0, -300.0, 120.0, 0.7, 2.0)  # at 20 m/s
LEVEL = (20.0,)


def short_route():
    turn = (20.0, 0.0, float(LIBRARY.turns[2, 2]))
    writer = Writer(LIBRARY, START)
    writer.hold(3.333, 20.0).change(LEVEL, turn).hold(2.345, *turn).change(turn, LEVEL)
    return writer.hold(7.777, 20.0)


def test_a_route_is_in_place_at_whole_steps_and_between_them():
    writer = short_route()
    route = planned_route(LIBRARY, writer.start, writer.pieces)
    row = writer.pieces[1]
    one = LIBRARY.manoeuvres[int(row[NUMBER])]
    assert len(one.controls) > 10
    begin = writer.pieces[0, DURATION]
    heading = Rotation.from_euler("z", row[HEADING])

    def placed(state):
        turned = (heading * Rotation.from_quat(state[3:7])).as_quat()
        return np.concatenate(
            [heading.apply(np.array(state[:3])) + row[X : X + 3], turned, state[7:]]
        )

    times = begin + np.arange(1, len(one.controls)) * one.dt
    for state, expected in zip(route.at(times), one.states[1:-1], strict=True):
        gap = apart(state, placed(expected))[0]
        assert gap[0] < 1e-9
        assert gap[1] < 1e-7
    half = np.empty(13)
    rigid_body.propagate(one.states[7], one.controls[7], 0.4 * one.dt, Helicopter().given, half)
    there = route.at(np.array([begin + 7.4 * one.dt]))[0]
    assert_allclose(there[:3], placed(half)[:3], atol=1e-9)
    assert_allclose(there[7:], half[7:], atol=1e-9)


def test_a_route_has_no_jumps():
    steering = HelicopterSteering(LIBRARY)
    start, pieces = random_route(steering, np.random.default_rng(2), 5000.0, (0, 1, 2, 3))
    route = planned_route(LIBRARY, start, pieces)
    times = np.arange(0.0, route.duration, 0.005)
    states = route.at(times)
    velocity = Rotation.from_quat(states[:, 3:7]).apply(states[:, 7:10])
    middle = 0.5 * (velocity[1:] + velocity[:-1]) * 0.005
    assert np.abs(np.diff(states[:, :3], axis=0) - middle).max() < 1e-4
    assert np.abs(np.diff(states[:, 10:], axis=0)).max() < 0.15


def test_after_its_end_a_route_goes_on_in_its_last_trim():
    writer = Writer(LIBRARY, START).hold(5.0, 20.0)
    route = planned_route(LIBRARY, writer.start, writer.pieces)
    end, later = route.at(np.array([5.0, 7.0]))
    assert_allclose(end, route.goal, atol=1e-12)
    assert_allclose(np.linalg.norm(later[:3] - end[:3]), 40.0)


@pytest.mark.parametrize(
    ("row", "column", "value", "name"),
    [
        (0, KIND, 2.0, r"pieces\[0, KIND\] = 2"),
        (0, DURATION, -1.0, r"pieces\[0, DURATION\] = -1"),
        (1, NUMBER, 999.0, r"pieces\[1, NUMBER\] = 999"),
        (1, NUMBER, 0.5, r"pieces\[1, NUMBER\] = 0.5"),
        (1, DURATION, 9.0, r"pieces\[1, DURATION\] = 9"),
        (0, SPEED, 21.0, "speed = 21"),
        (2, SPEED, 30.0, "turn = "),
        (2, X, 0.0, r"pieces\[2, X:HEADING\]"),
        (0, HEADING, 0.6, r"pieces\[0, X:HEADING\].*the start"),
        (4, X, math.nan, r"pieces\[4, 2\]"),
    ],
)
def test_pieces_that_do_not_follow_are_named(row, column, value, name):
    writer = short_route()
    pieces = writer.pieces
    pieces[row, column] = value
    with pytest.raises(ArgumentError, match=name):
        fly(LIBRARY, writer.start, pieces)


def test_trims_that_do_not_join_are_named():
    writer = short_route()
    with pytest.raises(ArgumentError, match=r"first trim of pieces\[0\]"):
        fly(LIBRARY, (*START[:4], 1.0), writer.pieces)
    with pytest.raises(ArgumentError, match=r"first trim of pieces\[3\]"):
        fly(LIBRARY, START, writer.pieces[[0, 1, 2, 1]])


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        ({"start": (0.0, 0.0, 0.0, 0.0, 9.0)}, r"start\[4\] = 9"),
        ({"start": (0.0, 0.0, 0.0, 0.0)}, r"start\.shape"),
        ({"pieces": np.zeros((0, 10))}, r"pieces\.shape"),
        ({"pieces": np.zeros((2, 9))}, r"pieces\.shape"),
        ({"hover": -1.0}, "hover = -1"),
        ({"hover": math.inf}, "hover = inf"),
    ],
)
def test_wrong_arguments_are_named(changed, name):
    writer = short_route()
    fields = {"start": writer.start, "pieces": writer.pieces} | changed
    with pytest.raises(ArgumentError, match=name):
        fly(LIBRARY, **fields)
