"""Errors of the map: a Gaussian field of the stated covariance, and a bound for its slope."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.terrain_error import TerrainError


def amplitudes(field: TerrainError, count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, 2 * field.waves))


def plainly(field: TerrainError, amplitude: np.ndarray, places: np.ndarray) -> np.ndarray:
    phase = places @ field.wave_numbers.T
    waves = np.cos(phase) @ amplitude[: field.waves] + np.sin(phase) @ amplitude[field.waves :]
    return field.deviation / math.sqrt(field.waves) * waves


def achieved(field: TerrainError, steps: np.ndarray) -> np.ndarray:
    """Covariances at displacements (n, 2), exactly: amplitudes are independent of variance 1."""
    return field.deviation**2 * np.cos(steps @ field.wave_numbers.T).mean(axis=1)


def displacements(lengths: np.ndarray) -> np.ndarray:
    angles = np.linspace(0.0, math.pi, 61)
    return np.stack(
        [np.outer(lengths, np.cos(angles)), np.outer(lengths, np.sin(angles))], axis=-1
    ).reshape(-1, 2)


@pytest.mark.parametrize("waves", [1, 2, 3, 7, 64, 65])
def test_quick_sums_are_sums_of_cosines_and_sines(waves: int) -> None:
    field = TerrainError(9.0, 50.0, waves)
    places = np.random.default_rng(1).uniform(-3e4, 3e4, (500, 2))
    for amplitude in amplitudes(field, 3):
        expected = plainly(field, amplitude, places)
        np.testing.assert_allclose(field.errors(amplitude, places), expected, atol=2e-9)


def test_each_wave_near_the_places_where_its_sign_turns() -> None:
    field = TerrainError(1.0, 1.0, 1)
    k = field.wave_numbers[0]
    halves = np.arange(-9, 10) * 0.5 * math.pi
    phase = np.concatenate([halves, np.nextafter(halves, 99.0), np.nextafter(halves, -99.0)])
    places = phase[:, None] * k / (k @ k)
    np.testing.assert_allclose(field.errors([1, 0], places), np.cos(phase), atol=3e-12)
    np.testing.assert_allclose(field.errors([0, 1], places), np.sin(phase), atol=3e-12)


@pytest.mark.parametrize("seed", range(5))
def test_the_covariance_is_the_wanted_one(seed: int) -> None:
    field = TerrainError(9.73, 300.0, 64, seed)
    for reach, error in ((3.0, 0.03), (6.0, 0.06)):
        steps = displacements(np.linspace(0.0, reach * 300.0, 61))
        wanted = field.covariance(np.linalg.norm(steps, axis=1))
        np.testing.assert_allclose(achieved(field, steps), wanted, atol=error * 9.73**2)


def test_more_waves_come_nearer_to_it() -> None:
    steps = displacements(np.linspace(0.0, 6.0, 61))
    worst = [
        np.abs(achieved(field, steps) - field.covariance(np.linalg.norm(steps, axis=1))).max()
        for field in (TerrainError(1.0, 1.0, m) for m in (16, 64, 256, 1024))
    ]
    assert worst[3] < worst[2] < worst[1] < worst[0]
    assert worst[3] < 0.01


def test_the_stated_correlations() -> None:
    found = TerrainError(2.0).covariance([0.0, 300.0, 600.0, 734.0]) / 4.0
    np.testing.assert_allclose(found, [1.0, 0.61, 0.14, 0.05], atol=5e-3)


def test_the_variance_is_exact_everywhere() -> None:
    field = TerrainError(9.73, 120.0, 16)
    places = np.random.default_rng(2).uniform(-5e3, 5e3, (20, 2))
    shares = np.stack([field.errors(one, places) for one in np.eye(32)])
    np.testing.assert_allclose((shares**2).sum(axis=0), 9.73**2, rtol=1e-10)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 70), st.floats(20.0, 2000.0))
def test_the_slope_bound_is_the_greatest_of_all_signs(seed: int, waves: int, length: float) -> None:
    field = TerrainError(5.0, length, waves)
    amplitude = amplitudes(field, 2, seed)
    bound = field.slope_bound(amplitude)
    size = np.hypot(amplitude[:, :waves], amplitude[:, waves:])
    turn = np.linspace(0.0, math.pi, 20_001)
    along = np.abs(field.wave_numbers @ np.stack([np.cos(turn), np.sin(turn)]))
    expected = 5.0 / math.sqrt(waves) * (size @ along).max(axis=1)
    np.testing.assert_allclose(bound, expected, rtol=1e-6)


def test_no_slope_is_above_the_bound() -> None:
    field = TerrainError(9.73, 100.0, 6)
    amplitude = amplitudes(field, 1, 4)[0]
    places = np.random.default_rng(3).uniform(-1e5, 1e5, (100_000, 2))
    h = 1e-3
    east, north = (
        (field.errors(amplitude, places + e) - field.errors(amplitude, places - e)) / (2.0 * h)
        for e in ((h, 0.0), (0.0, h))
    )
    steepest = np.hypot(east, north).max()
    bound = field.slope_bound(amplitude[None])[0]
    assert 0.75 * bound < steepest <= bound + 1e-6


def test_an_infinite_length_is_the_same_error_everywhere() -> None:
    field = TerrainError(4.0, math.inf, 8)
    amplitude = amplitudes(field, 1)[0]
    errors = field.errors(amplitude, [[0.0, 0.0], [5e4, -3e3]])
    assert errors[0] == pytest.approx(4.0 / math.sqrt(8) * amplitude[:8].sum())
    assert errors[0] == pytest.approx(errors[1], abs=1e-12)
    assert field.slope_bound(amplitude[None])[0] == 0.0


def test_wave_numbers_are_fixed_by_the_seed() -> None:
    field = TerrainError()
    np.testing.assert_array_equal(field.wave_numbers, TerrainError().wave_numbers)
    assert (field.wave_numbers != TerrainError(seed=1).wave_numbers).any()
    assert not field.wave_numbers.flags.writeable
    assert field.deviation == pytest.approx(9.73, abs=0.005)
    angles = np.arctan2(field.wave_numbers[:, 1], field.wave_numbers[:, 0])
    assert (np.diff(angles) > 0).all()
    assert (angles >= 0).all()


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"deviation": 0.0}, "deviation"),
        ({"deviation": math.inf}, "deviation"),
        ({"correlation_length": -1.0}, "correlation_length"),
        ({"correlation_length": math.nan}, "correlation_length"),
        ({"waves": 0}, "waves"),
        ({"waves": 1.5}, "waves"),
        ({"seed": -1}, "seed"),
        ({"seed": True}, "seed"),
    ],
)
def test_fields_that_are_none(arguments: dict, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        TerrainError(**arguments)


def test_wrong_amplitudes_and_places() -> None:
    field = TerrainError(waves=4)
    with pytest.raises(ArgumentError, match="amplitudes"):
        field.slope_bound(np.zeros((3, 7)))
    with pytest.raises(ArgumentError, match="amplitudes"):
        field.errors(np.zeros(7), np.zeros((1, 2)))
    with pytest.raises(ArgumentError, match="places"):
        field.errors(np.zeros(8), np.zeros((1, 3)))
