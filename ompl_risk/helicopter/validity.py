"""Whether the helicopter may be in a state, as OMPL asks it."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike
from ompl import base as ob

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import flight_checks, nearest
from ompl_risk.bridge import faults
from ompl_risk.bridge.buffers import Buffer, table
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.envelope import Envelope
from ompl_risk.helicopter.model import STATE
from ompl_risk.motion import Risk, motion_model


class HelicopterValidityChecker(ob.StateValidityChecker):
    """A state is valid within the limits and the box, and clear of obstacles, ``d(q) > 0``.

    Over a ``TerrainClearance`` an answer is one call of compiled code. It serves one thread.

    Args:
        si: over a space from ``state_space``.
        clearance: d(q); callable with points (n, 3) [m], or poses (n, 7) if it uses orientation.
        envelope: limits and box.

    Raises:
        ArgumentError: a clearance that is none.

    Attributes:
        obstacles: the clearance.
        envelope: limits and box.
    """

    def __init__(self, si: ob.SpaceInformation, clearance: Any, envelope: Envelope) -> None:
        super().__init__(si)
        self.obstacles, self.envelope = clearance, envelope
        space: Any = si.getStateSpace()
        self._read = space.serialize
        self._model = motion_model(clearance, Risk(speed=1.0), STATE)
        self._state = Buffer(STATE)
        self._at = self._state.capsule
        compiled = type(clearance) is TerrainClearance
        self._allowed = envelope.given(clearance.radius if compiled else 0.0)
        self._work = nearest.workspace()
        self._places = self._table(clearance.handle if compiled else ())
        self._address = self._places.ctypes.data
        self._is_flyable = flight_checks.is_flyable if compiled else self._asked
        self._is_flyable(self._address)  # compiles

    def isValid(self, state: ob.State) -> bool:
        """Whether the helicopter may be in ``state``."""
        try:
            self._read(self._at, state)
            return self._is_flyable(self._address)
        except BaseException as error:
            if not faults.keep(error):
                raise
            return False

    def clearance(self, state: ob.State) -> float:
        """Clearance d [m] at ``state``."""
        try:
            self._read(self._at, state)
            self._model.a[:] = self._state.numbers
            return self._model.clearance()
        except BaseException as error:
            if not faults.keep(error):
                raise
            return float("-inf")

    def check(self, name: str, value: ArrayLike) -> FloatArray:
        """A valid state, read-only, shape (13,).

        Args:
            name: what errors call it.
            value: a state, shape (13,), or a position to hover at, shape (3,) [m].

        Raises:
            ArgumentError: it is no state, breaks a limit, lies outside the box, or in or on an
                obstacle; the message has value and limit.
        """
        state = self.envelope.check(name, value)
        self._model.a[:] = state
        if not self._model.is_free():
            allowed = "above 0: clear of the ground and of all obstacles"
            raise ArgumentError(f"clearance of {name}", self._model.clearance(), allowed)
        return state

    def _asked(self, address: int) -> bool:
        """The same for a clearance of another kind."""
        if not flight_checks.is_within(address):
            return False
        self._model.a[:] = self._state.numbers
        return self._model.is_free()

    def _table(self, field: Any) -> Any:
        stack, keys = self._work
        arrays = (self._state.numbers, self._allowed, stack, keys)
        return table(*(array.ctypes.data for array in arrays), *field)
