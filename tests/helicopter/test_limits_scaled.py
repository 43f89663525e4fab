import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter, Limits

shares = st.floats(0.01, 1.0)
limits = st.builds(
    lambda low, high, rest: Limits(
        lift=(low, high),
        **dict(zip(["yaw_force", "tilt", "lift_rate", "tilt_rate", "attitude"], rest, strict=True)),
    ),
    st.floats(0.0, 0.9),
    st.floats(1.1, 4.0),
    st.tuples(*[st.floats(0.1, 1.5)] * 5),
)


def test_nine_tenths_of_the_default():
    kept = dataclasses.astuple(Limits().scaled(0.9))
    assert kept[0] == pytest.approx((0.28, 1.9), rel=1e-14)
    assert kept[1:] == pytest.approx((5.4, 0.18, 3.6, 27.0, 1.8, 31.5, 1.8, 0.99), rel=1e-14)


@given(limits, shares)
def test_room_about_the_hover_is_the_share(whole, share):
    vehicle, scaled = Helicopter(), whole.scaled(share)
    hover = np.array([vehicle.weight, 0.0, 0.0, 0.0])
    for part, all_of_it in zip(scaled.controls(vehicle), whole.controls(vehicle), strict=True):
        np.testing.assert_allclose(
            part - hover, share * (all_of_it - hover), rtol=0, atol=1e-13 * vehicle.weight
        )
    np.testing.assert_allclose(
        scaled.control_rates(vehicle), share * whole.control_rates(vehicle), rtol=1e-14
    )
    for name in ("speed", "rate", "attitude"):
        assert getattr(scaled, name) == share * getattr(whole, name)


@given(limits, shares, shares)
def test_shares_of_shares_multiply(whole, a, b):
    twice, once = (dataclasses.asdict(x) for x in (whole.scaled(a).scaled(b), whole.scaled(a * b)))
    for name in once:
        assert twice[name] == pytest.approx(once[name], rel=1e-13, abs=1e-14)


@given(limits, st.floats(0.02, 0.99))
def test_less_is_within_more(whole, share):
    (low, high), (least, most) = whole.scaled(share).lift, whole.lift
    assert least < low < 1.0 < high < most


def test_a_share_above_one_widens():
    wide = Limits().scaled(1.2)
    assert wide.lift == pytest.approx((0.04, 2.2), rel=1e-13)
    assert wide.speed == 42.0


@pytest.mark.parametrize("share", [0.0, -0.5, math.nan, math.inf, "half", True, None])
def test_wrong_shares(share):
    with pytest.raises(ArgumentError) as caught:
        Limits().scaled(share)
    assert caught.value.argument == "share"


@pytest.mark.parametrize(
    ("whole", "share", "named"),
    [
        (Limits(), 1.3, "lift"),
        (Limits(lift=(0.9, 2.0), attitude=2.0), 1.6, "attitude"),
        (Limits(lift=(0.9, 2.0), tilt=1.0), 1.6, "tilt"),
    ],
)
def test_shares_that_make_a_limit_impossible_name_it(whole, share, named):
    with pytest.raises(ArgumentError) as caught:
        whole.scaled(share)
    assert caught.value.argument == named
