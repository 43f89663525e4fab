"""Collision and risk of the straight motions that planners are made of."""

from __future__ import annotations

from typing import Any

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
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
    """
    if isinstance(clearance, TerrainClearance) and isinstance(risk.avoidance, InverseDistance):
        return TerrainMotion(clearance, risk, width)
    return SampledMotion(clearance, risk, width)
