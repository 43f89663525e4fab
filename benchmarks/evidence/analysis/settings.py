"""Settings: what gives each flight a number from its profile alone, the smaller the safer."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from benchmarks.evidence.analysis.profiles import Profiles
from benchmarks.evidence.analysis.table import FLIGHTS
from ompl_risk import InverseDistance, Lp, Norm, Sobolev
from ompl_risk._arrays import FloatArray
from ompl_risk.avoidance import Avoidance, GaussianTail
from ompl_risk.avoidance.corrections import corrected_cap, corrected_tail
from ompl_risk.avoidance.gaussian_tail import upper_tail
from ompl_risk.probability.crossings import CrossingRate
from ompl_risk.probability.outcrossing import Outcrossing, steepened

FAR = 100.0
"""The paper's d0 [m]."""


class Integrand(ABC):
    """A function of the profile at each sample, zero or more.

    Instances are immutable and hashable.
    """

    @property
    @abstractmethod
    def label(self) -> str:
        """Such as "InverseDistance(100 m)"."""

    @property
    @abstractmethod
    def scale(self) -> float:
        """The length that it is tuned by [m]."""

    @abstractmethod
    def __call__(self, profiles: Profiles) -> FloatArray:
        """Values at all samples, shape (N,)."""


@dataclass(frozen=True)
class OfDistance(Integrand):
    """An avoidance function of the clearance alone."""

    avoidance: Avoidance

    @property
    def label(self) -> str:
        """The avoidance function with its parameters, d0 only where it is not a default."""
        name, avoidance = type(self.avoidance).__name__, self.avoidance
        if isinstance(avoidance, GaussianTail) and avoidance != GaussianTail(avoidance.sigma):
            return f"{name}({self.scale:g} m, d0 = {avoidance.d0:g} m)"
        return f"{name}({self.scale:g} m)"

    @property
    def scale(self) -> float:
        """sigma of a Gaussian tail, d0 (or r) of the others [m]."""
        return (
            self.avoidance.sigma if isinstance(self.avoidance, GaussianTail) else self.avoidance.d0
        )

    def __call__(self, profiles: Profiles) -> FloatArray:
        """f(d)."""
        return self.avoidance(profiles.d)


@dataclass(frozen=True)
class CorrectedCap(Integrand):
    """The share of a ball below ground of the slope and curvature underneath."""

    r: float

    @property
    def label(self) -> str:
        """Such as "corrected_cap(60 m)"."""
        return f"corrected_cap({self.r:g} m)"

    @property
    def scale(self) -> float:
        """Radius of the ball [m]."""
        return self.r

    def __call__(self, profiles: Profiles) -> FloatArray:
        """The share at each sample."""
        return corrected_cap(profiles.d, profiles.up, profiles.curvature, r=self.r)


@dataclass(frozen=True)
class CorrectedTail(Integrand):
    """The probability of collision for errors of the map's height and of the position."""

    vertical: float
    isotropic: float

    @property
    def label(self) -> str:
        """Such as "corrected_tail(8 m, 4 m)"."""
        return f"corrected_tail({self.vertical:g} m, {self.isotropic:g} m)"

    @property
    def scale(self) -> float:
        """Standard deviation of the distance's error over level ground [m]."""
        return math.hypot(self.vertical, self.isotropic)

    def __call__(self, profiles: Profiles) -> FloatArray:
        """The probability at each sample."""
        return corrected_tail(
            profiles.d, profiles.up, profiles.curvature,
            vertical=self.vertical, isotropic=self.isotropic,
        )  # fmt: skip


class Setting(ABC):
    """Gives each flight a number; instances are immutable and hashable."""

    @property
    @abstractmethod
    def label(self) -> str:
        """Name with parameters; no two settings share one."""

    @abstractmethod
    def __call__(self, profiles: Profiles) -> FloatArray:
        """A number of each flight, zero or more, shape (F,)."""


@dataclass(frozen=True)
class NormOf(Setting):
    """A norm of an integrand: what `rank` orders by."""

    norm: Norm
    integrand: Integrand

    @property
    def label(self) -> str:
        """Such as "H1 of InverseDistance(100 m)"."""
        return f"{self.norm.label} of {self.integrand.label}"

    def __call__(self, profiles: Profiles) -> FloatArray:
        """The norm of each flight."""
        return profiles.norm(self.norm, self.integrand(profiles))


@dataclass(frozen=True)
class ExpectedCollisions(Setting):
    """The expected number of entries into the ground: risk as a rate, not a norm."""

    rate: CrossingRate

    @property
    def label(self) -> str:
        """Such as "expected collisions(9 m, 5 s)"."""
        return f"expected collisions({self.rate.sigma:g} m, {self.rate.correlation_time:g} s)"

    def __call__(self, profiles: Profiles) -> FloatArray:
        """The number for each flight."""
        initial, entries = self.parts(profiles)
        return initial + entries

    def parts(self, profiles: Profiles) -> tuple[FloatArray, FloatArray]:
        """Probability of collision at the start, and entries thereafter, shape (F,) each."""
        if self not in profiles.known:
            rate = self.rate.along(profiles.clock, profiles.d).rate
            initial = upper_tail(profiles.d[profiles.starts[:-1]] / self.rate.sigma)
            profiles.known[self] = initial, profiles.total(rate * np.diff(profiles.clock))
        return profiles.known[self]


@dataclass(frozen=True)
class OutcrossingOf(Setting):
    """The probability of collision of `Outcrossing`, with the same errors at every level."""

    model: Outcrossing

    @property
    def label(self) -> str:
        """Such as "outcrossing(10 m, 6 m, 8 s)"."""
        model = self.model
        return (
            f"outcrossing({model.passing:g} m, {model.lasting:g} m, {model.correlation_time:g} s)"
        )

    def __call__(self, profiles: Profiles) -> FloatArray:
        """The probability of each flight; as `Outcrossing.probability`, for all flights at once."""
        model, clock, starts = self.model, profiles.clock, profiles.starts
        margin = profiles.d / steepened(profiles.up)
        least = [int(s + margin[s:e].argmin()) for s, e in pairwise(starts)]
        forward = np.arange(len(clock) - 1) >= np.repeat(least, profiles.lengths)[:-1]
        rate = CrossingRate(model.passing, correlation_time=model.correlation_time)
        found = np.zeros(len(profiles))
        for b, weight in zip(*model.lasting_errors(), strict=True):
            ahead = rate.along(clock, margin - b).rate
            back = rate.along(-clock[::-1], (margin - b)[::-1]).rate[::-1]
            entries = profiles.total(np.where(forward, ahead, back) * np.diff(clock))
            here = upper_tail((margin[least] - b) / model.passing)
            found += weight * (here * np.exp(-entries) - np.expm1(-entries))
        return np.minimum(found, 1.0)


@dataclass(frozen=True)
class Product(Setting):
    """The weighted geometric mean of two settings: a^(1 - w) b^w."""

    first: Setting
    second: Setting
    weight: float

    @property
    def label(self) -> str:
        """Such as "(A)^0.5 × (B)^0.5"."""
        return f"({self.first.label})^{1 - self.weight:g} × ({self.second.label})^{self.weight:g}"

    def __call__(self, profiles: Profiles) -> FloatArray:
        """The mean of each flight."""
        return mixed(self.first(profiles), self.second(profiles), self.weight)


def mixed(first: FloatArray, second: FloatArray, weight: float) -> FloatArray:
    """The weighted geometric mean of numbers that are zero or more."""
    return first ** (1.0 - weight) * second**weight


@dataclass(frozen=True)
class Duration(Setting):
    """The fastest flight first: what is picked by somebody who sees no risk."""

    @property
    def label(self) -> str:
        """It has no parameters."""
        return "duration"

    def __call__(self, profiles: Profiles) -> FloatArray:
        """Duration of each flight [s]."""
        return profiles.durations


FASTEST = Duration()
PAPER = tuple(
    NormOf(norm, OfDistance(InverseDistance(FAR)))
    for norm in (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))
)
"""The paper's four norms."""


def evaluated(settings: Sequence[Setting], profiles: Profiles) -> FloatArray:
    """The numbers of all flights, unit by unit.

    Settings that share an integrand should stand together: it is computed once for all of them.

    Returns:
        Shape (S, U, 5).
    """
    values = np.empty((len(settings), len(profiles)))
    integrand, f = None, np.empty(0)
    for row, setting in zip(values, settings, strict=True):
        if not isinstance(setting, NormOf):
            row[:] = setting(profiles)
            continue
        if setting.integrand != integrand:
            integrand, f = setting.integrand, setting.integrand(profiles)
        row[:] = profiles.norm(setting.norm, f)
    return values.reshape(len(settings), -1, FLIGHTS)
