"""How much higher the ground is than the map says: a sum of waves with random amplitudes.

With independent standard normal ``amplitudes`` this is a stationary Gaussian field of variance
``scale^2`` whose covariance is ``scale^2 / m * sum of cos(k_j . displacement)``.
"""

from __future__ import annotations

import math
from typing import Any

import numba

from ompl_risk._kernels.jit import entry, kernel

_no_counts: dict[str, Any] = {"_nrt": False}
_sum_of_waves = numba.njit(
    cache=True, nogil=True, error_model="numpy", fastmath={"reassoc"}, **_no_counts
)
"""As ``kernel``, and sums may be added up in another order: the compiler then takes several waves
at a time, and 64 of them cost 0.12 us instead of 0.4."""

_WHOLE = 1.5 * 2.0**52
"""Added and taken away again, it rounds a number of a size below 2^51 to a whole one."""


@kernel
def _wave(a, b, phase):
    """``a cos(phase) + b sin(phase)`` without branches, absolute error below 1e-12 (|a| + |b|).

    The phase is brought to within a quarter turn by half turns, which change nothing but the sign.
    There both functions are polynomials of the square, interpolated at its Chebyshev points.
    """
    halves = (phase * (1.0 / math.pi) + _WHOLE) - _WHOLE
    y = phase - halves * math.pi
    t = y * y
    c = 0.9999999999992449 + t * (
        -0.4999999999700001 + t * (
            0.041666666472116046 + t * (
                -0.0013888884155863585 + t * (
                    2.480103859199483e-05 + t * (
                        -2.7524616240390304e-07 + t * 1.9906692747906004e-09
                    )
                )
            )
        )
    )  # fmt: skip
    s = 0.9999999999999497 + t * (
        -0.1666666666646559 + t * (
            0.008333333320294832 + t * (
                -0.00019841266670329516 + t * (
                    2.755695178101678e-06 + t * (
                        -2.503022286519572e-08 + t * 1.5410547462762438e-10
                    )
                )
            )
        )
    )  # fmt: skip
    pairs = 0.5 * halves
    odd = pairs - ((pairs + _WHOLE) - _WHOLE)  # 0 or a half
    return (1.0 - 4.0 * abs(odd)) * (a * c + b * y * s)


@_sum_of_waves
def error_at(waves, scale, amplitudes, x, y):
    """Error of the map's height [m] at a place; the ground is there at map + error.

    Args:
        waves: wave numbers [rad/m], shape (m, 2).
        scale: standard deviation [m].
        amplitudes: of cosines and sines, shape (2 m,).
        x, y: place [m]; phases are good to 1e-16 of the number of half turns from the origin.
    """
    m = len(waves)
    k, b = waves.reshape(2 * m), amplitudes[m:]  # strides that the compiler knows
    total = 0.0
    for j in range(m):
        total += _wave(amplitudes[j], b[j], k[2 * j] * x + k[2 * j + 1] * y)
    return scale / math.sqrt(m) * total


@entry
def errors(waves, scale, amplitudes, places, out):
    """``out[k]`` = the error at ``places[k]``, shape (n, 2)."""
    for k in range(len(places)):
        out[k] = error_at(waves, scale, amplitudes, places[k, 0], places[k, 1])


@entry
def slope_bounds(waves, scale, amplitudes, out):
    """``out[i]`` = a bound for the slope of the field with ``amplitudes[i]``.

    Its gradient is a sum of the wave numbers, each times a factor within plus and minus its size:
    it lies in the zonotope of these segments, whose farthest corner is the bound. One passes the
    corners by taking over one segment after the other in the order of their directions.

    Args:
        waves: wave numbers [rad/m], shape (m, 2), their directions increasing over a half turn.
        scale: standard deviation [m].
        amplitudes: of cosines and sines, shape (N, 2 m), in the same order.
        out: written, shape (N,).
    """
    m = len(waves)
    for i in range(len(amplitudes)):
        gx = gy = 0.0
        for j in range(m):
            size = math.hypot(amplitudes[i, j], amplitudes[i, m + j])
            gx += size * waves[j, 0]
            gy += size * waves[j, 1]
        farthest = gx * gx + gy * gy
        for j in range(m):
            size = 2.0 * math.hypot(amplitudes[i, j], amplitudes[i, m + j])
            gx -= size * waves[j, 0]
            gy -= size * waves[j, 1]
            farthest = max(farthest, gx * gx + gy * gy)
        out[i] = scale / math.sqrt(m) * math.sqrt(farthest)
