"""Pieces of motions that are halved until they are short enough, many at a time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray


class Pieces(NamedTuple):
    """Pieces of motions.

    Attributes:
        k: which motion they belong to.
        s0, s1: their ends: fractions of the motion, or times [s].
        d0, d1: distances to obstacles there [m].
    """

    k: NDArray[np.intp]
    s0: FloatArray
    s1: FloatArray
    d0: FloatArray
    d1: FloatArray

    @property
    def middle(self) -> FloatArray:
        """Midway between the ends."""
        return 0.5 * (self.s0 + self.s1)

    def chosen(self, keep: NDArray[np.bool_] | slice) -> Pieces:
        """Some of them."""
        k, s0, s1, d0, d1 = self
        return Pieces(k[keep], s0[keep], s1[keep], d0[keep], d1[keep])

    def halved(self, d: FloatArray) -> Pieces:
        """Both halves of all; ``d`` holds the distances in the middles."""
        s, both = self.middle, np.concatenate
        return Pieces(
            both((self.k, self.k)),
            both((self.s0, s)),
            both((s, self.s1)),
            both((self.d0, d)),
            both((d, self.d1)),
        )
