"""States that carry their time: places and motions among obstacles that move."""

from __future__ import annotations

from typing import Any

import numpy as np
from ompl import base as ob

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge.buffers import capsule_of
from ompl_risk.bridge.states import StateReader
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, motion_model
from ompl_risk.motion.moving import moves

TIMED = (
    "ob.SpaceTimeStateSpace(space, vMax) over space = ob.RealVectorStateSpace(3): obstacles that "
    "move need states with a time"
)
"""The space in which a moving clearance can be asked."""

ROUNDING = 1e-9
"""By which fraction a motion may be faster than the space says: times are rounded."""


def is_timed(space: Any) -> bool:
    """Whether the states of a space carry a time."""
    return isinstance(space, ob.SpaceTimeStateSpace)


class TimedReader:
    """Writes states of space-time into arrays: x, y, z [m] and the time [s].

    Args:
        space: an ``ob.SpaceTimeStateSpace`` over R^3.

    Raises:
        ArgumentError: any other space.
    """

    width = 4

    def __init__(self, space: Any) -> None:
        if not is_timed(space):
            raise ArgumentError("si.getStateSpace()", type(space).__name__, TIMED)
        place = space.getSpaceComponent()
        if type(place) is not ob.RealVectorStateSpace or place.getDimension() != 3:
            kind = f"one over a {type(place).__name__}"
            raise ArgumentError("si.getStateSpace()", kind, TIMED)
        self._space = space

    def into(self, buffer: FloatArray) -> Any:
        """A function that writes a state into ``buffer``, which must outlive it and never move.

        Args:
            buffer: contiguous, shape (4,).
        """
        capsule, serialize = capsule_of(buffer.ctypes.data), self._space.serialize

        def read(state: ob.State) -> None:
            serialize(capsule, state)

        return read


class TimedMotion:
    """Answers about the states in two buffers, ``a`` and ``b``, and the motion from one to another.

    A motion is flown straight at constant speed. It must take its time: backwards in time, or
    faster than the space allows, is no motion.

    Args:
        clearance: d(q, t), as a ``MovingClearance``, or d(q) of obstacles that stand still.
        fastest: greatest speed [m/s].

    Attributes:
        a, b: x, y, z [m] and time [s], shape (4,).
    """

    def __init__(self, clearance: Any, fastest: float) -> None:
        self.a, self.b = np.zeros(4), np.zeros(4)
        self._clearance, self._fastest = clearance, fastest
        self._static = None if moves(clearance) else motion_model(clearance, Risk(speed=1.0), 4)

    def clearance(self) -> float:
        """Clearance d [m] at a."""
        if self._static is not None:
            self._static.a[:] = self.a
            return self._static.clearance()
        return float(self._clearance(self.a[None, :3], self.a[3:])[0])

    def is_free(self) -> bool:
        """Whether a is free, d > 0."""
        return self.clearance() > 0.0

    def is_motion_free(self) -> bool:
        """Whether the motion from a to b can be flown and is free throughout."""
        a, b = self.a, self.b
        takes = b[3] - a[3]
        way = float(np.linalg.norm(b[:3] - a[:3]))
        if not way <= self._fastest * takes * (1.0 + ROUNDING):  # nor backwards in time
            return False
        if self._static is not None:
            self._static.a[:], self._static.b[:] = a, b
            return self._static.is_motion_free()
        if takes == 0.0:
            return self.is_free()
        return bool(self._clearance.are_free(a[None, :3], a[3:], b[None, :3], b[3:])[0])


def state_model(space: Any, clearance: Any) -> tuple[Any, Any]:
    """What reads the states of a space, and what answers for a clearance about them.

    Args:
        space: R^3, SE(3), a compound space that starts with one of these, or space-time over R^3.
        clearance: d(q), or d(q, t) in space-time.

    Returns:
        With ``into(buffer)``; and with the buffers ``a`` and ``b``, ``clearance()``, ``is_free()``
        and ``is_motion_free()``.

    Raises:
        ArgumentError: a space of another kind, or one that the clearance cannot be asked in.
    """
    if is_timed(space) or moves(clearance):
        timed = TimedReader(space)
        return timed, TimedMotion(clearance, space.getVMax())
    reader = StateReader(space)
    return reader, motion_model(clearance, Risk(speed=1.0), reader.width)


def timed_rows(path: Any) -> FloatArray | None:
    """States of a path that carry their time, as rows x, y, z [m], t [s]; None if they do not."""
    states = path.getStates()
    if not states or type(states[0]) is not ob.CompoundState:
        return None
    if len(repr(path).split("\n", 1)[0].split()) != 4:  # its space is out of reach
        return None
    if not isinstance(states[0][1], ob.TimeState):
        return None
    return np.array([[*state[0][0:3], state[1].position] for state in states], dtype=np.float64)
