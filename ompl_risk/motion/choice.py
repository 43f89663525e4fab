"""The quickest way to answer for a clearance."""

from __future__ import annotations

from typing import Any

from ompl_risk.avoidance.compiled import is_compiled
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.base import MotionModel, Risk
from ompl_risk.motion.batch import MotionBatch
from ompl_risk.motion.moving import refuse_moving
from ompl_risk.motion.sampled import SampledBatch
from ompl_risk.motion.sampled_motion import SampledMotion
from ompl_risk.motion.terrain import TerrainBatch, TerrainMotion


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
    _check(clearance)
    if answers_compiled(clearance, risk):
        return TerrainMotion(clearance, risk, width)
    return SampledMotion(clearance, risk, width)


def motion_batch(
    clearance: Any, risk: Risk, width: int = 3, *, threads: int | None = None
) -> MotionBatch:
    """The same for thousands of motions at a time.

    Args:
        clearance: callable with points (n, 3) [m], or poses (n, 7).
        risk: how risk is counted.
        width: numbers in a state, 3 or 7.
        threads: of compiled code, at most; ``None`` uses all processors.

    Raises:
        ArgumentError: see ``motion_model``.
    """
    _check(clearance)
    if answers_compiled(clearance, risk) and width == 3:
        return TerrainBatch(clearance, risk, threads=threads)
    return SampledBatch(clearance, risk, width)


def _check(clearance: Any) -> None:
    if not callable(clearance):
        raise ArgumentError(
            "clearance", clearance, "callable with points (n, 3), as TerrainClearance"
        )
    refuse_moving(clearance)


def answers_compiled(clearance: Any, risk: Risk) -> bool:
    """Whether compiled code computes what clearance and avoidance function do.

    Subclasses that change what is computed must not be bypassed by it.
    """
    return (
        isinstance(clearance, TerrainClearance)
        and type(clearance).__call__ is TerrainClearance.__call__
        and is_compiled(risk.avoidance)
    )
