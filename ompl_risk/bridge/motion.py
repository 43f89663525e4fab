"""Clearance as an OMPL motion validator that no obstacle slips through."""

from __future__ import annotations

from typing import Any

from ompl import base as ob

from ompl_risk.bridge import faults
from ompl_risk.bridge.timed import state_model


class ClearanceMotionValidator(ob.MotionValidator):
    """A motion is valid if every state of it is, not only states at some resolution.

    Along a motion d changes by at most the distance travelled, so each distance certifies a
    stretch; the check strides over it. OMPL's default validator samples at a fixed resolution and
    jumps over what is thinner. For motions in R^3 and SE(3); not used by control planners. In
    space-time a motion must also go forward in time, at ``vMax`` of the space or less.

    Args:
        si: over R^3, SE(3), or a compound space that starts with one of these; over
            ``ob.SpaceTimeStateSpace`` of R^3 where obstacles move.
        clearance: d(q), 1-Lipschitz in the position; or d(q, t), as a ``MovingClearance``.

    Raises:
        ArgumentError: a state space of another kind, or one without the orientation or the time
            that the clearance needs.

    Attributes:
        obstacles: the clearance.
    """

    def __init__(self, si: ob.SpaceInformation, clearance: Any) -> None:
        super().__init__(si)
        self.obstacles = clearance
        reader, self._model = state_model(si.getStateSpace(), clearance)
        self._read_a, self._read_b = reader.into(self._model.a), reader.into(self._model.b)

    def checkMotion(self, s1: ob.State, s2: ob.State) -> bool:
        """Whether the straight motion from ``s1`` to ``s2`` is free."""
        try:
            self._read_a(s1)
            self._read_b(s2)
            return self._model.is_motion_free()
        except BaseException as error:
            if not faults.keep(error):
                raise
            return False
