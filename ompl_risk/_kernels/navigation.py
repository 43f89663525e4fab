"""Errors of the navigation solution: slowly drifting biases plus noise, one update at a time.

Errors are 9 numbers: position in the world [m], attitude (a rotation vector in the body's frame)
[rad], and velocity in the body's frame [m/s].
"""

from __future__ import annotations

from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.normals import normal

NAVIGATION = 9
"""Numbers in the errors, and in the biases that are their state."""

KEEP, BIAS, NOISE = 0, NAVIGATION, 2 * NAVIGATION
"""Places in ``given``: what is kept of a bias from one update to the next, the standard deviations
of the biases, and those of the noise."""


@kernel
def begin_navigation(bias, given, seed):
    """Draw the biases from their stationary distribution."""
    for i in range(NAVIGATION):
        bias[i] = given[BIAS + i] * normal(seed)


@kernel
def advance_navigation(bias, given, seed, error):
    """One update of the biases, and the errors that come of them."""
    for i in range(NAVIGATION):
        keep = given[KEEP + i]
        bias[i] = keep * bias[i] + given[BIAS + i] * (1.0 - keep * keep) ** 0.5 * normal(seed)
        error[i] = bias[i] + given[NOISE + i] * normal(seed)
