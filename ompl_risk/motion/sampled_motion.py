"""One motion at a time for any clearance."""

from __future__ import annotations

from typing import Any

import numpy as np

from ompl_risk.motion.base import MotionModel, Risk
from ompl_risk.motion.sampled import SampledBatch


class SampledMotion(MotionModel):
    """``MotionModel`` over anything that maps points to distances: a ``SampledBatch`` of one.

    Args:
        clearance: callable with points (n, 3) [m], or poses (n, 7) if it ``uses_orientation``.
        risk: how risk is counted.
        width: length of the state buffers.

    Raises:
        ArgumentError: see ``SampledBatch``.
    """

    def __init__(self, clearance: Any, risk: Risk, width: int = 3) -> None:
        self._batch, self._risk = SampledBatch(clearance, risk, width), risk
        self.a, self.b = np.zeros(width), np.zeros(width)

    def clearance(self) -> float:
        """Clearance d [m] at a."""
        return float(self._batch.clearances(self.a[None])[0])

    def is_free(self) -> bool:
        """Whether a is free, d > 0."""
        return self.clearance() > 0.0

    def is_motion_free(self) -> bool:
        """Whether every state from a to b is free."""
        return bool(self._batch.are_free(self.a[None], self.b[None])[0])

    def cost(self) -> float:
        """Cost of the motion from a to b."""
        return float(self._batch.costs(self.a[None], self.b[None])[0])

    def heuristic(self) -> float:
        """Lower bound for the cost of any way from a to b."""
        d = self._batch.clearances(np.array([self.a, self.b]))
        return float(self._batch.heuristics(self.a[None], self.b[None], d[:1], d[1:])[0])
