"""Constraints of a nonlinear program, collected."""

from __future__ import annotations

from typing import Any

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.helicopter.optimal_control.needs import casadi


class Constraints:
    """Rows low <= g <= high."""

    def __init__(self) -> None:
        self._g: list[Any] = []
        self._low: list[FloatArray] = []
        self._high: list[FloatArray] = []

    def add(self, g: Any, low: float, high: float) -> None:
        """Bound all elements of an expression."""
        flat = casadi().vec(g)
        self._g.append(flat)
        self._low.append(np.full(flat.shape[0], low))
        self._high.append(np.full(flat.shape[0], high))

    @property
    def g(self) -> Any:
        """The expressions, one below the other."""
        return casadi().vertcat(*self._g)

    @property
    def low(self) -> FloatArray:
        """Least values."""
        return np.concatenate(self._low)

    @property
    def high(self) -> FloatArray:
        """Greatest values."""
        return np.concatenate(self._high)
