"""Seeds of rollouts whose navigation begins with a wanted error of height.

The random numbers of a rollout are mixed values of a counter that begins at its seed. Mixing is a
one-to-one map of the words of 64 bits, so the seed that leads to a wanted number is found by going
back through it. All other numbers of the stream are as random as before.

Reference: Steele, Lea & Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import normals
from ompl_risk._kernels.closed_loop import ASIDE

UP = 2
"""Place of the upward bias among the normal numbers that navigation begins with."""

_MASK = 2**64 - 1
_STEP = 0x9E3779B97F4A7C15
_FIRST, _SECOND = 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
_AHEAD = np.uint64((UP + 1) * _STEP & _MASK)
_LOW = np.uint64(2**11 - 1)

Words = NDArray[np.uint64]


def upward_biases(seeds: Words) -> NDArray[np.float64]:
    """The standard normal numbers of which the upward biases are made, shape (N,).

    Args:
        seeds: of rollouts, shape (N,).
    """
    words = _mixed((seeds ^ ASIDE) + _AHEAD)
    found = np.empty(len(seeds))
    normals.quantiles((words >> np.uint64(11)) * 2.0**-53 + 2.0**-54, found)
    return found


def with_upward_biases(seeds: Words, numbers: FloatArray) -> Words:
    """Seeds that lead to other numbers, as near to the wanted ones as there are.

    Args:
        seeds: of rollouts, shape (N,).
        numbers: wanted, shape (N,); those beyond 8 are cut there.
    """
    words = _mixed((seeds ^ ASIDE) + _AHEAD)
    counts = np.clip(ndtr(np.clip(numbers, -8.0, 8.0)) * 2.0**53, 0.0, 2.0**53 - 1.0)
    wanted = (counts.astype(np.uint64) << np.uint64(11)) | (words & _LOW)
    return (_unmixed(wanted) - _AHEAD) ^ ASIDE


def _mixed(words: Words) -> Words:
    words = (words ^ (words >> np.uint64(30))) * np.uint64(_FIRST)
    words = (words ^ (words >> np.uint64(27))) * np.uint64(_SECOND)
    return words ^ (words >> np.uint64(31))


def _unmixed(words: Words) -> Words:
    """The inverse of ``_mixed``."""
    words = _unshifted(words, 31) * np.uint64(pow(_SECOND, -1, 2**64))
    words = _unshifted(words, 27) * np.uint64(pow(_FIRST, -1, 2**64))
    return _unshifted(words, 30)


def _unshifted(words: Words, bits: int) -> Words:
    """The inverse of ``words ^ (words >> bits)`` for at least 22 bits."""
    return words ^ (words >> np.uint64(bits)) ^ (words >> np.uint64(2 * bits))
