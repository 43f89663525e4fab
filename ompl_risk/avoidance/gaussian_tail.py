"""The probability that a Gaussian error uses up the distance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfc

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.avoidance.base import Avoidance, checked_distance

REACH = 4.0
"""d0 in standard deviations unless it is given: Q(4) = 3.2e-5."""


@dataclass(frozen=True, init=False)
class GaussianTail(Avoidance):
    """The probability that an error of the distance exceeds it.

        f(d) = Q(d / sigma) - Q(d0 / sigma)   for 0 < d < d0
             = 0                              for d >= d0
             = +inf                           for d <= 0

    with ``Q(x) = erfc(x / sqrt(2)) / 2``. If the true distance is d + e, and e (where the vehicle
    is, and where the ground is) has a normal distribution of mean 0 and standard deviation sigma,
    then ``P(d + e <= 0) = Q(d / sigma)``. The constant makes f end continuously at d0; at the
    default, 4 sigma, it is 3.2e-5. f lies between 0 and 1/2 and is convex in d.

    Args:
        sigma: standard deviation of the distance's error [m], positive and finite.
        d0: distance [m] from which obstacles pose no danger; 4 sigma if left out.

    Raises:
        ArgumentError: sigma or d0 is not a positive finite number.

    Reference:
        Blackmore, Ono & Williams, Chance-Constrained Optimal Path Planning With Obstacles, 2011:
        the probability of violating one linear constraint. Zhu & Alonso-Mora, Chance-Constrained
        Collision Avoidance for MAVs in Dynamic Environments, 2019: obstacles linearised so.

    Example:
        >>> round(float(GaussianTail(10.0)(10.0)), 5)
        0.15862
    """

    sigma: float
    d0: float

    def __init__(self, sigma: float, *, d0: float | None = None) -> None:
        sigma = positive("sigma", sigma)
        object.__setattr__(self, "sigma", sigma)
        object.__setattr__(self, "d0", positive("d0", REACH * sigma if d0 is None else d0))

    @property
    def steady(self) -> float:
        """sigma [m], or d0 / 2 if that is less: near the ground f falls by half or more over it."""
        return min(self.sigma, 0.5 * self.d0)

    @property
    def offset(self) -> float:
        """Q(d0 / sigma), which f lacks to the whole tail."""
        return float(upper_tail(self.d0 / self.sigma))

    def __call__(self, d: ArrayLike) -> FloatArray:
        """Values of f at the distances `d` [m], any shape."""
        d = checked_distance(d)
        f = np.maximum(upper_tail(np.maximum(d, 0.0) / self.sigma) - self.offset, 0.0)
        return np.where(d <= 0, np.inf, np.where(d < self.d0, f, 0.0))[()]

    def derivative(self, d: ArrayLike) -> FloatArray:
        """df/dd = -phi(d / sigma) / sigma [1/m] on (0, d0), 0 from d0 on, -inf for d <= 0."""
        d = checked_distance(d)
        x = np.maximum(d, 0.0) / self.sigma
        with np.errstate(over="ignore"):
            slope = -np.exp(-0.5 * x * x) / (self.sigma * math.sqrt(2.0 * math.pi))
        return np.where(d <= 0, -np.inf, np.where(d < self.d0, slope, 0.0))[()]


def upper_tail(x: ArrayLike) -> FloatArray:
    """Q(x), the probability that a standard normal number exceeds x; any shape."""
    return 0.5 * erfc(np.asarray(x, dtype=np.float64) * math.sqrt(0.5))
