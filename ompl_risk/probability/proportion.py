"""A proportion with its confidence interval."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray


class Proportion(NamedTuple):
    """An estimated probability and how sure it is.

    Attributes:
        p: estimate.
        low, high: ends of the confidence interval.
        samples: number of samples.
        confidence: of the interval.
    """

    p: float
    low: float
    high: float
    samples: int
    confidence: float


def clopper_pearson(
    hits: ArrayLike, samples: int, confidence: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Exact confidence interval of a binomial proportion.

    Args:
        hits: successes, any shape.
        samples: trials.
        confidence: such as 0.95.

    Returns:
        Lower and upper ends.

    Reference: Clopper and Pearson, Biometrika 26 (1934).
    """
    from scipy.special import betaincinv

    k = np.asarray(hits, dtype=np.float64)
    tail = 0.5 * (1.0 - confidence)
    with np.errstate(invalid="ignore"):
        low = np.where(k > 0, betaincinv(np.maximum(k, 1e-300), samples - k + 1.0, tail), 0.0)
        high = np.where(
            k < samples, betaincinv(k + 1.0, np.maximum(samples - k, 1e-300), 1.0 - tail), 1.0
        )
    return low, high
