"""How well the order of one set of numbers predicts that of another, five flights at a time."""

from __future__ import annotations

from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from benchmarks.evidence.analysis.table import FLIGHTS
from ompl_risk._arrays import FloatArray

TIED = 1e-6
"""Numbers that differ by less, relatively, are tied: flights that share a stretch have the same
numbers there, but for rounding."""
_FIRST, _SECOND = np.array(list(combinations(range(FLIGHTS), 2))).T


class Scores(NamedTuple):
    """Scores of settings in sets, all of one shape.

    Attributes:
        safest: whether the flight of least value is (one of) the least probable to collide; where
            the setting ties several, the share of them that are.
        riskiest: the same for the greatest.
        tau: Kendall's tau-b; 0 where the setting or the judge ties all flights, 1 if both do.
        regret: probability of collision of the flight picked (the mean over those tied) less that
            of the safest, in the judge's unit.
    """

    safest: FloatArray
    riskiest: FloatArray
    tau: FloatArray
    regret: FloatArray


def scores(values: FloatArray, truth: FloatArray) -> Scores:
    """Judge settings.

    Args:
        values: what settings give the flights, shape (..., 5).
        truth: what the judge says, of a shape that broadcasts against it.
    """
    guess, true = ranks(values), ranks(truth)
    pick, least = guess == 0, true == 0
    top, greatest = _greatest(guess), _greatest(true)
    excess = truth - truth.min(axis=-1, keepdims=True)
    return Scores(
        _share(pick, least), _share(top, greatest), kendall_tau(guess, true), _share(pick, excess)
    )


def ranks(values: ArrayLike) -> NDArray[np.int8]:
    """Dense ranks along the last axis, from 0; numbers tied to rounding share theirs."""
    values = np.asarray(values, dtype=np.float64)
    order = np.argsort(values, axis=-1, kind="stable")
    ascending = np.take_along_axis(values, order, axis=-1)
    low, high = ascending[..., :-1], ascending[..., 1:]
    with np.errstate(invalid="ignore"):  # inf - inf: those are equal
        apart = (high - low > TIED * np.abs(high)) | np.isinf(high)
    steps = (high != low) & apart
    dense = np.zeros(values.shape, dtype=np.int8)
    np.cumsum(steps, axis=-1, out=dense[..., 1:])
    found = np.empty_like(dense)
    np.put_along_axis(found, order, dense, axis=-1)
    return found


def kendall_tau(a: NDArray[np.int8], b: NDArray[np.int8]) -> FloatArray:
    """Kendall's tau-b of ranks along the last axis, with the convention for ties in `Scores`."""
    signs_a, signs_b = (np.sign(r[..., _FIRST] - r[..., _SECOND]) for r in (a, b))
    untied_a, untied_b = (np.abs(s).sum(axis=-1, dtype=np.int64) for s in (signs_a, signs_b))
    concordance = (signs_a * signs_b).sum(axis=-1, dtype=np.float64)
    product = untied_a * untied_b
    tau = concordance / np.sqrt(np.maximum(product, 1))
    return np.where(product > 0, tau, (untied_a == 0) & (untied_b == 0))


def _greatest(ranked: NDArray[np.int8]) -> NDArray[np.bool_]:
    return ranked == ranked.max(axis=-1, keepdims=True)


def _share(chosen: NDArray[np.bool_], worth: NDArray[Any]) -> FloatArray:
    """The mean worth of those chosen along the last axis."""
    return (chosen * worth).sum(axis=-1) / chosen.sum(axis=-1)
