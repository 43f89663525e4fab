"""The closed form of the probability of collision, against closed forms and simulated errors."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from ompl_risk.errors import ArgumentError
from ompl_risk.probability.crossings import CrossingRate
from ompl_risk.probability.outcrossing import Outcrossing

T = np.linspace(0.0, 60.0, 301)
DIP = 25.0 - 15.0 * np.exp(-(((T - 30.0) / 6.0) ** 2))


def test_without_a_lasting_error_it_is_the_poisson_reading_of_the_rate_from_the_least_margin_on():
    model = Outcrossing(8.0, correlation_time=5.0)
    rate = CrossingRate(8.0, correlation_time=5.0)
    late, early = T >= 30.0, T <= 30.0
    assert model.probability(T[late], DIP[late]) == pytest.approx(
        rate.along(T[late], DIP[late]).independent, rel=1e-12
    )
    # the dip is the same forwards and backwards
    one = rate.along(T[late], DIP[late])
    entries = 2.0 * (one.expected - one.initial)
    both = 1.0 - (1.0 - one.initial) * math.exp(-entries)
    assert model.probability(T, DIP) == pytest.approx(both, rel=1e-12)
    assert model.probability(T[early], DIP[early]) == pytest.approx(
        model.probability(T[late], DIP[late]), rel=1e-9
    )


def test_a_sure_collision_is_sure():
    assert Outcrossing(1.0, correlation_time=5.0).probability(T, DIP - 16.0) > 1.0 - 1e-8


@pytest.mark.parametrize("lasting", [3.0, 10.0])
def test_a_lasting_error_alone_is_met_once(lasting):
    """A passing error of next to nothing leaves Q(least margin / lasting), however long it is."""
    model = Outcrossing(lasting / 500.0, lasting, correlation_time=5.0)
    assert model.probability(T, DIP) == pytest.approx(norm.sf(10.0 / lasting), rel=0.02)


def test_slopes_count_by_the_height_that_is_missing():
    model = Outcrossing(8.0, 4.0, correlation_time=5.0)
    up = np.full_like(T, 0.8)
    assert model.probability(T, DIP, up) == pytest.approx(model.probability(T, DIP / 0.8))
    assert model.probability(T, DIP, np.zeros_like(T)) == pytest.approx(
        model.probability(T, DIP / 0.3)
    )


def simulated(passing, lasting, time, margin, seed=5, count=40_000):
    """Share of Gaussian errors with that correlation that ever exceed the margin."""
    random = np.random.default_rng(seed)
    covariance = np.exp(-0.5 * ((T[:, None] - T) / time) ** 2)
    root = np.linalg.cholesky(covariance + 1e-9 * np.eye(len(T)))
    e = passing * random.standard_normal((count, len(T))) @ root.T
    b = lasting * random.standard_normal((count, 1))
    return float(np.mean((margin - b - e).min(axis=1) < 0.0))


@pytest.mark.parametrize(("passing", "lasting", "time"), [(6.0, 0.0, 3.0), (5.0, 6.0, 4.0)])
def test_against_simulated_errors(passing, lasting, time):
    predicted = Outcrossing(passing, lasting, correlation_time=time).probability(T, DIP)
    found = simulated(passing, lasting, time, DIP)
    assert predicted == pytest.approx(found, rel=0.12)


def test_counting_what_lasts_again_and_again_would_be_wrong():
    """The same total error, all of it passing, is far more dangerous on a long way."""
    long = np.linspace(0.0, 600.0, 3001)
    margin = np.full_like(long, 25.0)
    split = Outcrossing(4.0, 9.0, correlation_time=5.0).probability(long, margin)
    mixed = Outcrossing(math.hypot(4.0, 9.0), correlation_time=5.0).probability(long, margin)
    assert split < 0.25 * mixed


@given(
    st.floats(0.5, 20.0), st.floats(0.0, 20.0), st.floats(0.5, 50.0), st.floats(1.0, 30.0)
)  # fmt: skip
def test_more_room_is_never_more_dangerous(passing, lasting, time, room):
    model = Outcrossing(passing, lasting, correlation_time=time)
    near, far = model.probability(T, DIP), model.probability(T, DIP + room)
    assert 0.0 <= far <= near <= 1.0


@pytest.mark.parametrize("lasting", [0.0, 1.0, 40.0])
def test_lasting_errors_have_their_mean_and_variance(lasting):
    b, weights = Outcrossing(2.0, lasting, correlation_time=1.0).lasting_errors()
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ b == pytest.approx(0.0, abs=1e-12)
    assert weights @ b**2 == pytest.approx(lasting**2, rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"passing": 0.0}, "passing"),
        ({"lasting": -1.0}, "lasting"),
        ({"lasting": math.inf}, "lasting"),
        ({"correlation_time": 0.0}, "correlation_time"),
    ],
)
def test_wrong_sizes_are_refused(arguments, named):
    with pytest.raises(ArgumentError, match=named):
        Outcrossing(**{"passing": 1.0, "correlation_time": 1.0, **arguments})


def test_wrong_profiles_are_refused():
    model = Outcrossing(1.0, correlation_time=1.0)
    with pytest.raises(ArgumentError, match=r"d\.shape"):
        model.probability([0.0, 1.0], [1.0])
    with pytest.raises(ArgumentError, match="up"):
        model.probability([0.0, 1.0], [1.0, 1.0], [1.0])
