"""How to mix duration and risk so that trees of shortest paths find safe paths too."""

from __future__ import annotations

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.roadmap.corridor import Corridor

RUNGS = 2.0 ** np.arange(-6.0, 3.0, 2.0)
"""Mixes that are tried, in units of the one beyond which the best path is too slow."""

QUANTILES = np.linspace(0.0, 1.0, 6)
"""The same for a maximum norm: of the edges' risks between the least possible and the fastest's."""

ROUNDS = 30
"""At most so many secants; 3 to 8 are usual."""

AT_LEAST = 1e-6
"""Least mix that breaks ties of duration, in durations per risk of the fastest path."""


def ladder(corridor: Corridor) -> FloatArray:
    """Mixes from duration alone to as much care for risk as the limit of duration allows.

    For a sum of risks: 0, and powers of 4 about the greatest mix m [s per unit of risk] for which
    the path of least ``duration + m risk`` is within the limit. That m is the Lagrange
    multiplier of "least risk within the limit", found by secants of the lower hull of all
    (duration, risk), a tree for each.

    For a maximum norm: thresholds on the risk of the edges, from inf down to the least that leaves
    a path within the limit, found by bisection.

    Reference:
        Handler & Zang, A dual algorithm for the constrained shortest path problem,
        Networks 10, 1980.
    """
    if corridor.graph.maximum:
        return _thresholds(corridor)
    multiplier = _multiplier(corridor)
    return np.append(0.0, multiplier * RUNGS) if multiplier > 0.0 else np.zeros(1)


def _multiplier(corridor: Corridor) -> float:
    """The mix beyond which the best path is too slow; 0 if the fastest is also the safest."""
    fast = corridor.best(0.0)
    if fast is None or fast.risk == 0.0:
        return 0.0
    safe = corridor.best(corridor.least / fast.risk / AT_LEAST)
    if safe is None or not safe.risk < fast.risk:
        return 0.0
    least = AT_LEAST * corridor.least / fast.risk
    for _ in range(ROUNDS):
        mix = (safe.duration - fast.duration) / (fast.risk - safe.risk)
        way = corridor.best(mix)
        on_the_line = fast.duration + mix * fast.risk
        if way is None or way.duration + mix * way.risk >= on_the_line * (1.0 - 1e-9):
            return max(mix, least)
        if way.duration <= corridor.limit:
            fast = way
        else:
            safe = way
    return max((safe.duration - fast.duration) / (fast.risk - safe.risk), least)


def _thresholds(corridor: Corridor) -> FloatArray:
    """Risks that no edge may exceed, from inf down to the least with a path within the limit."""
    fast = corridor.best(np.inf)
    risks = np.unique(corridor.graph.risk[np.isfinite(corridor.duration)])
    if fast is None or not len(risks):
        return np.array([np.inf])
    top = int(np.searchsorted(risks, fast.risk))
    low, high = 0, top
    while low < high:
        middle = (low + high) // 2
        way = corridor.best(float(risks[middle]))
        if way is not None and way.duration <= corridor.limit:
            high = middle
        else:
            low = middle + 1
    rungs = np.unique((high + QUANTILES * (top - high)).round().astype(np.int64))
    return np.append(np.inf, risks[rungs[::-1]])
