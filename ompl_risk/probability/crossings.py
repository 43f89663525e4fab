"""Expected number of collisions along a trajectory: risk as a rate in time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import (
    FloatArray,
    ReadOnlyArrays,
    as_floats,
    increasing_times,
    positive,
    readonly,
)
from ompl_risk.avoidance.gaussian_tail import upper_tail
from ompl_risk.errors import ArgumentError

_SHORT = 1e-2
"""Changes of d / sigma on an interval below which its integral is a series."""


@dataclass(frozen=True, eq=False)
class Crossings(ReadOnlyArrays):
    """Expected entries into obstacles along a trajectory.

    Attributes:
        t: times of the samples [s], shape (n,).
        initial: probability of being in collision at the first sample.
        rate: mean rate of entries on each interval [1/s], shape (n - 1,).
    """

    t: FloatArray
    initial: float
    rate: FloatArray

    @property
    def expected(self) -> float:
        """Expected number of collisions: `initial`, and all entries thereafter."""
        return float(self.cumulative[-1])

    @property
    def cumulative(self) -> FloatArray:
        """Expected number of collisions up to each sample, shape (n,)."""
        entries = np.cumsum(self.rate * np.diff(self.t))
        return self.initial + np.concatenate([[0.0], entries])

    @property
    def bound(self) -> float:
        """The probability of any collision is at most this (Markov's inequality)."""
        return min(1.0, self.expected)

    @property
    def independent(self) -> float:
        """The probability of any collision if entries were a Poisson process: no bound.

        1 - (1 - initial) exp(-(expected - initial))
        """
        entries = self.expected - self.initial
        return -math.expm1(-entries) + self.initial * math.exp(-entries)


@dataclass(frozen=True, init=False)
class CrossingRate:
    """How often an erring vehicle enters obstacles: Rice's formula for a moving barrier.

    The true distance is ``d(t) + e(t)``, where d is as planned and e a stationary Gaussian process
    of mean 0 and standard deviation sigma whose derivative, of standard deviation sigma', exists.
    At any time e and e' are independent, so entries, downward crossings of 0, have the rate ::

        nu = phi(d / sigma) / sigma  E[max(-(d' + e'), 0)]
           = (sigma' / sigma) phi(d / sigma) (phi(eta) - eta Q(eta)),     eta = d' / sigma'

    For the correlation ``exp(-s^2 / (2 tau^2))``, ``sigma' = sigma / tau``. A field of errors with
    a correlation length, flown over at a speed, has ``tau = length / speed``.

    A trajectory that begins outside obstacles and is ever inside has entered them. So ::

        P(collision) <= E[number of collisions] = Q(d(0) / sigma) + integral of nu dt

    Unlike a norm of a probability, that counts how quickly errors change: the same distance is kept
    more dangerously for many correlation times than for one.

    Args:
        sigma: standard deviation of the distance's error [m].
        correlation_time: tau [s], positive and finite.
        correlation_length: of the errors along the way [m]; with `speed` in place of the time.
        speed: [m/s].

    Raises:
        ArgumentError: a number that is not positive and finite; neither or both of time and length.

    Reference:
        Rice, Mathematical Analysis of Random Noise, 1944-45, section 3.3. Cramer and Leadbetter,
        Stationary and Related Stochastic Processes, 1967, chapter 13, for barriers that move.

    Example:
        >>> rate = CrossingRate(10.0, correlation_time=5.0)
        >>> round(rate.along([0.0, 60.0], [30.0, 30.0]).expected, 4)
        0.0226
    """

    sigma: float
    correlation_time: float

    def __init__(
        self,
        sigma: float,
        *,
        correlation_time: float | None = None,
        correlation_length: float | None = None,
        speed: float | None = None,
    ) -> None:
        object.__setattr__(self, "sigma", positive("sigma", sigma))
        tau = _correlation_time(correlation_time, correlation_length, speed)
        object.__setattr__(self, "correlation_time", tau)

    @property
    def rate_deviation(self) -> float:
        """sigma', standard deviation of the error's rate of change [m/s]."""
        return self.sigma / self.correlation_time

    def rate_at(self, d: ArrayLike, slope: ArrayLike) -> FloatArray:
        """nu [1/s] at distances d [m] that change at a rate d' [m/s], arrays of one shape."""
        x = as_floats("d", d) / self.sigma
        return np.asarray(_density(x) * self._haste(as_floats("slope", slope)))

    def rate(self, t: ArrayLike, d: ArrayLike) -> FloatArray:
        """Mean rate of entries on each interval [1/s], shape (n - 1,): see `along`."""
        return self.along(t, d).rate

    def expected_collisions(self, t: ArrayLike, d: ArrayLike) -> float:
        """Expected number of collisions: see `along`."""
        return self.along(t, d).expected

    def along(self, t: ArrayLike, d: ArrayLike) -> Crossings:
        """Expected entries along a trajectory, exact for d linear between the samples.

        On an interval d' is constant, and phi(d / sigma) has an integral in closed form.

        Args:
            t: times [s], shape (n,), n >= 2, strictly increasing.
            d: distances [m], shape (n,), finite.

        Raises:
            ArgumentError: other shapes, times that do not increase, or a number not finite.
        """
        t, d = increasing_times("t", t), readonly("d", d, (None,), "(n,), as t")
        if d.shape != t.shape:
            raise ArgumentError("d.shape", d.shape, f"{t.shape}, as t")
        x = d / self.sigma
        rate = _mean_density(x[:-1], x[1:]) * self._haste(np.diff(d) / np.diff(t))
        rate.setflags(write=False)
        return Crossings(t, float(upper_tail(x[0])), rate)

    def _haste(self, slope: FloatArray) -> FloatArray:
        """E[max(-(d' + e'), 0)] / sigma [1/s]."""
        eta = slope / self.rate_deviation
        return np.maximum(_density(eta) - eta * upper_tail(eta), 0.0) / self.correlation_time


def _correlation_time(time: float | None, length: float | None, speed: float | None) -> float:
    """tau [s], however it is given."""
    if (time is None) == (length is None):
        name = "(correlation_time, correlation_length)"
        raise ArgumentError(name, (time, length), "one of the two")
    if time is not None:
        if speed is not None:
            raise ArgumentError("speed", speed, "None with a correlation_time")
        return positive("correlation_time", time)
    if length is None or speed is None:
        raise ArgumentError("speed", speed, "a speed [m/s] with a correlation_length")
    return positive("correlation_length", length) / positive("speed", speed)


def _density(x: FloatArray) -> FloatArray:
    """phi(x), the density of a standard normal number."""
    return np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)


def _mean_density(x0: FloatArray, x1: FloatArray) -> FloatArray:
    """Mean of phi between x0 and x1: a difference of tails, or a series where that cancels."""
    h, m = x1 - x0, 0.5 * (x0 + x1)
    square = m * m
    series = 1.0 + (square - 1.0) * h**2 / 24.0
    series += ((square - 6.0) * square + 3.0) * h**4 / 1920.0
    side = np.where(m < 0.0, -1.0, 1.0)  # on the right tails are small, and exact
    short = np.abs(h) < _SHORT
    difference = side * (upper_tail(side * x0) - upper_tail(side * x1))
    return np.where(short, _density(m) * series, difference / np.where(short, 1.0, h))
