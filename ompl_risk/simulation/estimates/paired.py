"""Which of two plans is the more dangerous, when both met the same disturbances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.estimates.estimate import CollisionEstimate
from ompl_risk.simulation.estimates.intervals import paired_counts, paired_weights


@dataclass(frozen=True)
class PairedDifference:
    """How much more often the first of two plans ends in collision than the second.

    ::

        difference = P(first) - P(second)

    Rollout k of both met the same wind and the same errors. Where both collide, or neither does,
    it says nothing of the difference, and what these have in common does not blur it.

    Attributes:
        first, second: names of the plans.
        difference: estimated.
        low, high: ends of its interval: the score interval of Tango, or for weighted rollouts the
            gamma bounds of the two shares together.
        confidence: of the interval.
        more: rollouts where only the first collides.
        less: rollouts where only the second does.
        rollouts: all of them.
        p_value: of McNemar's exact test that neither is the more dangerous, times the looks that
            were planned (Bonferroni); ``None`` for weighted rollouts.
    """

    first: str
    second: str
    difference: float
    low: float
    high: float
    confidence: float
    more: int
    less: int
    rollouts: int
    p_value: float | None

    @property
    def certain(self) -> bool:
        """Whether the interval excludes 0."""
        return not self.low <= 0.0 <= self.high

    def __str__(self) -> str:
        return (
            f"P({self.first}) - P({self.second}) = {self.difference:.3g}, {self.low:.3g} to "
            f"{self.high:.3g} ({100 * self.confidence:.4g} %): of {self.rollouts:,} rollouts "
            f"{self.more:,} hit with {self.first} only, {self.less:,} with {self.second} only"
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain data that strict JSON can hold."""
        return dict(vars(self))


def compare(first: CollisionEstimate, second: CollisionEstimate) -> PairedDifference:
    """The difference of two estimates that met the same disturbances.

    Args:
        first: of one plan.
        second: of the other.

    Raises:
        ArgumentError: the two have not met the same disturbances: another seed, another number of
            rollouts, other weights. That both are of the same ``Disturbances`` is up to the caller.

    Reference: McNemar, Note on the sampling error of the difference between correlated proportions
    or percentages, Psychometrika 12 (1947).
    """
    _check_pairs(first, second)
    only_first = first.collides & ~second.collides
    only_second = second.collides & ~first.collides
    looks = max(first.looks, second.looks)
    n, tail = first.rollouts, 0.5 * (1.0 - first.confidence) / looks
    more, less = int(only_first.sum()), int(only_second.sum())
    if first.weights is None:
        difference, test = (more - less) / n, min(1.0, looks * _mcnemar(more, less))
        low, high = paired_counts(more, less, n, tail)
    else:
        heavy, light = first.weights[only_first], first.weights[only_second]
        difference, test = float(heavy.sum() - light.sum()) / n, None
        either = first.weights[first.collides | second.collides]
        low, high = paired_weights(
            heavy, light, n, tail, float(either.max(initial=0.0)) or first.heaviest
        )
    return PairedDifference(
        first.name, second.name, difference, low, high, first.confidence, more, less, n, test
    )


def _check_pairs(first: CollisionEstimate, second: CollisionEstimate) -> None:
    for field in ("seed", "rollouts", "confidence"):
        one, other = getattr(first, field), getattr(second, field)
        if one != other or one is None:
            raise ArgumentError(f"second.{field}", other, f"that of the first, {one!r}")
    one, other = first.weights, second.weights
    if one is None and other is None:
        return
    if one is None or other is None or not np.array_equal(one, other):
        raise ArgumentError("second.weights", "not the first's", "those of the same draws")


def _mcnemar(more: int, less: int) -> float:
    """Two-sided p-value of as uneven a split of the rollouts that differ, were it a fair coin."""
    from scipy.special import bdtr

    n = more + less
    return float(min(1.0, 2.0 * bdtr(min(more, less), n, 0.5))) if n else 1.0
