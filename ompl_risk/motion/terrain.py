"""Motions over terrain: every answer is one call of compiled code."""

from __future__ import annotations

import numpy as np

from ompl_risk._kernels import motion, nearest
from ompl_risk.clearance import TerrainClearance
from ompl_risk.motion.base import MotionModel, Risk


class TerrainMotion(MotionModel):
    """``MotionModel`` over a ``TerrainClearance``, with ``InverseDistance``.

    Args:
        clearance: the terrain and the vehicle's radius.
        risk: how risk is counted; any for a model that is only asked about collisions.
        width: length of the state buffers.
    """

    def __init__(self, clearance: TerrainClearance, risk: Risk, width: int = 3) -> None:
        self.a, self.b = np.zeros(width), np.zeros(width)
        self._clearance = clearance  # keeps the arrays behind the handle alive
        self._given = np.array(
            [
                clearance.radius,
                risk.speed,
                risk.avoidance.d0,
                risk.exponent,
                risk.time_scale,
                risk.tolerance,
                risk.weight,
            ]
        )
        self._work = (*nearest.workspace(), np.empty((motion.DEPTH, 2)))
        buffers = (*self._work, self.a, self.b, self._given)
        self._handle = np.concatenate(
            [clearance.handle, np.array([x.ctypes.data for x in buffers], dtype=np.int64)]
        )

    def clearance(self) -> float:
        """Clearance d [m] at a."""
        return motion.clearance(self._handle)

    def is_free(self) -> bool:
        """Whether a is free, d > 0."""
        return motion.is_free(self._handle)

    def is_motion_free(self) -> bool:
        """Whether every state from a to b is free."""
        return motion.is_motion_free(self._handle)

    def cost(self) -> float:
        """Cost of the motion from a to b."""
        return motion.motion_cost(self._handle)

    def heuristic(self) -> float:
        """Lower bound for the cost of any way from a to b."""
        return motion.heuristic(self._handle)
