"""Between OMPL's states and paths, and the rows and routes of a roadmap."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from ompl import base as ob

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge.controls import to_path_control
from ompl_risk.bridge.states import StateReader
from ompl_risk.motion.kinodynamic import KinodynamicSteering
from ompl_risk.planners.roadmap.publishing import to_path
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route


class Translation(ABC):
    """Reads OMPL's states as rows of a roadmap, and writes its routes as OMPL's paths.

    Attributes:
        quick: whether a path takes so little time to write that every better one can be published.
    """

    quick: bool = True

    @abstractmethod
    def row(self, state: Any) -> FloatArray:
        """A state as a row, perhaps wider than the roadmap's: it keeps what it does not plan.

        Raises:
            ArgumentError: a state that no row stands for.
        """

    @abstractmethod
    def path(self, route: Route, roadmap: Roadmap) -> Any:
        """A route of a roadmap as a path of OMPL."""


class GeometricTranslation(Translation):
    """Positions or poses, and ``og.PathGeometric``.

    Args:
        si: over R^3 or SE(3).
    """

    def __init__(self, si: ob.SpaceInformation) -> None:
        self._si, self._numbers = si, _Numbers(si)

    def row(self, state: Any) -> FloatArray:
        """All numbers of a state."""
        return self._numbers(state)

    def path(self, route: Route, roadmap: Roadmap) -> Any:
        """The corners of a route; turning evenly where the roadmap plans positions only."""
        turns, whole = None, roadmap.whole
        if self._numbers.width == 7 and route.states.shape[1] == 3:
            turns = whole[int(route.vertices[0])][3:], whole[int(route.vertices[-1])][3:]
        return to_path(self._si, route.states, turns)


class VertexTranslation(Translation):
    """The vertices of a steering, and ``oc.PathControl``.

    Args:
        si: an ``oc.SpaceInformation`` over the states of the vehicle.
        steering: says what the vertices are.
    """

    quick = False

    def __init__(self, si: Any, steering: KinodynamicSteering) -> None:
        self._si, self._steering, self._numbers = si, steering, _Numbers(si)

    def row(self, state: Any) -> FloatArray:
        """The vertex that stands for a state."""
        return self._steering.vertex(self._numbers(state))

    def path(self, route: Route, roadmap: Roadmap) -> Any:
        """The flight along a route: states, and inputs with their durations."""
        flight = self._steering.flight(roadmap.states[route.vertices])
        return to_path_control(self._si, flight)


class _Numbers:
    """States as new arrays, shape (width,)."""

    def __init__(self, si: ob.SpaceInformation) -> None:
        reader = StateReader(si.getStateSpace())
        self.width = reader.width
        self._buffer = np.empty(reader.width)
        self._read = reader.into(self._buffer)

    def __call__(self, state: Any) -> FloatArray:
        self._read(state)
        return self._buffer.copy()
