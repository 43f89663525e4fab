"""Clearance as an OMPL state validity checker."""

from __future__ import annotations

from typing import Any

from ompl import base as ob
from ompl import control as oc

from ompl_risk.bridge import faults
from ompl_risk.bridge.timed import state_model


class ClearanceValidityChecker(ob.StateValidityChecker):
    """A state is valid if the vehicle is free there, ``d(q) > 0``.

    In a control space information the state's bounds are checked too: control planners of OMPL
    leave that to the checker.

    Args:
        si: over R^3, SE(3), or a compound space that starts with one of these; over
            ``ob.SpaceTimeStateSpace`` of R^3 where obstacles move.
        clearance: d(q); callable with points (n, 3) [m], or poses (n, 7) if it uses orientation.
            Or d(q, t), as a ``MovingClearance``: the state says the time.

    Raises:
        ArgumentError: a state space of another kind, or one without the orientation or the time
            that the clearance needs.

    Attributes:
        obstacles: the clearance.
    """

    def __init__(self, si: ob.SpaceInformation, clearance: Any) -> None:
        super().__init__(si)
        self.obstacles = clearance
        space: Any = si.getStateSpace()
        reader, self._model = state_model(space, clearance)
        self._read = reader.into(self._model.a)
        self._within = space.satisfiesBounds if isinstance(si, oc.SpaceInformation) else None

    def isValid(self, state: ob.State) -> bool:
        """Whether the vehicle is free at ``state``."""
        try:
            if self._within is not None and not self._within(state):
                return False
            self._read(state)
            return self._model.is_free()
        except BaseException as error:
            if not faults.keep(error):
                raise
            return False

    def clearance(self, state: ob.State) -> float:
        """Clearance d [m] at ``state``."""
        try:
            self._read(state)
            return self._model.clearance()
        except BaseException as error:
            if not faults.keep(error):
                raise
            return float("-inf")
