"""Normal random numbers inside kernels: one uniform number each, so that streams keep step.

The inverse of the normal distribution function (Wichura's rational approximations, relative error
about 1e-16) at a uniform number of the stream. Rejection methods would take a varying number of
uniform numbers, and two runs with common random numbers would fall out of step.

Reference: Wichura, Algorithm AS 241: the percentage points of the normal distribution, Applied
Statistics 37 (1988).
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.draws import uniform
from ompl_risk._kernels.jit import entry, kernel


@kernel
def quantile(p):
    """The number that a standard normal variable stays below with probability p, 0 < p < 1."""
    q = p - 0.5
    if abs(q) <= 0.425:
        r = 0.180625 - q * q
        return (
            q
            * (
                ((((((2509.0809287301226727 * r + 33430.575583588128105) * r
                     + 67265.770927008700853) * r + 45921.953931549871457) * r
                   + 13731.693765509461125) * r + 1971.5909503065514427) * r
                 + 133.14166789178437745) * r + 3.387132872796366608
            )
            / (
                ((((((5226.495278852545925 * r + 28729.085735721942674) * r
                     + 39307.89580009271061) * r + 21213.794301586595867) * r
                   + 5394.1960214247511077) * r + 687.1870074920579083) * r
                 + 42.313330701600911252) * r + 1.0
            )
        )  # fmt: skip
    r = math.sqrt(-math.log(min(p, 1.0 - p)))
    if r <= 5.0:
        r -= 1.6
        value = (
            ((((((7.7454501427834140764e-4 * r + 0.0227238449892691845833) * r
                 + 0.24178072517745061177) * r + 1.27045825245236838258) * r
               + 3.64784832476320460504) * r + 5.7694972214606914055) * r
             + 4.6303378461565452959) * r + 1.42343711074968357734
        ) / (
            ((((((1.05075007164441684324e-9 * r + 5.475938084995344946e-4) * r
                 + 0.0151986665636164571966) * r + 0.14810397642748007459) * r
               + 0.68976733498510000455) * r + 1.6763848301838038494) * r
             + 2.05319162663775882187) * r + 1.0
        )  # fmt: skip
    else:
        r -= 5.0
        value = (
            ((((((2.01033439929228813265e-7 * r + 2.71155556874348757815e-5) * r
                 + 0.0012426609473880784386) * r + 0.026532189526576123093) * r
               + 0.29656057182850489123) * r + 1.7848265399172913358) * r
             + 5.4637849111641143699) * r + 6.6579046435011037772
        ) / (
            ((((((2.04426310338993978564e-15 * r + 1.4215117583164458887e-7) * r
                 + 1.8463183175100546818e-5) * r + 7.868691311456132591e-4) * r
               + 0.0148753612908506148525) * r + 0.13692988092273580531) * r
             + 0.59983220655588793769) * r + 1.0
        )  # fmt: skip
    return -value if q < 0.0 else value


@kernel
def normal(seed):
    """A standard normal number; ``seed``, shape (1,) uint64, moves on by one uniform number."""
    return quantile(uniform(seed) + 2.0**-54)


@entry
def fill_normal(seed, out):
    """``out[k]`` = the next standard normal number."""
    for k in range(len(out)):
        out[k] = normal(seed)


@entry
def quantiles(p, out):
    """``out[k]`` = the quantile at ``p[k]``."""
    for k in range(len(p)):
        out[k] = quantile(p[k])


@kernel
def _word(seed):
    """A random word of 53 bits, to start another stream from."""
    return np.uint64(uniform(seed) * 2.0**53)


@entry
def fill_draws(seed, seeds, amplitudes):
    """Starts of streams ``seeds`` (N,), and normal ``amplitudes`` (N, n) from streams of their own.

    Row k depends on ``seed`` and k only: of two streams that start at mixed values of the seed, it
    takes the k-th numbers.
    """
    stream, other = np.empty(1, np.uint64), np.empty(1, np.uint64)
    own = np.empty(1, np.uint64)
    stream[0], other[0] = seed, ~seed
    stream[0], other[0] = _word(stream), _word(other)
    for k in range(len(seeds)):
        seeds[k], own[0] = _word(stream), _word(other)
        for j in range(amplitudes.shape[1]):
            amplitudes[k, j] = normal(own)
