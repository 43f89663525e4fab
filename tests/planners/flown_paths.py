"""Random paths over random hills, their norms, and an optimum by other means."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.improve.judge import FINE
from ompl_risk.terrains import Terrain

NORMS = [Sobolev(1), Sobolev(1, time_scale=4.0), Lp(1), Lp(2), Lp(3.5), Lp(math.inf)]
D0 = 60.0


def hills(seed):
    rng = np.random.default_rng(seed)
    x = np.arange(0.0, 801.0, 20.0)
    heights = np.zeros((len(x), len(x)))
    for _ in range(8):
        east, north, wide = rng.uniform(0, 800), rng.uniform(0, 800), rng.uniform(60, 200)
        square = (x - east) ** 2 + ((x - north) ** 2)[:, None]
        heights += rng.uniform(10, 60) * np.exp(-square / wide**2)
    return Terrain(heights, spacing=(20.0, 20.0))


def walk(clearance, seed, corners):
    """A path over hills that may be flown, at 8 to 60 m above their tops."""
    rng = np.random.default_rng(seed)
    path = np.empty((corners, 3))
    path[:, :2] = rng.uniform(10.0, 790.0, (corners, 2))
    path[:, 2] = clearance.terrain.heights.max() * rng.uniform(0.3, 1.0, corners)
    path[:, 2] += rng.uniform(15.0, 60.0, corners)
    while min(dense(clearance, path, 2.0)[1]) < 8.0:
        path[:, 2] += 5.0
    return path


def dense(clearance, path, step=0.05):
    """Times and clearances along a path at 1 m/s, with every corner among the samples."""
    legs = np.linalg.norm(np.diff(path, axis=0), axis=1)
    reached = np.concatenate([[0.0], np.cumsum(legs)])
    parts = [
        np.linspace(s0, s1, max(2, math.ceil((s1 - s0) / step) + 1))[:-1]
        for s0, s1 in pairwise(reached)
    ]
    s = np.unique(np.concatenate([*parts, reached[-1:]]))
    points = np.column_stack([np.interp(s, reached, path[:, k]) for k in range(3)])
    return s, clearance(points)


def norm_along(clearance, path, norm, speed, d0=D0, step=0.05):
    """The norm by its definition from dense samples, without the library's norms."""
    s, d = dense(clearance, path, step)
    t, f = s / speed, np.maximum(1.0 / d - 1.0 / d0, 0.0)
    if isinstance(norm, Sobolev):
        rate = norm.time_scale * np.diff(f) / np.diff(t)
        middle = 0.5 * (f[1:] ** 2 + f[:-1] ** 2)
        return math.sqrt((np.diff(t) * (middle + rate**2)).sum())
    if math.isinf(norm.p):
        return f.max()
    return np.trapezoid(f**norm.p, t) ** (1.0 / norm.p)


def power(norm, value):
    """The p-th power of a norm, or the norm for p = inf: what the motions of a path add up to."""
    return value if math.isinf(norm.exponent) else value**norm.exponent


def power_along(clearance, path, norm, speed):
    """That of the norm along a path, and how exactly dense samples tell it."""
    fine, coarse = (
        power(norm, norm_along(clearance, path, norm, speed, step=step)) for step in (0.05, 0.1)
    )
    return fine, abs(fine - coarse)


def left_open(risk, duration):
    """How much of that the judge of paths may leave out, as it is negligible."""
    return FINE * risk.negligible * duration


def least_norm_over_flat_ground(norm, d0, ends, length, longest, speed):
    """The least norm from one place to another at the same height, by the calculus of variations.

    Over flat ground d = z. The integrand by x, with z' = tan(angle) and a price of time, is
    ((f^p + price) + (tau speed df/dz)^2 sin^2) / cos. It does not depend on x, so with c = cos
    ``c (f^p + price - (tau speed df/dz)^2 (1 - c^2))`` is constant along the best path: that gives
    the slope at each height below the top, and x, duration and norm are integrals over heights.
    """
    p, tau = norm.exponent, getattr(norm, "time_scale", 0.0)
    node, share = np.polynomial.legendre.leggauss(150)
    u, share = 0.5 * (node + 1.0), 0.5 * share

    def extremal(top, price):
        z, dz = top - (top - ends) * u**2, 2.0 * (top - ends) * u * share
        power, steep = (1 / z - 1 / d0) ** p, (tau * speed / z**2) ** 2
        constant = (1 / top - 1 / d0) ** p + price
        low, high = np.zeros_like(z), np.ones_like(z)
        for _ in range(50):
            c = 0.5 * (low + high)
            above = steep * c**3 + (power + price - steep) * c > constant
            low, high = np.where(above, low, c), np.where(above, c, high)
        s = np.sqrt(1.0 - c * c)
        ds = dz / s
        return 2 * np.array(
            [(ds * c).sum(), ds.sum() / speed, (ds * (power + steep * s * s)).sum()]
        )

    def price_of(top):
        return brentq(lambda e: extremal(top, math.exp(e))[0] - length, -18.0, 7.0, xtol=1e-9)

    def excess(top):
        if extremal(top, math.exp(-18.0))[0] > length:  # not even time for free leads so high
            return length
        return extremal(top, math.exp(price_of(top)))[1] - longest

    top = brentq(excess, 1.3 * ends, 0.999 * d0, xtol=1e-6)
    _, duration, power = extremal(top, math.exp(price_of(top)))
    assert duration == pytest.approx(longest, rel=1e-6)
    return (power / speed) ** (1.0 / p)
