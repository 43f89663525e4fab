"""What every avoidance function has in common."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats
from ompl_risk.errors import ArgumentError

_HALVINGS = 60
"""How often d0 is halved at most to find a positive value of f."""


class Avoidance(ABC):
    """A function f(d) of the signed distance to obstacles, the integrand of every norm.

    The implementer's duties:

    1. `d0` [m] is finite and f(d) = 0 for every d >= d0: clearances stop searching there.
    2. f does not increase with d, and is continuous on (0, d0].
    3. f(d) = +inf for d <= 0: a collision is infeasible, never a large finite number.
    4. Both methods take arrays of any shape and return float64 of that shape; NaN is refused
       (`checked_distance` does it). The derivative is -inf for d <= 0.
    5. Instances are immutable and hashable, equal when their parameters are.
    6. `steady` is None if f can change at d by as much as itself over a length of about d, as
       functions do that have a pole at 0. If f is bounded near obstacles, `steady` may be the
       length [m] over which it changes by a good part, wherever d is: integrals then take no
       ever smaller steps where d is small.
    """

    d0: float
    """Distance [m] from which obstacles pose no danger."""

    @abstractmethod
    def __call__(self, d: ArrayLike) -> FloatArray:
        """Values of f at the distances `d` [m], any shape."""

    @abstractmethod
    def derivative(self, d: ArrayLike) -> FloatArray:
        """df/dd at the distances `d` [m], any shape."""

    @property
    def unit(self) -> str:
        """Unit of f: "1/m", or "1" for a bare number."""
        return "1"

    @property
    def steady(self) -> float | None:
        """Length [m] over which f changes by a good part; None where that is d itself."""
        return None

    @property
    def typical(self) -> float:
        """f half-way to d0, in the unit of f: what a value of f is large or small against.

        Where f is 0 there, half-way to that, and so on; 1 if f is 0 everywhere.
        """
        return next((f for f in self(self.d0 * 0.5 ** np.arange(1, _HALVINGS)).tolist() if f), 1.0)


def checked_distance(d: ArrayLike) -> FloatArray:
    """Distances as float64; infinities pass, NaN does not.

    Raises:
        ArgumentError: a distance is NaN or no number.
    """
    d = as_floats("d", d)
    if np.isnan(d).any():
        raise ArgumentError("d", math.nan, "distances [m] without NaN")
    return d
