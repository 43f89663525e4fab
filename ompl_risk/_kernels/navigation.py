"""Errors of the navigation solution: slowly drifting biases plus noise, one update at a time.

Errors are 9 numbers: position in the world [m], attitude (a rotation vector in the body's frame)
[rad], and velocity in the body's frame [m/s].
"""

from __future__ import annotations

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.normals import normal

NAVIGATION = 9
"""Numbers in the errors, and in the biases that are their state."""

KEEP, DRIVE, BIAS, NOISE = 0, NAVIGATION, 2 * NAVIGATION, 3 * NAVIGATION
"""Places in ``given``: what is kept of a bias from one update to the next, what is added to it in
normal numbers, the standard deviations of the biases, and those of the noise."""

GIVEN = 4 * NAVIGATION
"""Numbers in ``given``."""


@kernel
def begin_navigation(bias, given, seed):
    """Draw the biases from their stationary distribution, with nine normal numbers."""
    for i in range(NAVIGATION):
        bias[i] = given[BIAS + i] * normal(seed)


@kernel
def advance_navigation(bias, given, seed, error):
    """One update of the biases, and the errors that come of them; eighteen normal numbers."""
    for i in range(NAVIGATION):
        bias[i] = given[KEEP + i] * bias[i] + given[DRIVE + i] * normal(seed)
        error[i] = bias[i] + given[NOISE + i] * normal(seed)


@entry
def drift(given, seed, bias, errors):
    """``errors[k]`` (9,) = the errors after update k, from a stationary start."""
    begin_navigation(bias, given, seed)
    for k in range(len(errors)):
        advance_navigation(bias, given, seed, errors[k])
