"""Take needless corners out of a planner's path, without raising its cost."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ompl_risk._arrays import FloatArray

MotionCost = Callable[[FloatArray, FloatArray], float]
"""Cost of the straight motion between two positions (3,) [m]; inf if it may not be flown."""

ROUNDS = 4
GAIN = 1e-9
"""Least relative gain for which a halfway point is dropped: those on a straight line wait until the
end, since they are what corners get cut at."""


def shortcut(positions: FloatArray, cost: MotionCost, *, rounds: int = ROUNDS) -> FloatArray:
    """Drop corners as long as that does not raise the cost.

    Replaces a - b - c by a - c wherever that costs no more. Each round first halves every piece,
    so that corners are cut as well as dropped. Deterministic; the costs of motions must add up
    along the path.

    Args:
        positions: corners of a path [m], shape (n, 3), all of its motions of finite cost.
        cost: cost of a motion.
        rounds: how often the pieces are halved; 0 only drops corners.

    Returns:
        Corners of the new path, shape (m, 3), from the same start to the same goal.
    """
    corners = _drop(list(positions), cost, 0.0)
    for _ in range(rounds):
        halved = [corners[0]]
        for a, b in pairwise(corners):
            halved += [(a + b) / 2, b]
        corners = _drop(halved, cost, GAIN)
    return np.array(_drop(corners, cost, 0.0))


def _drop(corners: list[FloatArray], cost: MotionCost, gain: float) -> list[FloatArray]:
    """Drop corners one at a time, each for a relative gain of at least `gain`."""
    costs = [cost(a, b) for a, b in pairwise(corners)]
    i = 1
    while i < len(corners) - 1:
        direct = cost(corners[i - 1], corners[i + 1])
        if direct <= (costs[i - 1] + costs[i]) * (1.0 - gain):
            del corners[i]
            costs[i - 1 : i + 1] = [direct]
            i = max(i - 1, 1)  # the corner before may be needless now
        else:
            i += 1
    return corners
