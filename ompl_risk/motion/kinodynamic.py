"""Roadmaps of vehicles with dynamics: what is a vertex, and how vertices are connected."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from ompl_risk._arrays import FloatArray
from ompl_risk.motion.base import Risk
from ompl_risk.motion.batch import MotionBatch


class KinodynamicSteering(ABC):
    """Says what the vertices of a vehicle's roadmap are, and what it flies between them.

    A vertex is a row of ``width`` numbers, its position [m] first. It stands for one whole state of
    the vehicle, ``state_width`` numbers, in which it can be held: a trim at a place and a heading.
    Connections are directed.

    Duties of an implementer:

    1. The motions of ``batch`` begin and end exactly in the states of their vertices, so that
       they can be joined.
    2. ``speed`` is never exceeded: lower bounds rely on it.
    3. Answers depend on the arguments alone.

    Attributes:
        width: numbers in a vertex.
        state_width: numbers in a state of the vehicle.
        dimensions: uniform numbers that a vertex is made from.
        speed: greatest speed of the vehicle on any connection [m/s].
        slack: how far a flight may be beside its connections [m].
    """

    width: int
    state_width: int
    dimensions: int
    speed: float
    slack: float = 0.0

    @abstractmethod
    def vertices(self, unit: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        """Vertices from points of the unit cube, several from each if there are several trims.

        Args:
            unit: uniform numbers in [0, 1), shape (n, dimensions).
            low: least coordinates [m], shape (3,).
            high: greatest coordinates [m], shape (3,).

        Returns:
            Shape (n * k, width), the k vertices from a point one after the other.
        """

    @abstractmethod
    def places(self, vertices: FloatArray) -> FloatArray:
        """Points whose Euclidean distances say which vertices are near each other, shape (n, m)."""

    @abstractmethod
    def batch(self, clearance: Any, risk: Risk, *, threads: int | None = None) -> MotionBatch:
        """Clearances of vertices, and durations and risks of the connections between them.

        Args:
            clearance: of the vehicle's body.
            risk: how risk is counted; its speed is that of the lower bounds.
            threads: of compiled code, at most; ``None`` uses all processors.
        """

    @abstractmethod
    def vertex(self, state: FloatArray) -> FloatArray:
        """The vertex that stands for a state, shape (width,).

        Raises:
            ArgumentError: the state is none in which the vehicle can be held.
        """

    @abstractmethod
    def state(self, vertex: FloatArray) -> FloatArray:
        """The state that a vertex stands for, shape (state_width,)."""

    @property
    def specimen(self) -> Any:
        """A short flight, with ``dt``, ``states`` and ``controls``; None for no comparison.

        What is to fly the others is asked to fly it first: it may be another vehicle.
        """
        return None

    def broken_limit(self, limits: Any) -> str | None:  # noqa: ARG002
        """What in its motions breaks the limits of a vehicle, in words; None if nothing does."""
        return None

    @abstractmethod
    def flight(self, vertices: FloatArray) -> Any:
        """The flight along a chain of vertices, with its inputs: see ``Flight``.

        Args:
            vertices: each connected to the next, shape (k, width).
        """
