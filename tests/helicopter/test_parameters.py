"""Parameters and limits: what they hold, and what they refuse."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter, Limits

XCELL = Helicopter()


def test_the_default_is_the_xcell_60():
    assert (XCELL.mass, XCELL.inertia) == (8.2, (0.18, 0.34, 0.28))
    assert (XCELL.hub, XCELL.tail, XCELL.gravity) == (0.235, 0.91, 9.81)
    assert XCELL.drag == XCELL.wind == (0.0, 0.0, 0.0)
    assert XCELL.weight == pytest.approx(80.442)


def test_parameters_reach_the_kernels_in_order():
    machine = Helicopter(
        2.0, inertia=(3, 4, 5), hub=6, tail=7, gravity=8, drag=(9, 10, 11), wind=(-1, -2, -3)
    )
    assert machine.given.tolist() == [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, -1, -2, -3]
    assert not machine.given.flags.writeable


def test_equal_parameters_are_equal_and_survive_pickling():
    assert Helicopter() == Helicopter()
    assert Helicopter(9.0) != Helicopter()
    assert hash(Helicopter()) == hash(Helicopter())
    assert pickle.loads(pickle.dumps(Helicopter(9.0))) == Helicopter(9.0)
    assert pickle.loads(pickle.dumps(Limits(speed=9.0))) == Limits(speed=9.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"mass": 0.0}, "mass = 0.0: must be a positive"),
        ({"mass": -8.2}, "mass = -8.2"),
        ({"mass": math.inf}, "mass = inf"),
        ({"mass": math.nan}, "mass = nan"),
        ({"mass": True}, "mass = True"),
        ({"mass": "8 kg"}, "mass = '8 kg'"),
        ({"hub": 0.0}, "hub = 0.0"),
        ({"tail": -1.0}, "tail = -1.0"),
        ({"gravity": 0.0}, "gravity = 0.0"),
        ({"inertia": (0.1, 0.2)}, r"inertia.shape = \(2,\)"),
        ({"inertia": (0.1, 0.0, 0.1)}, r"inertia = \[0.1, 0.0, 0.1\]: must be positive"),
        ({"inertia": (0.1, 0.2, math.nan)}, r"inertia\[2\] = nan"),
        ({"inertia": (0.1, 0.2, 0.31)}, "the largest, 0.31, at most the sum of the others, 0.3"),
        ({"drag": (0.0, -1.0, 0.0)}, "drag = .*0 or more"),
        ({"drag": 0.5}, r"drag.shape = \(\)"),
        ({"wind": (1.0, math.inf, 0.0)}, r"wind\[1\] = inf"),
    ],
)
def test_impossible_parameters_are_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        Helicopter(**arguments)


@given(
    st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 3, st.floats(0.1, 2.0)), min_size=4, max_size=8)
)
def test_the_moments_of_any_body_are_accepted(points):
    """Principal moments of point masses satisfy the triangle inequality."""
    places, masses = np.array(points)[:, :3], np.array(points)[:, 3]
    places = places - masses @ places / masses.sum()
    squares = np.einsum("k,ki,kj->ij", masses, places, places)
    moments = np.linalg.eigvalsh(np.trace(squares) * np.eye(3) - squares)
    if moments[0] > 1e-6:
        assert Helicopter(inertia=moments).inertia == tuple(moments)


@given(st.permutations([0, 1, 2]), st.floats(1e-6, 10.0))
def test_moments_of_no_body_are_refused(order, excess):
    moments = np.array([0.2, 0.3, 0.5 + excess])[order]
    with pytest.raises(ArgumentError, match="moments of a body"):
        Helicopter(inertia=moments)


def test_a_flat_body_has_moments_at_the_border():
    assert Helicopter(inertia=(0.1, 0.2, 0.1 + 0.2)).inertia[2] == pytest.approx(0.3)


def test_limits_become_ranges_of_the_controls():
    low, high = Limits(lift=(0.5, 1.5), yaw_force=4.0, tilt=0.1).controls(XCELL)
    assert low == pytest.approx([0.5 * XCELL.weight, -4.0, -0.1, -0.1])
    assert high == pytest.approx([1.5 * XCELL.weight, 4.0, 0.1, 0.1])
    hover = np.array([XCELL.weight, 0, 0, 0])
    assert ((low < hover) & (hover < high)).all()
    rates = Limits(lift_rate=2.0, yaw_force_rate=7.0, tilt_rate=0.4).control_rates(XCELL)
    assert rates == pytest.approx([2.0 * XCELL.weight, 7.0, 0.4, 0.4])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"lift": (0.2, 0.9)}, "lift = .*0 <= low < 1 < high"),
        ({"lift": (1.0, 2.0)}, "lift"),
        ({"lift": (-0.1, 2.0)}, "lift"),
        ({"lift": (0.2, math.inf)}, "lift"),
        ({"attitude": 0.0}, "attitude = 0.0: must be above 0 and up to pi"),
        ({"attitude": 3.2}, "attitude = 3.2"),
        ({"tilt": 1.6}, "tilt = 1.6: must be above 0 and below pi/2"),
        ({"tilt": 0.0}, "tilt = 0.0"),
        ({"speed": -1.0}, "speed = -1.0"),
        ({"speed": math.nan}, "speed = nan"),
        ({"rate": 0.0}, "rate = 0.0"),
        ({"yaw_force": math.inf}, "yaw_force = inf"),
        ({"lift_rate": 0.0}, "lift_rate = 0.0"),
        ({"yaw_force_rate": -3.0}, "yaw_force_rate = -3.0"),
        ({"tilt_rate": 0.0}, "tilt_rate = 0.0"),
    ],
)
def test_impossible_limits_are_refused(arguments, message):
    with pytest.raises(ArgumentError, match=message):
        Limits(**arguments)


@pytest.mark.parametrize("lift", [0.5, (0.5,), (0.5, 1.5, 2.0), None, "strong"])
def test_a_range_of_lift_is_two_numbers(lift):
    with pytest.raises(ArgumentError, match="lift"):
        Limits(lift=lift)
