"""What is asked about connections made of pieces, whoever computes it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import flights
from ompl_risk._kernels.connect_tables import ConnectTables
from ompl_risk._kernels.pieces import COLUMNS, MOST_PIECES, Tracks
from ompl_risk.clearance import TerrainClearance
from ompl_risk.motion import Risk
from ompl_risk.motion.terrain import kernel_parameters


class Connections(NamedTuple):
    """Connections of many pairs of vertices.

    Attributes:
        pieces: see ``ompl_risk._kernels.pieces``, shape (n, MOST_PIECES, COLUMNS).
        counts: how many of them are flown, 0 where there is no connection, shape (n,).
        durations: [s], inf where there is no connection, shape (n,).
    """

    pieces: FloatArray
    counts: NDArray[np.int64]
    durations: FloatArray

    @classmethod
    def joining(cls, tables: ConnectTables, a: FloatArray, b: FloatArray) -> Connections:
        """The connections from the vertices a[k] to b[k], shape (n, 5)."""
        n = len(a)
        pieces = np.empty((n, MOST_PIECES, COLUMNS))
        made = cls(pieces, np.empty(n, np.int64), np.empty(n))
        flights.connections(tables, a, b, *made)
        return made


class FlightRisk(ABC):
    """Clearances, and collision and risk of connections, as ``MotionBatch`` promises them.

    Attributes:
        compiled: whether no Python runs for each connection or each distance.
    """

    compiled: bool

    @abstractmethod
    def clearances(self, positions: FloatArray) -> FloatArray:
        """Clearances d [m] at positions (n, 3), shape (n,)."""

    @abstractmethod
    def costs(self, made: Connections) -> FloatArray:
        """Costs of the connections; inf in collision and where there is none, shape (n,)."""

    @abstractmethod
    def are_free(self, made: Connections) -> NDArray[np.bool_]:
        """Whether there is a connection and every state of it is free, shape (n,)."""

    @abstractmethod
    def bounds(self, travel: FloatArray, d_a: FloatArray, d_b: FloatArray) -> FloatArray:
        """Lower bounds for the cost of any way at ``Risk.speed`` or less, shape (n,).

        Args:
            travel: what the way takes at full speed, as a length [m], shape (n,).
            d_a: clearance where it begins [m], shape (n,).
            d_b: clearance where it ends [m], shape (n,).
        """


class TerrainFlightRisk(FlightRisk):
    """``FlightRisk`` over a ``TerrainClearance``, in compiled code.

    The avoidance function is one of this library.

    Args:
        tracks: where the manoeuvres lead.
        clearance: the terrain and the vehicle's radius.
        risk: how risk is counted.
    """

    compiled = True

    def __init__(self, tracks: Tracks, clearance: TerrainClearance, risk: Risk) -> None:
        self._tracks, self._clearance = tracks, clearance
        self._given = kernel_parameters(clearance.radius, risk)

    def clearances(self, positions: FloatArray) -> FloatArray:
        """Clearances d [m], shape (n,)."""
        return self._clearance(positions)

    def costs(self, made: Connections) -> FloatArray:
        """Costs of the connections; inf in collision and where there is none, shape (n,)."""
        out = np.empty(len(made.counts))
        handle = self._clearance.handle
        flights.costs_along(handle, self._tracks, made.pieces, made.counts, self._given, out)
        return out

    def are_free(self, made: Connections) -> NDArray[np.bool_]:
        """Whether there is a connection and every state of it is free, shape (n,)."""
        out = np.empty(len(made.counts), dtype=np.bool_)
        handle = self._clearance.handle
        flights.are_free_along(handle, self._tracks, made.pieces, made.counts, self._given, out)
        return out

    def bounds(self, travel: FloatArray, d_a: FloatArray, d_b: FloatArray) -> FloatArray:
        """Lower bounds for the cost of any way, see ``FlightRisk``."""
        out = np.empty(len(travel))
        travel, d_a, d_b = (np.require(x, np.float64, ["C", "W"]) for x in (travel, d_a, d_b))
        flights.travel_bounds(travel, d_a, d_b, self._given, out)
        return out
