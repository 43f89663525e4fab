"""Steerings, pairs of places, and what dense sampling finds."""

import math

import numpy as np
import pytest

from ompl_risk.avoidance import InverseDistance
from ompl_risk.motion import (
    Connection,
    Risk,
    Steering,
)
from ompl_risk.norms import Lp, Sobolev

NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]

D0, SPEED = 30.0, 20.0
norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


class Arc(Steering):
    """Half a circle at constant speed, to the left or upwards."""

    def __init__(self, *, upwards=False, pieces=24, reach=math.inf):
        self.symmetric, self._pieces, self._reach, self.asked = upwards, pieces, reach, 0

    def connect(self, a, b):
        self.asked += 1
        half = 0.5 * (b - a)
        radius = float(np.linalg.norm(half))
        if radius > self._reach:
            return Connection.none()
        left = np.array([-half[1], half[0], 0.0])
        side = np.cross(half, left) if self.symmetric else left
        side *= radius / np.linalg.norm(side)
        angle = np.linspace(0.0, math.pi, self._pieces + 1)[:, None]
        samples = a + half - np.cos(angle) * half + np.sin(angle) * side
        return Connection(math.pi * radius / SPEED, samples)


def risk_of(norm=None, **options):
    options = {"speed": SPEED, "duration_weight": 0.0, "tolerance": 1e-3, **options}
    return Risk(InverseDistance(D0), norm or Sobolev(1), **options)


def pairs(clearance, n, seed=0, low=5.0, high=40.0):
    rng = np.random.default_rng(seed)
    start = rng.uniform(100, 290, (n, 2))
    xy = np.stack([start, start + rng.uniform(-60, 60, (n, 2))])
    z = clearance.terrain.height(xy[..., 0], xy[..., 1]) + rng.uniform(low, high, (2, n))
    return np.concatenate([xy, z[..., None]], axis=-1)


def grazing(norm, speed):
    """What dipping just below d0 costs: errors there are as small."""
    if isinstance(norm, Sobolev):
        return norm.time_scale**2 * speed / D0**3
    return 1 / D0 if math.isinf(norm.exponent) else D0 ** (1 - norm.exponent) / speed
