"""Which states and motions are allowed, besides what the risk says."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.motion import MotionBatch

Flags = NDArray[np.bool_]


class Gate(ABC):
    """Allows or forbids states and motions between them.

    Attributes:
        compiled: whether no Python runs for single states or motions.
    """

    compiled: bool = False

    @abstractmethod
    def allows_states(self, states: FloatArray) -> Flags:
        """Which states are allowed, shape (n,)."""

    @abstractmethod
    def allows_motions(self, a: FloatArray, b: FloatArray) -> Flags:
        """Which motions from a[k] to b[k] are allowed throughout, shape (n,)."""


class OpenGate(Gate):
    """Allows everything: an infinite risk is enough to keep off obstacles."""

    compiled = True

    def allows_states(self, states: FloatArray) -> Flags:
        """True for all."""
        return np.ones(len(states), np.bool_)

    def allows_motions(self, a: FloatArray, b: FloatArray) -> Flags:  # noqa: ARG002
        """True for all."""
        return np.ones(len(a), np.bool_)


class ClearanceGate(Gate):
    """Allows what is free by a clearance, such as one that demands a distance from obstacles.

    Args:
        motions: over that clearance.
    """

    def __init__(self, motions: MotionBatch) -> None:
        self._motions = motions
        self.compiled = motions.compiled

    def allows_states(self, states: FloatArray) -> Flags:
        """Which states are free."""
        return self._motions.clearances(states) > 0.0

    def allows_motions(self, a: FloatArray, b: FloatArray) -> Flags:
        """Which motions are free throughout."""
        return self._motions.are_free(a, b)


class BoxGate(Gate):
    """Allows what stays within a box: between its vertices a vehicle may swing out.

    Args:
        motions: of the steering.
        low: least coordinates [m], shape (3,).
        high: greatest coordinates [m], shape (3,).
        margin: that motions keep to the sides of the box [m].
    """

    def __init__(
        self, motions: MotionBatch, low: FloatArray, high: FloatArray, *, margin: float = 0.0
    ) -> None:
        self._motions, self._low, self._high, self._margin = motions, low, high, margin
        self.compiled = motions.compiled

    def allows_states(self, states: FloatArray) -> Flags:
        """Which states lie in the box."""
        positions = states[:, :3]
        return np.all((positions >= self._low) & (positions <= self._high), axis=1)

    def allows_motions(self, a: FloatArray, b: FloatArray) -> Flags:
        """Which motions lie in the box throughout."""
        low, high = self._motions.extents(a, b)
        within = (low >= self._low + self._margin) & (high <= self._high - self._margin)
        return np.all(within, axis=1)


class AllGates(Gate):
    """Allows what several gates allow.

    Args:
        gates: one or more.
    """

    def __init__(self, gates: Sequence[Gate]) -> None:
        self._gates = tuple(gates)
        self.compiled = all(gate.compiled for gate in gates)

    def allows_states(self, states: FloatArray) -> Flags:
        """Which states all of them allow."""
        return np.all([gate.allows_states(states) for gate in self._gates], axis=0)

    def allows_motions(self, a: FloatArray, b: FloatArray) -> Flags:
        """Which motions all of them allow."""
        return np.all([gate.allows_motions(a, b) for gate in self._gates], axis=0)


def all_of(gates: Sequence[Gate]) -> Gate:
    """One gate for several, or for none."""
    if not gates:
        return OpenGate()
    return gates[0] if len(gates) == 1 else AllGates(gates)
