"""Navigation errors: Gauss-Markov biases and noise of the stated sizes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk._kernels import draws
from ompl_risk._kernels import navigation as kernels
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.navigation import (
    Drift,
    NavigationError,
    gps_position,
    small_ahrs,
    small_velocity,
)

N = kernels.NAVIGATION
LIVELY = NavigationError(
    Drift((1.0, 2.0, 3.0), (0.5, 0.0, 1.0), 2.0),
    Drift((0.1, 0.2, 0.3), (0.0, 0.1, 0.2), 0.5),
    Drift((0.0, 0.4, 0.5), (0.3, 0.2, 0.1), 5.0),
)


def drifts(error: NavigationError, update: float, seed: int, count: int) -> np.ndarray:
    out = np.empty((count, N))
    kernels.drift(error.given(update), np.array([seed], np.uint64), np.empty(N), out)
    return out


@given(st.floats(1e-3, 50.0))
def test_an_update_leaves_the_variance_of_the_biases(update: float) -> None:
    given_ = LIVELY.given(update)
    keep, drive, bias = given_[:N], given_[N : 2 * N], given_[2 * N : 3 * N]
    np.testing.assert_allclose((keep * bias) ** 2 + drive**2, bias**2, rtol=1e-12)


@given(st.floats(1e-3, 50.0))
def test_biases_decay_over_their_times_however_often_they_are_updated(update: float) -> None:
    times = np.repeat([2.0, 0.5, 5.0], 3)
    keep = LIVELY.given(update)[:N]
    np.testing.assert_allclose(keep, np.exp(-update / times), rtol=1e-12)
    np.testing.assert_allclose(LIVELY.given(0.5 * update)[:N] ** 2, keep, rtol=1e-12)


def test_parameters_stand_in_their_places() -> None:
    given_ = LIVELY.given(0.1)
    assert given_.shape == (kernels.GIVEN,)
    assert not given_.flags.writeable
    np.testing.assert_array_equal(
        given_[kernels.BIAS : kernels.BIAS + N], [1, 2, 3, 0.1, 0.2, 0.3, 0, 0.4, 0.5]
    )
    np.testing.assert_array_equal(given_[kernels.NOISE :], [0.5, 0, 1, 0, 0.1, 0.2, 0.3, 0.2, 0.1])


def test_variances_and_autocorrelations_of_many_starts() -> None:
    count, update = 6000, 0.25
    errors = np.stack([drifts(LIVELY, update, 71 * k, 9) for k in range(count)])
    given_ = LIVELY.given(update)
    bias, noise = given_[2 * N : 3 * N], given_[3 * N :]
    times = np.repeat([2.0, 0.5, 5.0], 3)
    for lag in (0, 1, 4, 8):
        found = (errors[:, 0] * errors[:, lag]).mean(axis=0)
        wanted = bias**2 * np.exp(-lag * update / times) + (noise**2 if lag == 0 else 0.0)
        size = (bias**2 + noise**2) * math.sqrt(2.0 / count)
        assert (np.abs(found - wanted) < 4.5 * size).all()


def test_components_are_independent() -> None:
    errors = np.stack([drifts(LIVELY, 0.25, 53 * k + 1, 3)[-1] for k in range(6000)])
    off = np.corrcoef(errors.T) - np.eye(N)
    assert np.abs(off).max() < 4.5 / math.sqrt(6000)


@settings(deadline=None)  # the first call compiles
@given(st.integers(0, 30), st.integers(0, 2**64 - 1))
def test_an_update_draws_eighteen_numbers(updates: int, seed: int) -> None:
    one, other = np.array([seed], np.uint64), np.array([seed], np.uint64)
    kernels.drift(LIVELY.given(0.1), one, np.empty(N), np.empty((updates, N)))
    draws.fill(other, np.empty(9 + 18 * updates))
    assert one[0] == other[0]


def test_sizes_at_95_percent() -> None:
    position = gps_position(8.0, 13.0)
    total = np.hypot(position.bias, position.noise)
    assert total[0] == total[1]
    assert math.exp(-0.5 * (8.0 / total[0]) ** 2) == pytest.approx(0.05)  # Rayleigh
    assert math.erfc(13.0 / total[2] / math.sqrt(2.0)) == pytest.approx(0.05)


def test_attitude_is_in_radians_and_velocity_of_the_stated_rms() -> None:
    attitude, velocity = small_ahrs(0.4, 1.0), small_velocity(0.1)
    np.testing.assert_allclose(np.rad2deg(np.hypot(attitude.bias, attitude.noise)), [0.4, 0.4, 1.0])
    np.testing.assert_allclose(np.hypot(velocity.bias, velocity.noise), 0.1)


def test_equal_numbers_make_equal_errors() -> None:
    assert NavigationError() == NavigationError()
    assert hash(NavigationError()) == hash(NavigationError())
    assert NavigationError(rate=5.0) != NavigationError()


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Drift((1, 1, -1), (0, 0, 0), 1.0), "bias"),
        (lambda: Drift((1, 1, 1), (0, 0), 1.0), "noise"),
        (lambda: Drift((1, 1, math.nan), (0, 0, 0), 1.0), "bias"),
        (lambda: Drift((1, 1, 1), (0, 0, 0), 0.0), "time"),
        (lambda: Drift.within((1, 1, 1), (0, 0, 2), 1.0), "noise"),
        (lambda: gps_position(0.0, 1.0), "horizontal_95"),
        (lambda: gps_position(1.0, math.inf), "vertical_95"),
        (lambda: NavigationError(rate=0.0), "rate"),
        (lambda: NavigationError(attitude=3.0), "attitude"),  # type: ignore[arg-type]
        (lambda: NavigationError().given(-1.0), "update"),
    ],
)
def test_errors_that_are_none(make, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        make()
