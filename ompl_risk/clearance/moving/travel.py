"""How a motion goes against an obstacle, and how near it can come between two distances."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray


class Travel(NamedTuple):
    """Motions as an obstacle sees them that does not turn with its body, n of them.

    Attributes:
        path: their lengths [m], shape (n,).
        chord: how far their ends are apart [m], shape (n,); less than ``path`` if they are bent.
        turning: how far any point of the obstacle moves by its turning [m], shape (n,).
    """

    path: FloatArray
    chord: FloatArray
    turning: FloatArray

    @property
    def whole(self) -> FloatArray:
        """By how much d can change [m]."""
        return self.path + self.turning


def lowest(d0: FloatArray, d1: FloatArray, travel: Travel) -> FloatArray:
    """Lower bounds [m] for d on motions, from the distances at their ends.

    The greater of two. By Lipschitz, with h the whole travel, ::

        (d0 + d1 - h) / 2

    And by empty balls: without turning, no obstacle is in the ball of radius d0 about the one end
    nor in that of radius d1 about the other. If they overlap, no point of the chord c is nearer to
    anything outside both than their ends are and the circle in which their surfaces meet, ::

        rho^2 = d0^2 - x^2,  x = (c^2 + d0^2 - d1^2) / (2 c)

    where x is between 0 and c. That is ``c^2 / (8 d)`` below d on a level way, and not ``c / 2``. A
    bent path is within ``sqrt(path^2 - c^2) / 2`` of its chord; turning makes both balls smaller.
    """
    lipschitz = 0.5 * (d0 + d1 - travel.whole)
    c, r0, r1 = travel.chord, d0 - travel.turning, d1 - travel.turning
    overlap = (r0 > 0.0) & (r1 > 0.0) & (c < r0 + r1) & np.isfinite(r0) & np.isfinite(r1)
    r0, r1 = np.where(overlap, r0, 1.0), np.where(overlap, r1, 1.0)
    x = (c * c + (r0 - r1) * (r0 + r1)) / np.where(c > 0.0, 2.0 * c, 1.0)
    circle = np.sqrt(np.maximum(r0 * r0 - x * x, 0.0))
    balls = np.where((x > 0.0) & (x < c), circle, np.minimum(r0, r1))
    balls -= 0.5 * np.sqrt(np.maximum(travel.path**2 - c * c, 0.0))
    return np.where(overlap, np.maximum(lipschitz, balls), lipschitz)
