"""What a clearance is made of: ground that an error of the map raises, and the rest."""

from __future__ import annotations

from typing import Any

from ompl_risk.clearance import TerrainClearance, UnionClearance
from ompl_risk.clearance.moving.clearance import MovingClearance


def parts(clearance: Any) -> tuple[Any, ...]:
    """Clearances whose minimum is the one given: the members of unions, what moves by itself."""
    if isinstance(clearance, UnionClearance):
        return tuple(part for member in clearance.members for part in parts(member))
    if isinstance(clearance, MovingClearance) and clearance.static is not None:
        moving = MovingClearance(
            clearance.obstacles, radius=clearance.radius, threads=clearance.threads
        )
        return (*parts(clearance.static), moving)
    return (clearance,)


def grounds(clearance: Any) -> tuple[TerrainClearance, ...]:
    """The terrains among the parts."""
    return tuple(part for part in parts(clearance) if isinstance(part, TerrainClearance))
