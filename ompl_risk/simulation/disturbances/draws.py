"""Random numbers of a set of rollouts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, readonly
from ompl_risk._kernels import normals
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.together import Disturbances


@dataclass(frozen=True, eq=False, init=False)
class Draws(ReadOnlyArrays):
    """Random numbers of N rollouts, the same for every plan: common random numbers.

    Arrays are read-only.

    Args:
        seeds: starts of the rollouts' streams, shape (N,) uint64.
        amplitudes: of the waves of the terrain's error, standard normal, cosines before sines,
            shape (N, 2 m).
        log_weights: logarithms of the weights of the rollouts, shape (N,); None: all 0.

    Raises:
        ArgumentError: a wrong shape, or a number that is not finite.
    """

    seeds: NDArray[np.uint64]
    amplitudes: FloatArray
    log_weights: FloatArray

    def __init__(
        self,
        seeds: NDArray[np.uint64],
        amplitudes: ArrayLike,
        log_weights: ArrayLike | None = None,
    ) -> None:
        seeds = np.array(seeds)
        if seeds.dtype != np.uint64 or seeds.ndim != 1:
            raise ArgumentError("seeds", f"{seeds.dtype}{list(seeds.shape)}", "uint64, shape (N,)")
        seeds.setflags(write=False)
        n = len(seeds)
        weights = np.zeros(n) if log_weights is None else log_weights
        object.__setattr__(self, "seeds", seeds)
        object.__setattr__(
            self, "amplitudes", readonly("amplitudes", amplitudes, (n, None), f"({n}, 2 m)")
        )
        object.__setattr__(self, "log_weights", readonly("log_weights", weights, (n,), f"({n},)"))

    def __len__(self) -> int:
        """Rollouts."""
        return len(self.seeds)

    @classmethod
    def make(cls, count: int, seed: int, disturbances: Disturbances) -> Draws:
        """Draw them at random; rollout k's depend on ``seed`` and k only.

        A larger count begins with the rollouts of a smaller one. Gusts and navigation errors are
        drawn along the way from the streams that ``seeds`` begin, so that they do not depend on
        whether there is a terrain error, nor on its number of waves.

        Args:
            count: N.
            seed: 0 or more, below 2^63.
            disturbances: say how many waves there are.

        Raises:
            ArgumentError: a count or a seed that is none.
        """
        count = _whole("count", count, 1)
        seed = _whole("seed", seed, 0)
        waves = 0 if disturbances.terrain is None else disturbances.terrain.waves
        seeds, amplitudes = np.empty(count, np.uint64), np.empty((count, 2 * waves))
        normals.fill_draws(np.uint64(seed), seeds, amplitudes)
        return cls(seeds, amplitudes)


def _whole(name: str, value: Any, least: int) -> int:
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not least <= value < 2**63:
        raise ArgumentError(name, value, f"a whole number from {least}, below 2^63")
    return int(value)
