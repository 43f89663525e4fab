"""Weights of edges in whole numbers, so that sums do not depend on their order."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray

Ticks = NDArray[np.int64]

BITS = 60
"""The greatest total that counts has at most 2^60 ticks."""

SLACK = 1e-12
"""How far a limit is raised: it may itself be the sum over a path, rounded otherwise."""

FINEST_POWER = 1e-14
"""Powers of 1 plus less than this could not be told apart."""


def in_ticks(weight: FloatArray, path: NDArray[np.int32], limit: float) -> tuple[Ticks, int, float]:
    """Weights as whole multiples of a power of two, the tick, which is at most 2^-59 of the total.

    Rounded up, so that what is not 0 does not become 0.

    Args:
        weight: of the edges, inf for those that do not exist, shape (m,).
        path: edges of a path whose total is the greatest that counts.
        limit: another bound on it.

    Returns:
        Weights, at most 2^61, more than any total that counts; the greatest total; the tick.
    """
    shift = BITS - math.frexp(min(float(weight[path].sum()), limit))[1]
    with np.errstate(over="ignore"):
        ticks = np.minimum(np.ceil(np.ldexp(weight, shift)), 2.0 ** (BITS + 1)).astype(np.int64)
        raised = float(np.ldexp(limit * (1.0 + SLACK), shift))
    total = sum(int(t) for t in ticks[path])
    return ticks, int(raised) if raised < total else total, float(np.ldexp(1.0, -shift))


def in_ranks(risk: FloatArray, path: NDArray[np.int32], precision: float) -> tuple[Ticks, int]:
    """Places of the risks among all, equal if the same power of (1 + precision) is next below.

    Args:
        risk: of the edges, inf for those that do not exist, shape (m,).
        path: edges of a path whose greatest risk is the greatest that counts.
        precision: 0 for the places of the risks themselves.

    Returns:
        Places; that of the greatest risk.
    """
    if precision > FINEST_POWER:
        with np.errstate(divide="ignore"):
            risk = np.floor(np.log(risk) / math.log1p(precision))
    ranks = np.unique(risk, return_inverse=True)[1].astype(np.int64)
    return ranks, int(ranks[path].max(initial=0))
