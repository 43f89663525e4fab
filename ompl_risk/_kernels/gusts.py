"""Gusts that a vehicle meets: shaping filters driven by white noise, one step at a time.

The states of the filters are without unit and have the same stationary covariance whatever the
height and the speed: what changes along a plan are the coefficients of a row, and neither the
variance nor the state jumps there.

- Along the flight, one state: ``x' = -x + white noise``, time in units of T = L / V.
- Across it and upward, two: ``x1' = -x1 + white noise``, ``x2' = -x2 + x1``, and the gust is
  ``sigma (sqrt(3) x1 + (1 - sqrt(3)) x2)``, which has the transfer function
  ``sigma (1 + sqrt(3) T s) / (1 + T s)^2``. Their stationary covariance is P = (2, 1; 1, 1) / 4.

A step multiplies the states by the transition matrix Phi and adds normal numbers of the covariance
``P - Phi P Phi^T``, so that the states at the steps have the very covariances of the continuous
ones, however long a step is.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.normals import normal

GUST = 5
"""Numbers in the state of the filters: one along the flight, two across it, two upward."""

ALONG, ACROSS, UP, COSINE, SINE, LEVEL_SIGMA, UP_SIGMA = 0, 2, 7, 12, 13, 14, 15
"""Columns of ``filters``: what is kept and added along; what is kept, passed on and added (three
numbers, a triangular root of the covariance) across and up; the direction of flight, along which
the first axis lies; standard deviations of the level and of the upward gusts [m/s]."""

FILTER = 16
"""Numbers in a row of ``filters``."""

FIRST, SECOND = math.sqrt(3.0), 1.0 - math.sqrt(3.0)
"""Shares of the two states in a gust across or upward."""

_ROOT_11, _ROOT_21, _ROOT_22 = math.sqrt(0.5), math.sqrt(0.125), math.sqrt(0.125)


@kernel
def begin_gust(state, _row, seed):
    """Draw the filters' state from its stationary distribution, with five normal numbers."""
    state[0] = normal(seed)
    for i in range(1, GUST, 2):
        first, second = normal(seed), normal(seed)
        state[i] = _ROOT_11 * first
        state[i + 1] = _ROOT_21 * first + _ROOT_22 * second


@kernel
def advance_gust(state, row, seed, wind):
    """One step of the filters, with five normal numbers; ``wind`` (3,) = the gust in the world."""
    state[0] = row[ALONG] * state[0] + row[ALONG + 1] * normal(seed)
    v = row[LEVEL_SIGMA] * _second_order(state, 1, row, ACROSS, seed)
    w = row[UP_SIGMA] * _second_order(state, 3, row, UP, seed)
    u = row[LEVEL_SIGMA] * state[0]
    wind[0] = row[COSINE] * u - row[SINE] * v
    wind[1] = row[SINE] * u + row[COSINE] * v
    wind[2] = w


@kernel
def _second_order(state, i, row, at, seed):
    """One step of the two states at ``i``; the gust in units of its standard deviation."""
    first, second = normal(seed), normal(seed)
    x, y = state[i], state[i + 1]
    x, y = (
        row[at] * x + row[at + 2] * first,
        (row[at] * y + row[at + 1] * x + row[at + 3] * first + row[at + 4] * second),
    )
    state[i], state[i + 1] = x, y
    return FIRST * x + SECOND * y


@entry
def blow(filters, seed, state, winds):
    """``winds[k]`` (3,) = the gust in the world [m/s] after step k, from a stationary start."""
    begin_gust(state, filters[0], seed)
    for k in range(len(filters)):
        advance_gust(state, filters[k], seed, winds[k])
