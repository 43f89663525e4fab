"""L^p norms."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.norms.base import Norm


@dataclass(frozen=True)
class Lp(Norm):
    """The L^p norm, for every real p >= 1 and infinity.

        ||f||_p = (integral |f|^p dt) ^ (1/p),    ||f||_inf = max |f|

    Exact for the piecewise-linear interpolant of the samples, whatever the time steps and the
    signs. An interval of length dt from f0 to f1 contributes

        dt (F(f1) - F(f0)) / (f1 - f0),    F(x) = sign(x) |x|^(p+1) / (p+1),

    in a form free of cancellation, so that the norm axioms hold to rounding. For p = inf,
    `shares` splits the maximum equally among the intervals that touch it. With f in 1/m the
    norm is in s^(1/p)/m.

    Args:
        p: the exponent, at least 1, or math.inf.

    Raises:
        ArgumentError: p < 1 or not a number.

    Reference:
        Nair & Kobilarov, equation (4).

    Example:
        >>> Lp(2)([0.0, 4.0], [3.0, 3.0])
        6.0
    """

    p: float

    def __post_init__(self) -> None:
        allowed = "a real number of at least 1, or math.inf"
        p = real_number("p", self.p, allowed)
        if p < 1:
            raise ArgumentError("p", self.p, allowed)
        object.__setattr__(self, "p", p)

    @property
    def exponent(self) -> float:
        """The p of L^p."""
        return self.p

    @property
    def label(self) -> str:
        """Such as "L1", "L2.5", "L∞"."""
        return "L∞" if math.isinf(self.p) else f"L{self.p:g}"

    def _interval_powers(self, t: FloatArray, f: FloatArray) -> FloatArray:
        if not math.isinf(self.p):
            return np.diff(t) * mean_power(f[:-1], f[1:], self.p)
        at_maximum = np.abs(f) == np.abs(f).max()
        touching = at_maximum[:-1] | at_maximum[1:]
        return touching / touching.sum()

    def _total(self, t: FloatArray, f: FloatArray) -> float:
        # Adding up equal parts of a maximum would not give it back to the last digit.
        return 1.0 if math.isinf(self.p) else super()._total(t, f)


def mean_power(f0: FloatArray, f1: FloatArray, p: float) -> FloatArray:
    """Mean of |f|^p over intervals on which f runs straight from f0 to f1.

    With a >= b the magnitudes of the ends and e = (a - b) / a:

        same sign:      a^p (1 - (1 - e)^(p+1)) / ((p+1) e)
        opposite sign:  (a^(p+1) + b^(p+1)) / ((p+1) (a + b))

    Args:
        f0: values at the start, shape (n,).
        f1: values at the end, shape (n,).
        p: finite exponent, at least 1.

    Returns:
        Means, shape (n,).
    """
    a, b = np.maximum(np.abs(f0), np.abs(f1)), np.minimum(np.abs(f0), np.abs(f1))
    q = p + 1.0
    with np.errstate(all="ignore"):  # 0/0 where f0 = f1, and where both are 0: chosen below
        e = (a - b) / a
        same_sign = a**p * (-np.expm1(q * np.log1p(-e)) / (q * e))
        opposite_sign = (a**q + b**q) / (q * (a + b))
        flat = a**p
    return np.select([f0 == f1, np.signbit(f0) == np.signbit(f1)], [flat, same_sign], opposite_sign)
