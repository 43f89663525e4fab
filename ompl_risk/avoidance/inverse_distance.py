"""The paper's avoidance function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.avoidance.base import Avoidance, checked_distance


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

    @property
    def unit(self) -> str:
        """1/m."""
        return "1/m"

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

    @property
    def typical(self) -> float:
        """f(d0 / 2) = 1 / d0 [1/m]."""
        return 1.0 / self.d0
