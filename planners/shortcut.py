"""Take needless corners out of a planner's path, without raising its cost."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ompl_risk._arrays import FloatArray

MotionCost = Callable[[FloatArray, FloatArray], float]
"""Cost of the straight motion between two positions (3,) [m]; inf if it may not be flown."""

ROUNDS = 4


def shortcut(positions: FloatArray, cost: MotionCost, *, rounds: int = ROUNDS) -> FloatArray:
    """Drop corners as long as that does not raise the cost.

    Each round first halves every piece, so that corners are cut as well as dropped, and then
    replaces a - b - c by a - c wherever that costs no more. Deterministic; the costs of motions
    must add up along the path.

    Args:
        positions: corners of a path [m], shape (n, 3), all of its motions of finite cost.
        cost: cost of a motion.
        rounds: how often the pieces are halved; 0 only drops corners.

    Returns:
        Corners of the new path, shape (m, 3), from the same start to the same goal.
    """
    corners = _drop(list(positions), cost)
    for _ in range(rounds):
        halved = [corners[0]]
        for a, b in pairwise(corners):
            halved += [(a + b) / 2, b]
        corners = _drop(halved, cost)
    return np.array(corners)


def _drop(corners: list[FloatArray], cost: MotionCost) -> list[FloatArray]:
    costs = [cost(a, b) for a, b in pairwise(corners)]
    i = 1
    while i < len(corners) - 1:
        direct = cost(corners[i - 1], corners[i + 1])
        if direct <= costs[i - 1] + costs[i]:
            del corners[i]
            costs[i - 1 : i + 1] = [direct]
            i = max(i - 1, 1)  # the corner before may be needless now
        else:
            i += 1
    return corners
