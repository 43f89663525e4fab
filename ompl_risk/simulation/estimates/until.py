"""When to stop flying rollouts, with bounds that hold whenever one stops.

A sample that is looked at again and again, and left as soon as it shows what one wants, is wrong
more often than its bounds say. Here the looks are planned beforehand and the error that is allowed
is shared out evenly among them: by Bonferroni's inequality no bound at any of the looks is wrong
more often than it says (Dunn, Multiple comparisons among means, 1961).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from ompl_risk._arrays import positive, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.estimates.estimate import CollisionEstimate

GROWTH = 2
"""Each look has so many times the rollouts of the one before it."""


class Until(ABC):
    """Decides after how many rollouts to look, and whether to stop there."""

    @abstractmethod
    def looks(self, confidence: float) -> tuple[int, ...]:
        """Increasing numbers of rollouts at which to look; the last one ends it."""

    @abstractmethod
    def done(self, estimate: CollisionEstimate) -> bool:
        """Whether these rollouts are enough."""


@dataclass(frozen=True)
class Count(Until):
    """So many rollouts, and one look at them.

    Args:
        rollouts: the number.

    Raises:
        ArgumentError: not a whole number from 1.
    """

    rollouts: int

    def __post_init__(self) -> None:
        whole("rollouts", self.rollouts)

    def looks(self, confidence: float) -> tuple[int, ...]:  # noqa: ARG002
        """The one number."""
        return (self.rollouts,)

    def done(self, estimate: CollisionEstimate) -> bool:  # noqa: ARG002
        """Yes."""
        return True


@dataclass(frozen=True)
class Narrow(Until):
    """Until the interval is narrow enough, by doubling.

    Args:
        width: ``high - low`` to reach, as a probability.
        first: rollouts at the first look.
        most: rollouts at which to stop whatever the width.

    Raises:
        ArgumentError: a width that is not positive, or ``most`` below ``first``.
    """

    width: float
    first: int = 256
    most: int = 65_536

    def __post_init__(self) -> None:
        positive("width", self.width)
        whole("first", self.first)
        whole("most", self.most, least=self.first)

    def looks(self, confidence: float) -> tuple[int, ...]:  # noqa: ARG002
        """Doubling from ``first`` to ``most``."""
        return _doubling(self.first, self.most)

    def done(self, estimate: CollisionEstimate) -> bool:
        """Whether the interval has the width."""
        return estimate.high - estimate.low <= self.width


@dataclass(frozen=True)
class Decided(Until):
    """Until it is sure which side of a threshold the probability is on.

    The looks are placed where something can come of them: at the number of rollouts that decides
    for "below" if none collides, ``n = log(error of a look) / log(1 - threshold)``, twice before
    it, for plans that are far worse than allowed, and then doubling. ``CollisionEstimate.decided``
    says what came of it, which can be "open".

    Args:
        threshold: probability that is still allowed.
        most: rollouts at which to stop; 16 times n if left out.

    Raises:
        ArgumentError: a threshold that is not between 0 and 1, or ``most`` not from 1.
    """

    threshold: float
    most: int | None = None

    def __post_init__(self) -> None:
        value = real_number("threshold", self.threshold, "between 0 and 1")
        if not 0.0 < value < 1.0:
            raise ArgumentError("threshold", self.threshold, "between 0 and 1")
        if self.most is not None:
            whole("most", self.most)

    def looks(self, confidence: float) -> tuple[int, ...]:
        """A sixteenth, a quarter and all of the rollouts that can decide, then doubling."""
        count = 1
        while True:  # more looks need more rollouts each: count goes up to a fixed point
            error = (1.0 - confidence) / count
            n = math.ceil(math.log(error) / math.log1p(-self.threshold))
            most = 16 * n if self.most is None else self.most
            early = [k for k in (n // 16, n // 4) if k >= 16]
            looks = sorted({min(k, most) for k in (*early, *_doubling(n, max(n, most)))})
            if len(looks) <= count:
                return tuple(looks)
            count = len(looks)

    def done(self, estimate: CollisionEstimate) -> bool:
        """Whether it is decided."""
        return estimate.decided(self.threshold) != "open"


def _doubling(first: int, most: int) -> tuple[int, ...]:
    looks = [first]
    while looks[-1] * GROWTH < most:
        looks.append(looks[-1] * GROWTH)
    return (*looks, most) if most > looks[-1] else tuple(looks)


def whole(argument: str, value: object, *, least: int = 1) -> int:
    """A whole number that is not below ``least``.

    Raises:
        ArgumentError: anything else.
    """
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise ArgumentError(argument, value, f"a whole number from {least}")
    return value
