"""How sure a share of rollouts is: exact where they count alike, by weights where they do not."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.probability.proportion import clopper_pearson


def counted(hits: int, rollouts: int, tail: float) -> tuple[float, float]:
    """Exact bounds of a probability, each wrong with probability ``tail`` at most.

    Args:
        hits: collisions.
        rollouts: independent rollouts, at least one.
        tail: such as 0.025 for the two ends of an interval of 95 %.

    Returns:
        Lower and upper bound.

    Reference: Clopper and Pearson, Biometrika 26 (1934).
    """
    low, high = clopper_pearson(hits, rollouts, 1.0 - 2.0 * tail)
    return float(low), float(high)


def weighed(
    weights: FloatArray, rollouts: int, tail: float, heaviest: float
) -> tuple[float, float]:
    """Bounds of a probability from the weights of the hits: the gamma method of Fay and Feuer.

    Hits of weight w are (nearly, and on the safe side) Poisson distributed, so that their weighted
    mean and its variance are

    ::

        p = sum of w / n        v = sum of w^2 / n^2

    The gamma distribution of mean p and variance v bounds it from below, and that of mean p + u
    and variance v + u^2 from above, where u = heaviest / n is one hit more, of the greatest weight
    that it can have. Without differences in weight these are the exact bounds of a Poisson count;
    with no hit at all, u times those of a count of 0.

    Args:
        weights: of the hits, shape (hits,).
        rollouts: n, all of them.
        tail: probability that a bound is wrong, on its side.
        heaviest: greatest weight of a hit that has not been met.

    Returns:
        Lower and upper bound.

    Reference: Fay and Feuer, Confidence intervals for directly standardized rates: a method based
    on the gamma distribution, Statistics in Medicine 16 (1997).
    """
    n = float(rollouts)
    p, v = float(weights.sum()) / n, float((weights**2).sum()) / n**2
    low = _gamma_quantile(p, v, tail) if p > 0.0 and v > 0.0 else 0.0
    one = max(heaviest, float(weights.max(initial=0.0))) / n
    high = _gamma_quantile(p + one, v + one**2, 1.0 - tail) if one > 0.0 else 0.0
    return low, min(high, 1.0)


def _gamma_quantile(mean: float, variance: float, p: float) -> float:
    from scipy.special import gammaincinv

    return float(gammaincinv(mean**2 / variance, p)) * variance / mean


def paired_counts(more: int, less: int, rollouts: int, tail: float) -> tuple[float, float]:
    """Bounds of a difference of two probabilities that the same rollouts estimate.

    The score interval: all differences delta that the data do not refute by

    ::

        |more - less - n delta| <= z sqrt(n (2 q + delta (1 - delta)))

    with q the likeliest share of rollouts where only the second collides, given delta.

    Args:
        more: rollouts where the first collides and the second does not.
        less: the other way round.
        rollouts: n, all of them.
        tail: probability that a bound is wrong, on its side.

    Returns:
        Lower and upper bound of the first's probability minus the second's.

    Reference: Tango, Equivalence test and confidence interval for the difference in proportions
    for the paired-sample design, Statistics in Medicine 17 (1998).
    """
    from scipy.optimize import brentq
    from scipy.special import ndtri

    z, middle = float(-ndtri(tail)), (more - less) / rollouts

    def lower(delta: float) -> float:
        return _score(delta, more, less, rollouts) - z

    def upper(delta: float) -> float:
        return _score(delta, more, less, rollouts) + z

    low: Any = -1.0 if middle <= -1.0 else brentq(lower, -1.0, middle, xtol=1e-15)
    high: Any = 1.0 if middle >= 1.0 else brentq(upper, middle, 1.0, xtol=1e-15)
    return float(low), float(high)


def _score(delta: float, more: int, less: int, n: int) -> float:
    """How many standard deviations the counts are away from a difference delta."""
    excess = more - less - n * delta
    a, b = 2.0 * n, -more - less + (2.0 * n - more + less) * delta
    q = (math.sqrt(max(b * b + 4.0 * a * less * delta * (1.0 - delta), 0.0)) - b) / (2.0 * a)
    variance = n * (2.0 * q + delta * (1.0 - delta))
    if variance <= 0.0:
        return 0.0 if excess == 0.0 else math.copysign(math.inf, excess)
    return excess / math.sqrt(variance)


def paired_weights(
    more: FloatArray, less: FloatArray, rollouts: int, tail: float, heaviest: float
) -> tuple[float, float]:
    """Bounds of a difference of two probabilities from the weights of the hits that differ.

    Each of the two shares has its bounds by ``weighed``; they combine as independent errors do,
    each side by itself. The two exclude each other, so what is neglected is a covariance of minus
    their product, and the Poisson variances that are used are greater by no less.

    Args:
        more: weights of rollouts where the first collides and the second does not.
        less: of those the other way round.
        rollouts: all of them.
        tail: probability that a bound is wrong, on its side.
        heaviest: greatest weight of a hit that has not been met.

    Returns:
        Lower and upper bound of the first's probability minus the second's.

    Reference: Zou and Donner, Construction of confidence limits about effect measures: a general
    approach, Statistics in Medicine 27 (2008).
    """
    p, q = float(more.sum()) / rollouts, float(less.sum()) / rollouts
    (p_low, p_high), (q_low, q_high) = (
        weighed(part, rollouts, tail, heaviest) for part in (more, less)
    )
    low = p - q - math.hypot(p - p_low, q_high - q)
    high = p - q + math.hypot(p_high - p, q - q_low)
    return float(np.clip(low, -1.0, 1.0)), float(np.clip(high, -1.0, 1.0))
