"""The avoidance function: how much danger a distance to obstacles stands for."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats, positive
from ompl_risk.errors import ArgumentError


class Avoidance(ABC):
    """A function f(d) of the signed distance to obstacles, the integrand of every norm.

    The implementer's duties:

    1. `d0` [m] is finite and f(d) = 0 for every d >= d0: clearances stop searching there.
    2. f does not increase with d, and is continuous on (0, d0].
    3. f(d) = +inf for d <= 0: a collision is infeasible, never a large finite number.
    4. Both methods take arrays of any shape and return float64 of that shape; NaN is refused
       (`checked_distance` does it).
    5. Instances are immutable and hashable, equal when their parameters are.
    """

    d0: float
    """Distance [m] from which obstacles pose no danger."""

    @abstractmethod
    def __call__(self, d: ArrayLike) -> FloatArray:
        """Values of f at the distances `d` [m], any shape."""

    @abstractmethod
    def derivative(self, d: ArrayLike) -> FloatArray:
        """df/dd at the distances `d` [m], any shape."""


@dataclass(frozen=True)
class InverseDistance(Avoidance):
    """The paper's avoidance function.

        f(d) = 1/d - 1/d0   for 0 < d < d0
             = 0            for d >= d0
             = +inf         for d <= 0

    Its unit is 1/m.

    Args:
        d0: distance [m] from which obstacles pose no danger, positive and finite.

    Raises:
        ArgumentError: d0 is not a positive finite number.

    Reference:
        Nair & Kobilarov, equation (3).

    Example:
        >>> float(InverseDistance(d0=100.0)(50.0))
        0.01
    """

    d0: float = 100.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "d0", positive("d0", self.d0))

    def __call__(self, d: ArrayLike) -> FloatArray:
        """Values of f [1/m] at the distances `d` [m], any shape."""
        d = checked_distance(d)
        with np.errstate(divide="ignore", over="ignore"):
            f = np.where(d < self.d0, 1.0 / d - 1.0 / self.d0, 0.0)
        return np.where(d <= 0, np.inf, f)[()]

    def derivative(self, d: ArrayLike) -> FloatArray:
        """df/dd = -1/d^2 [1/m^2] on (0, d0), 0 from d0 on, -inf (the limit at 0) for d <= 0."""
        d = checked_distance(d)
        with np.errstate(divide="ignore", over="ignore"):
            slope = np.where(d < self.d0, -((1.0 / d) ** 2), 0.0)
        return np.where(d <= 0, -np.inf, slope)[()]


def checked_distance(d: ArrayLike) -> FloatArray:
    """Distances as float64; infinities pass, NaN does not.

    Raises:
        ArgumentError: a distance is NaN or no number.
    """
    d = as_floats("d", d)
    if np.isnan(d).any():
        raise ArgumentError("d", float("nan"), "distances [m] without NaN")
    return d
