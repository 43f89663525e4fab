"""States as numbers: OMPL's states read into numpy arrays without a Python loop."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob

from ompl_risk.bridge.buffers import Buffer, capsule_of
from ompl_risk.errors import ArgumentError

ALLOWED = "R^3, SE(3), or a compound space whose first subspace is one of these"


class StateReader:
    """Writes states of a space into arrays, some 90 ns each whatever the dimension.

    The position is what comes first: three numbers [m], and in SE(3) the quaternion (x, y, z, w).
    Holds the space but not the space information, whose callbacks would otherwise keep it alive.

    Args:
        space: a state space that can be read, see ``ALLOWED``.

    Raises:
        ArgumentError: any other space.

    Attributes:
        width: numbers in a state.
        has_orientation: whether four of them are a quaternion at 3.
    """

    def __init__(self, space: Any) -> None:
        leading = _leading(space)
        self.has_orientation = isinstance(leading, ob.SE3StateSpace)
        self.width = -(-space.getSerializationLength() // 8)
        self._space = space

    def into(self, buffer: NDArray[np.float64]) -> Callable[[ob.State], None]:
        """A function that writes a state into ``buffer``, which must outlive it and never move.

        Args:
            buffer: contiguous, shape (width,).
        """
        capsule = capsule_of(buffer.ctypes.data)
        serialize = self._space.serialize

        def read(state: ob.State) -> None:
            serialize(capsule, state)

        return read


def _leading(space: Any) -> Any:
    """The R^3 or SE(3) at the start of a space."""
    found = space
    # Exact types: motions of derived spaces, as Owen's or Dubins', may be curves.
    while type(found) is ob.CompoundStateSpace and found.getSubspaceCount() > 0:
        found = found.getSubspace(0)
    if type(found) is ob.SE3StateSpace:
        return found
    if type(found) is ob.RealVectorStateSpace and found.getDimension() == 3:
        return found
    kind = type(space).__name__
    if isinstance(space, ob.RealVectorStateSpace):
        kind = f"R^{space.getDimension()}"
    raise ArgumentError("si.getStateSpace()", kind, ALLOWED)


class StateWriter:
    """Makes states of R^3 or SE(3) from numbers.

    Args:
        si: over one of these.
    """

    def __init__(self, si: ob.SpaceInformation) -> None:
        self._space: Any = si.getStateSpace()
        self._allocate = si.allocState  # the only allocation in OMPL 2.0.1 that does not leak
        self.width = StateReader(self._space).width
        self._buffer = Buffer(self.width)

    def state(self, numbers: NDArray[np.float64]) -> Any:
        """A new state with these numbers, shape (width,)."""
        state = self._allocate()
        self._buffer.numbers[:] = numbers
        self._space.deserialize(state, self._buffer.capsule)
        return state
