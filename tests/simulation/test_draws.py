"""Draws: each rollout's random numbers depend on the seed and its own number only."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstest

from ompl_risk._kernels import normals
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances

SOME = Disturbances(terrain=TerrainError(waves=5))


@settings(deadline=None)  # the first call compiles
@given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 2**63 - 1))
def test_more_rollouts_begin_with_the_fewer(few: int, more: int, seed: int) -> None:
    one, other = Draws.make(few, seed, SOME), Draws.make(few + more, seed, SOME)
    assert len(one) == few
    np.testing.assert_array_equal(one.seeds, other.seeds[:few])
    np.testing.assert_array_equal(one.amplitudes, other.amplitudes[:few])


def test_streams_do_not_depend_on_the_terrain_error() -> None:
    more = Draws.make(50, 7, Disturbances(terrain=TerrainError(waves=64)))
    none = Draws.make(50, 7, Disturbances())
    assert none.amplitudes.shape == (50, 0)
    np.testing.assert_array_equal(more.seeds, none.seeds)
    np.testing.assert_array_equal(more.amplitudes[:, :10], Draws.make(50, 7, SOME).amplitudes)


def test_rollouts_and_seeds_differ() -> None:
    seeds = np.concatenate([Draws.make(20_000, s, Disturbances()).seeds for s in (0, 1, 2, 2**40)])
    assert len(np.unique(seeds)) == 80_000


def test_amplitudes_are_independent_standard_normal_numbers() -> None:
    draws = Draws.make(3000, 11, Disturbances(terrain=TerrainError(waves=16)))
    a = draws.amplitudes
    assert kstest(a.ravel(), "norm").pvalue > 1e-3
    off = np.corrcoef(a.T) - np.eye(32)
    assert np.abs(off).max() < 4.5 / np.sqrt(3000)
    neighbours = (a[1:] * a[:-1]).mean()
    assert abs(neighbours) < 4.5 / np.sqrt(a.size)


def test_flights_do_not_meet_the_numbers_of_their_ground() -> None:
    draws = Draws.make(2000, 5, Disturbances(terrain=TerrainError(waves=8)))
    met = np.empty((2000, 16))
    for k in range(2000):
        normals.fill_normal(np.array([draws.seeds[k]]), met[k])
    assert kstest(met.ravel(), "norm").pvalue > 1e-3
    cross = np.corrcoef(met.T, draws.amplitudes.T)[:16, 16:]
    assert np.abs(cross).max() < 4.5 / np.sqrt(2000)


def test_weights_are_equal_and_arrays_read_only() -> None:
    draws = Draws.make(4, 0, SOME)
    np.testing.assert_array_equal(draws.log_weights, np.zeros(4))
    assert draws.seeds.dtype == np.uint64
    again = pickle.loads(pickle.dumps(draws))
    for one in (draws, again):
        assert not any(
            array.flags.writeable for array in (one.seeds, one.amplitudes, one.log_weights)
        )
    np.testing.assert_array_equal(again.amplitudes, draws.amplitudes)


@pytest.mark.parametrize(
    ("count", "seed", "name"),
    [(0, 0, "count"), (1.5, 0, "count"), (True, 0, "count"), (1, -1, "seed"), (1, 2**63, "seed")],
)
def test_draws_that_are_none(count, seed, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        Draws.make(count, seed, SOME)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((np.arange(3), np.zeros((3, 2))), "seeds"),
        ((np.zeros((3, 1), np.uint64), np.zeros((3, 2))), "seeds"),
        ((np.zeros(3, np.uint64), np.zeros((2, 2))), "amplitudes"),
        ((np.zeros(3, np.uint64), np.full((3, 2), np.nan)), "amplitudes"),
        ((np.zeros(3, np.uint64), np.zeros((3, 2)), np.zeros(2)), "log_weights"),
    ],
)
def test_arrays_that_do_not_fit(arguments: tuple, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        Draws(*arguments)
