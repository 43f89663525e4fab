"""What every norm of a function of time has in common."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats, increasing_times
from ompl_risk.errors import ArgumentError


class Norm(ABC):
    """A norm of the function that interpolates the samples (t, f).

    With p = `exponent`, `shares(t, f)` are the contributions of the n - 1 intervals and

        power(t, f) = sum of shares,    norm(t, f) = power ** (1 / p).

    For p = inf, power and norm are both max |f|. If f holds an infinity (a collision) the norm
    and the power are inf; NaN is refused. Samples: t [s], shape (n,), n >= 2, strictly
    increasing; f, shape (n,), of either sign.

    The implementer's duties:

    1. `_interval_powers(t, f)` returns non-negative contributions, shape (n - 1,). It is called
       with finite samples scaled to max |f| = 1, so it need not care about overflow.
    2. It is homogeneous: contributions of c f are |c| ** p times those of f (c times, p = inf).
    3. `label` is short and differs between norms that differ.
    4. `needs_uniform_times` is True if unequal steps are an error.
    5. Instances are immutable and hashable, equal when their parameters are.
    """

    @property
    @abstractmethod
    def exponent(self) -> float:
        """The p for which norm ** p adds up over intervals; inf if the norm is a maximum."""

    @property
    @abstractmethod
    def label(self) -> str:
        """Short name, such as "L2" or "H1(τ=0.5 s)"."""

    @property
    def needs_uniform_times(self) -> bool:
        """Whether t must have equal steps."""
        return False

    @abstractmethod
    def _interval_powers(self, t: FloatArray, f: FloatArray) -> FloatArray:
        """Contribution of each interval, shape (n - 1,)."""

    def _total(self, t: FloatArray, f: FloatArray) -> float:
        return float(self._interval_powers(t, f).sum())

    def __call__(self, t: ArrayLike, f: ArrayLike) -> float:
        """The norm, root taken.

        Raises:
            ArgumentError: shapes differ, times do not increase, or f holds NaN.
        """
        t, f = checked_samples(t, f)
        scale = float(np.abs(f).max())
        if scale == 0.0 or math.isinf(scale):
            return scale
        return scale * self._total(t, f / scale) ** (1.0 / self._degree)

    def power(self, t: ArrayLike, f: ArrayLike) -> float:
        """The norm to the power `exponent`, which adds up over intervals; max |f| if that is inf.

        Raises:
            ArgumentError: as for the norm.
        """
        t, f = checked_samples(t, f)
        scale = float(np.abs(f).max())
        if scale == 0.0 or math.isinf(scale):
            return scale
        with np.errstate(over="ignore", under="ignore"):
            return float(np.float64(scale) ** self._degree * self._total(t, f / scale))

    def shares(self, t: ArrayLike, f: ArrayLike) -> FloatArray:
        """Contribution of each interval to `power`, shape (n - 1,).

        If f holds infinities, the intervals that touch one have inf and all others 0.

        Raises:
            ArgumentError: as for the norm.
        """
        t, f = checked_samples(t, f)
        infinite = np.isinf(f)
        if infinite.any():
            return np.where(infinite[:-1] | infinite[1:], np.inf, 0.0)
        scale = np.abs(f).max()
        if scale == 0.0:
            return np.zeros(len(f) - 1)
        with np.errstate(over="ignore", under="ignore"):
            return scale**self._degree * self._interval_powers(t, f / scale)

    def grid_sensitivity(self, t: ArrayLike, f: ArrayLike) -> float:
        """Relative change of the norm when every second sample is dropped.

            |norm(t[::2], f[::2]) - norm(t, f)| / norm(t, f)

        A norm that converges with the square of the step has an error of about a third of this
        left. A value that does not shrink as samples are added says that the norm does not exist
        for this f (H^2 of an f with kinks). The last sample is left out of both if n is even.

        Raises:
            ArgumentError: fewer than 3 samples, an infinite f, or as for the norm.
        """
        t, f = checked_samples(t, f)
        if len(t) < 3:
            raise ArgumentError("len(t)", len(t), "at least 3, to drop every second sample")
        if np.isinf(f).any():
            raise ArgumentError("f", math.inf, "finite, an infinite norm has no sensitivity")
        odd = len(t) - (len(t) + 1) % 2
        full, half = self(t[:odd], f[:odd]), self(t[:odd:2], f[:odd:2])
        return abs(half - full) / full if full > 0 else 0.0

    @property
    def _degree(self) -> float:
        """Degree of homogeneity of `power`."""
        return 1.0 if math.isinf(self.exponent) else self.exponent


def checked_samples(t: ArrayLike, f: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Samples as float64 arrays that a norm can take; infinities in f pass.

    Raises:
        ArgumentError: shapes differ, times do not increase, or f holds NaN.
    """
    t, f = increasing_times("t", t), as_floats("f", f)
    if f.shape != t.shape:
        raise ArgumentError("f.shape", f.shape, f"{t.shape}, as t")
    if np.isnan(f).any():
        i = int(np.flatnonzero(np.isnan(f))[0])
        raise ArgumentError(f"f[{i}]", math.nan, "a number (inf marks a collision)")
    return t, f
