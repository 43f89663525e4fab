"""Bootstrap by unit: the sets of a unit are not independent, so units are drawn with all of them.

    mean of a score = sum over units of w_u sum over levels of the score
                      / sum over units of w_u (number of its decided sets),

with w_u how often unit u is drawn. Intervals are percentiles of it over all draws.

Reference: Efron and Tibshirani, An Introduction to the Bootstrap (1993), chapters 8 and 13.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError

RESAMPLES, SEED, CONFIDENCE = 10_000, 0, 0.95


class Interval(NamedTuple):
    """An estimate with its 95 % interval; NaN where there is nothing to average."""

    mean: float
    low: float
    high: float

    @property
    def excludes_zero(self) -> bool:
        """Whether the interval lies on one side of zero."""
        return self.low > 0.0 or self.high < 0.0


@dataclass(frozen=True, eq=False)
class Bootstrap:
    """Draws of units, or of groups of units, with replacement.

    Args:
        weights: how often each unit is drawn, shape (B, U).
    """

    weights: FloatArray

    @classmethod
    def of(cls, groups: ArrayLike, *, resamples: int = RESAMPLES, seed: int = SEED) -> Bootstrap:
        """Draw.

        Args:
            groups: label of each unit's group, shape (U,); groups are drawn whole. All different:
                units are drawn one by one.
            resamples: number of draws.
            seed: of the draws.
        """
        names, member = np.unique(np.asarray(groups), return_inverse=True)
        if len(names) == 0:
            raise ArgumentError("groups", groups, "at least one")
        random = np.random.default_rng(seed)
        drawn = random.multinomial(len(names), np.full(len(names), 1 / len(names)), resamples)
        return cls(drawn[:, member].astype(np.float64))

    def means(self, scores: FloatArray, counted: NDArray[np.bool_]) -> FloatArray:
        """The mean score of each draw; NaN for draws without a set that counts.

        Args:
            scores: shape (..., L, U).
            counted: which sets count, shape (L, U).

        Returns:
            Shape (..., B).
        """
        total = np.where(counted, scores, 0.0).sum(axis=-2) @ self.weights.T
        number = self.weights @ counted.sum(axis=0)
        with np.errstate(invalid="ignore"):
            return total / np.where(number > 0, number, np.nan)

    def intervals(self, scores: FloatArray, counted: NDArray[np.bool_]) -> list[Interval]:
        """The mean score of each setting with its interval.

        Args:
            scores: shape (S, L, U).
            counted: which sets count, shape (L, U).
        """
        return self.summary(mean(scores, counted), self.means(scores, counted))

    @staticmethod
    def summary(estimates: FloatArray, draws: FloatArray) -> list[Interval]:
        """Estimates (S,) with the percentiles of their draws (S, B)."""
        tail = 50.0 * (1.0 - CONFIDENCE)
        kept = draws[:, ~np.isnan(draws).any(axis=0)]
        if kept.shape[1] == 0:
            return [Interval(float(e), np.nan, np.nan) for e in estimates]
        low, high = np.percentile(kept, [tail, 100.0 - tail], axis=1)
        return [Interval(*map(float, three)) for three in zip(estimates, low, high, strict=True)]


def mean(scores: FloatArray, counted: NDArray[np.bool_]) -> FloatArray:
    """The mean score over sets that count; (..., L, U) to (...,), NaN if there is none."""
    number = int(counted.sum())
    total = np.where(counted, scores, 0.0).sum(axis=(-2, -1))
    return total / number if number else np.full(np.shape(total), np.nan)
