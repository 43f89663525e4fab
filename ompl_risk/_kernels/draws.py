"""Random numbers inside kernels: a generator whose whole state is one number of the caller.

SplitMix64: the state moves on by a fixed odd number, and a mixing function makes each of its
values a random one. Runs with the same seed draw the same numbers, whatever else goes on in the
process.

Reference: Steele, Lea & Flood, Fast splittable pseudorandom number generators, OOPSLA 2014.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel

_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)


@kernel
def uniform(seed):
    """A number in [0, 1), a multiple of 2^-53; ``seed``, shape (1,) uint64, moves on."""
    seed[0] += _STEP
    z = seed[0]
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return float((z ^ (z >> _31)) >> _11) * 2.0**-53


@kernel
def between(seed, low, high):
    """A number in [low, high)."""
    return low + (high - low) * uniform(seed)


@kernel
def whole(seed, low, high):
    """A whole number from ``low`` to ``high``, both included."""
    return low + int(uniform(seed) * (high - low + 1))


@kernel
def in_ball(seed, radius):
    """A point spread evenly over a ball around the origin."""
    up = between(seed, -1.0, 1.0)
    turn = between(seed, -math.pi, math.pi)
    r = radius * uniform(seed) ** (1.0 / 3.0)
    level = r * math.sqrt(1.0 - up * up)
    return level * math.cos(turn), level * math.sin(turn), r * up


@entry
def fill(seed, out):
    """``out[k]`` = the next number in [0, 1)."""
    for k in range(len(out)):
        out[k] = uniform(seed)
