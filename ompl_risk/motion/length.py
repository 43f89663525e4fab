"""Motions that cost nothing but their time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.motion.batch import MotionBatch


class LengthBatch(MotionBatch):
    """``MotionBatch`` without obstacles, at 1 m/s: the duration is the length.

    Args:
        width: numbers in a state, 3 or 7.
        reach: what turning by a radian counts in metres; for poses.
    """

    compiled = True

    def __init__(self, width: int = 3, reach: float = 0.0) -> None:
        self.width, self._reach = width, reach

    def clearances(self, states: FloatArray) -> FloatArray:
        """Infinite."""
        return np.full(len(states), np.inf)

    def are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:  # noqa: ARG002
        """True for all."""
        return np.ones(len(a), np.bool_)

    def costs(self, a: FloatArray, b: FloatArray) -> FloatArray:  # noqa: ARG002
        """Zero."""
        return np.zeros(len(a))

    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Lengths [m], turning included."""
        lengths = np.linalg.norm(b[:, :3] - a[:, :3], axis=1)
        if self.width == 7:
            cosine = np.abs(np.einsum("ij,ij->i", a[:, 3:], b[:, 3:]))
            lengths = lengths + 2.0 * self._reach * np.arccos(np.minimum(cosine, 1.0))
        return lengths

    def heuristics(
        self,
        a: FloatArray,
        b: FloatArray,  # noqa: ARG002
        d_a: FloatArray,  # noqa: ARG002
        d_b: FloatArray,  # noqa: ARG002
    ) -> FloatArray:
        """Zero."""
        return np.zeros(len(a))
