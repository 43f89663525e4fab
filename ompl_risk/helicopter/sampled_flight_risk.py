"""Collision and risk of connections for any clearance: sampled, thousands of pieces together."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import flights
from ompl_risk._kernels.pieces import (
    CLIMB,
    DURATION,
    KIND,
    MOST_PIECES,
    NUMBER,
    SPEED,
    TRIM,
    Tracks,
)
from ompl_risk.helicopter.flight_risk import Connections, FlightRisk
from ompl_risk.motion import Risk, SampledBatch, halving
from ompl_risk.motion.lines import BLOCK, Distances

EVERYWHERE = np.array([-math.inf, math.inf, -math.inf, math.inf])


def known_extent(clearance: Any) -> FloatArray:
    """West, east, south and north edge [m] of what is mapped, also of members of a union.

    Outside a ``TerrainClearance`` is -inf, and no clearance near the edge announces it.
    """
    box = EVERYWHERE.copy()
    extents = [known_extent(member) for member in getattr(clearance, "members", ())]
    terrain = getattr(clearance, "terrain", None)
    extents += [terrain.extent] if terrain is not None else []
    for west, east, south, north in extents:
        box[[0, 2]] = np.maximum(box[[0, 2]], (west, south))
        box[[1, 3]] = np.minimum(box[[1, 3]], (east, north))
    return box


class Curves:
    """Pieces as ``halving`` takes them: where they lead, and what a clearance says on the way.

    Args:
        distances: the clearance.
        tracks: where the manoeuvres lead.
        rows: the pieces, shape (n, COLUMNS).

    Attributes:
        seconds: their durations [s], shape (n,).
        travel: how far the vehicle can move on them [m], shape (n,).
    """

    def __init__(self, distances: Distances, tracks: Tracks, rows: FloatArray) -> None:
        self._distances, self._tracks, self._rows = distances, tracks, rows
        self.seconds = rows[:, DURATION]
        fastest = np.hypot(rows[:, SPEED], rows[:, CLIMB])
        flown = rows[:, KIND] != TRIM
        fastest[flown] = tracks.fastest[rows[flown, NUMBER].astype(np.intp)]
        self.travel = fastest * self.seconds

    def __len__(self) -> int:
        return len(self.travel)

    def clearances(self, k: NDArray[np.intp], s: FloatArray) -> FloatArray:
        """Clearances [m] at fractions s of the pieces k, 0 in collision, shape (m,)."""
        positions = np.empty((len(k), 3))
        flights.positions_on(self._tracks, self._rows, k, s * self.seconds[k], positions)
        found = [self._distances(positions[i : i + BLOCK]) for i in range(0, len(k), BLOCK)]
        return np.maximum(np.concatenate([np.empty(0), *found]), 0.0)


class SampledFlightRisk(FlightRisk):
    """``FlightRisk`` over anything that maps points to distances.

    The clearance must be 1-Lipschitz in the position, as ``Clearance`` says.

    Args:
        tracks: where the manoeuvres lead.
        clearance: callable with points (n, 3) [m].
        risk: how risk is counted.
    """

    compiled = False

    def __init__(self, tracks: Tracks, clearance: Any, risk: Risk) -> None:
        self._tracks, self._risk = tracks, risk
        self._distances = Distances(clearance, 3)
        self._box = known_extent(clearance)
        self._straight = SampledBatch(clearance, risk)

    def clearances(self, positions: FloatArray) -> FloatArray:
        """Clearances d [m], shape (n,)."""
        return self._straight.clearances(positions)

    def costs(self, made: Connections) -> FloatArray:
        """Costs of the connections; inf in collision and where there is none, shape (n,)."""
        owner, curves, outside = self._curves(made)
        costs = np.where(made.counts > 0, 0.0, math.inf)
        costs[owner[outside]] = math.inf
        if math.isinf(self._risk.exponent):
            np.maximum.at(costs, owner, halving.maxima(curves, self._risk))
            return costs
        shares = halving.powers(curves, self._risk, curves.seconds)
        costs += np.bincount(owner, shares, minlength=len(costs))
        flown = made.counts > 0
        costs[flown] += self._risk.weight * made.durations[flown]
        return costs

    def are_free(self, made: Connections) -> NDArray[np.bool_]:
        """Whether there is a connection and every state of it is free, shape (n,)."""
        owner, curves, outside = self._curves(made)
        free = made.counts > 0
        free[owner[outside]] = False
        free[owner[~halving.are_free(curves)]] = False
        return free

    def bounds(self, travel: FloatArray, d_a: FloatArray, d_b: FloatArray) -> FloatArray:
        """Lower bounds for the cost of any way, see ``FlightRisk``."""
        a = np.zeros((len(travel), 3))
        b = a.copy()
        b[:, 0] = travel
        return self._straight.heuristics(a, b, d_a, d_b)

    def _curves(self, made: Connections) -> tuple[NDArray[np.intp], Curves, NDArray[np.bool_]]:
        """For all pieces whose they are, the pieces, and which leave what is mapped."""
        flown = np.arange(MOST_PIECES) < made.counts[:, None]
        owner, rows = np.nonzero(flown)[0], made.pieces[flown]
        inside = np.empty(len(rows), dtype=np.bool_)
        flights.are_within(self._box, self._tracks, rows, inside)
        return owner, Curves(self._distances, self._tracks, rows), ~inside
