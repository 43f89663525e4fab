"""Probability that a flight ever touches the ground, in closed form, from how large errors are."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, increasing_times, positive, readonly, real_number
from ompl_risk.avoidance.gaussian_tail import upper_tail
from ompl_risk.errors import ArgumentError
from ompl_risk.probability.crossings import CrossingRate

STEEPEST = 0.3
"""Least upward component of the ground's normal that is told apart: slopes of 73 degrees."""

WIDEST, OUTERMOST = 0.8, 5.6
"""Step and end of the sum over the lasting error, in its standard deviations: for a Gaussian weight
and a function that is smooth on the scale of the step, it is exact to rounding."""


@dataclass(frozen=True)
class Outcrossing:
    """Probability of collision of a flight whose height has a lasting and a passing error.

    With b the lasting error, normal with standard deviation ``lasting``, and e(t) the passing one,
    a stationary Gaussian process, a flight collides when ``m(t) - b + e(t)`` falls below 0, where
    ``m = d / up`` is how far the ground has to rise to touch it: d the clearance, up the upward
    component of its gradient (the ground as a plane of that slope). Let t* be the time of least m.
    Either the flight is in the ground then, or it gets there later, or, which is the same with time
    reversed, it was there before: entries from t* on, into the future and into the past, are
    taken for a Poisson process with Rice's rate nu (``CrossingRate``), and the mean over b is
    a sum over a fine grid: ::

        P = E_b [ 1 - (1 - Q((m(t*) - b) / sigma)) exp(-integral of nu(m - b, m') d|t - t*|) ]

    What lasts must not be counted again at every stretch of the way, and what passes must: that is
    what sets this apart from a norm. Beginning at t* keeps one sure collision from being counted as
    1 - 1/e. It remains an approximation: entries come in clumps where e changes slowly.

    Args:
        passing: standard deviation of the error that changes on the way [m], positive.
        lasting: standard deviation of the error that stays [m].
        correlation_time: of the passing error [s], as of ``CrossingRate``.

    Raises:
        ArgumentError: a number out of range.

    Reference:
        Schall, Faber and Rackwitz, The ergodicity assumption for sea states in the reliability
        estimation of offshore structures, Journal of Offshore Mechanics and Arctic Engineering 113
        (1991): the mean over what does not change is taken outside the exponential.

    Example:
        >>> model = Outcrossing(10.0, 5.0, correlation_time=8.0)
        >>> round(model.probability([0.0, 60.0], [30.0, 30.0]), 4)
        0.0225
    """

    passing: float
    lasting: float = 0.0
    _: KW_ONLY
    correlation_time: float

    def __post_init__(self) -> None:
        positive("passing", self.passing)
        lasting = real_number("lasting", self.lasting, "0 or more")
        if lasting < 0.0 or math.isinf(lasting):
            raise ArgumentError("lasting", self.lasting, "0 or more")
        positive("correlation_time", self.correlation_time)

    def probability(self, t: ArrayLike, d: ArrayLike, up: ArrayLike | None = None) -> float:
        """P(collision) of a flight.

        Args:
            t: times [s], shape (n,), n >= 2, strictly increasing.
            d: clearances [m], shape (n,), finite.
            up: upward component of the gradient of d, shape (n,); 1 if left out.

        Raises:
            ArgumentError: other shapes, times that do not increase, or a number not finite.
        """
        times, margin = increasing_times("t", t), readonly("d", d, (None,), "(n,), as t")
        if margin.shape != times.shape:
            raise ArgumentError("d.shape", margin.shape, f"{times.shape}, as t")
        if up is not None:
            margin = margin / steepened(readonly("up", up, times.shape, f"{times.shape}, as t"))
        rate = CrossingRate(self.passing, correlation_time=self.correlation_time)
        k = int(margin.argmin())
        after = (times[k:] - times[k], margin[k:])
        before = (times[k] - times[k::-1], margin[k::-1])
        total = 0.0
        for b, weight in zip(*self.lasting_errors(), strict=True):
            entries = sum(_entries(rate, s, m - b) for s, m in (after, before))
            here = float(upper_tail((margin[k] - b) / self.passing))
            total += weight * (here * math.exp(-entries) - math.expm1(-entries))
        return min(float(total), 1.0)

    def lasting_errors(self) -> tuple[FloatArray, FloatArray]:
        """Values of b [m] that stand for all of them, and their weights, shapes (k,)."""
        if self.lasting == 0.0:
            return np.zeros(1), np.ones(1)
        step = WIDEST * min(1.0, self.passing / self.lasting)
        half = math.ceil(OUTERMOST / step)
        x = np.arange(-half, half + 1, dtype=np.float64) * step
        weights = np.exp(-0.5 * x * x)
        return self.lasting * x, weights / weights.sum()


def steepened(up: FloatArray) -> FloatArray:
    """Upward components, those of cliffs and overhangs raised to ``STEEPEST``."""
    return np.maximum(up, STEEPEST)


def _entries(rate: CrossingRate, t: FloatArray, margin: FloatArray) -> float:
    """Expected entries after the first sample."""
    if len(t) < 2:
        return 0.0
    found = rate.along(t, margin)
    return found.expected - found.initial
