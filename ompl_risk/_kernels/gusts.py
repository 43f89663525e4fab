"""Gusts that a vehicle meets: shaping filters driven by white noise, one step at a time.

``filters`` has one row for each step of a plan: what the filters of the three axes need at the
height and speed planned there, and the direction of flight, along which the first axis lies.
"""

from __future__ import annotations

from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.normals import normal

GUST = 5
"""Numbers in the state of the filters: one along the flight, two across it, two upward."""

KEEP, DRIVE, COSINE, SINE = 0, 3, 6, 7
"""Columns of ``filters``."""

FILTER = 8
"""Numbers in a row of ``filters``."""


@kernel
def begin_gust(state, _row, seed):
    """Draw the filters' state from its stationary distribution."""
    for i in range(3):
        state[i] = normal(seed)


@kernel
def advance_gust(state, row, seed, wind):
    """One step of the filters; ``wind`` (3,) = the gust in the world [m/s]."""
    for i in range(3):
        state[i] = row[KEEP + i] * state[i] + row[DRIVE + i] * normal(seed)
    wind[0] = row[COSINE] * state[0] - row[SINE] * state[1]
    wind[1] = row[SINE] * state[0] + row[COSINE] * state[1]
    wind[2] = state[2]
