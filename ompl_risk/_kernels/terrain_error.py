"""How much higher the ground is than the map says: a sum of waves with random amplitudes.

With independent standard normal ``amplitudes`` this is a stationary Gaussian field of variance
``scale^2`` whose covariance is ``scale^2 / m * sum of cos(k_j . displacement)``, the nearer to
the wanted one the more of its wave numbers are taken.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import entry, kernel


@kernel
def error_at(waves, scale, amplitudes, x, y):
    """Error of the map's height [m] at a place; the ground is there at map + error.

    Args:
        waves: wave numbers [rad/m], shape (m, 2).
        scale: standard deviation [m].
        amplitudes: of cosines and sines, shape (2 m,).
        x, y: place [m].
    """
    m = len(waves)
    total = 0.0
    for j in range(m):
        phase = waves[j, 0] * x + waves[j, 1] * y
        total += amplitudes[j] * math.cos(phase) + amplitudes[m + j] * math.sin(phase)
    return scale / math.sqrt(m) * total


@entry
def errors(waves, scale, amplitudes, places, out):
    """``out[k]`` = the error at ``places[k]``, shape (n, 2)."""
    for k in range(len(places)):
        out[k] = error_at(waves, scale, amplitudes, places[k, 0], places[k, 1])
