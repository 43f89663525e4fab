"""Collision and risk of the straight motions that planners are made of."""

from __future__ import annotations

from typing import Any

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.base import MotionModel as MotionModel
from ompl_risk.motion.base import Risk as Risk
from ompl_risk.motion.sampled import SampledMotion as SampledMotion
from ompl_risk.motion.terrain import TerrainMotion as TerrainMotion


def motion_model(clearance: Any, risk: Risk, width: int = 3) -> MotionModel:
    """The quickest model that can answer for a clearance.

    Args:
        clearance: callable with points (n, 3) [m].
        risk: how risk is counted.
        width: length of the state buffers.

    Raises:
        ArgumentError: a clearance that cannot be called, or one that needs an orientation which
            states of this width do not have.
    """
    if not callable(clearance):
        raise ArgumentError(
            "clearance", clearance, "callable with points (n, 3), as TerrainClearance"
        )
    # Subclasses that change what is computed must not be bypassed by compiled code.
    if (
        isinstance(clearance, TerrainClearance)
        and type(clearance).__call__ is TerrainClearance.__call__
        and type(risk.avoidance) is InverseDistance
    ):
        return TerrainMotion(clearance, risk, width)
    return SampledMotion(clearance, risk, width)
