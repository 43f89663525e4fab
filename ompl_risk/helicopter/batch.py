"""What a roadmap of helicopter flights asks about thousands of connections at a time."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import connect, connect_tables, flights
from ompl_risk._kernels.connect_tables import ConnectTables
from ompl_risk._kernels.pieces import Tracks
from ompl_risk.clearance.threads import in_chunks, thread_count
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight_risk import Connections, FlightRisk, TerrainFlightRisk
from ompl_risk.helicopter.sampled_flight_risk import SampledFlightRisk
from ompl_risk.helicopter.tables import used
from ompl_risk.motion import MotionBatch, Risk
from ompl_risk.motion.choice import answers_compiled

WIDTH = 5
"""Numbers in a vertex: x, y, z [m], heading [rad] and the index of the speed."""

BLOCK = 512
"""Connections whose pieces are held in memory together."""

LEAST = 256
"""Connections that are worth a thread."""

STEP = 0.1
"""Longest time between samples [s]: at 1 g straight pieces stay within 13 mm of the way."""

HASTE = 1e-9
"""By how much primitives may be faster than the risk's speed: rounding."""


def fastest(tables: ConnectTables, tracks: Tracks) -> float:
    """Greatest speed that a connection may reach [m/s]."""
    climbs = tables.climbs[..., connect_tables.CLIMB_RATE]
    flown = np.isfinite(tables.climbs[..., connect_tables.CLIMB_TIME])
    speeds = np.hypot(tables.speeds[:, None, None], np.where(flown, climbs, 0.0))
    return float(max(speeds.max(), *tracks.fastest[used(tables)], 0.0))


class PrimitiveBatch(MotionBatch):
    """``MotionBatch`` of the connections of trims and manoeuvres.

    Over a ``TerrainClearance``, with an avoidance function of this library, every answer is
    compiled code in several threads; any other clearance is asked about thousands of positions at a
    time. Risks are integrals over time along the curves that are flown, see ``Risk``; its speed
    only serves the lower bounds.

    Args:
        tables: what connections are made of.
        tracks: where the manoeuvres lead.
        clearance: callable with points (n, 3) [m]; the body is a sphere.
        risk: how risk is counted; its speed is at least that of the fastest primitive.
        threads: of compiled code, at most; ``None`` uses all processors.

    Raises:
        ArgumentError: a clearance that cannot be called or that needs an orientation, or a speed
            below that of the fastest primitive; later: vertices of another width, that are not
            finite, or of a speed that there is not.
    """

    width = WIDTH
    symmetric = False

    def __init__(
        self,
        tables: ConnectTables,
        tracks: Tracks,
        clearance: Any,
        risk: Risk,
        threads: int | None = None,
    ) -> None:
        greatest = fastest(tables, tracks)
        if greatest > (1.0 + HASTE) * risk.speed:
            allowed = f"at least {greatest:.9g} m/s, the speed of the fastest primitive"
            raise ArgumentError("risk.speed", risk.speed, allowed)
        self._tables, self._tracks, self._risk = tables, tracks, risk
        self._judge = flight_risk(tracks, clearance, risk)
        self._threads = thread_count(threads)
        self.compiled = self._judge.compiled

    def clearances(self, states: FloatArray) -> FloatArray:
        """Clearances d [m] at the vertices, shape (n,)."""
        vertices = self._vertices("states", states)
        return self._judge.clearances(np.ascontiguousarray(vertices[:, :3]))

    def are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        """Whether there is a connection from a[k] to b[k] and all of it is free, shape (n,)."""
        return self._connected(a, b, np.empty(len(a), np.bool_), self._judge.are_free)

    def costs(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Costs of the connections, inf in collision or where there is none, shape (n,)."""
        return self._connected(a, b, np.empty(len(a)), self._judge.costs)

    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Durations [s] of the connections, inf where there is none, shape (n,)."""
        a, b = self._pairs(a, b)
        out = np.empty(len(a))

        def work(i: int, j: int) -> None:
            connect.connection_durations(self._tables, a[i:j], b[i:j], out[i:j])

        in_chunks(work, len(a), self._threads, least=LEAST)
        return out

    def heuristics(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> FloatArray:
        """Lower bounds for the cost of any way: as for straight motions at full speed."""
        return self._judge.bounds(_distances(*self._pairs(a, b)), d_a, d_b)

    def least_durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Lower bounds for the duration [s] of any way: straight at full speed, shape (n,)."""
        return _distances(*self._pairs(a, b)) / self._risk.speed

    def edge_bounds(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Lower bounds for the costs of the connections, and their exact durations [s].

        Both are inf where there is no connection. However the vehicle flies, d moves away from its
        values at both ends no faster than ``Risk.speed``, for all of that duration.
        """
        durations = self.durations(a, b)
        bounds, exist = np.full(len(a), math.inf), np.isfinite(durations)
        travel = self._risk.speed * durations[exist]
        bounds[exist] = self._judge.bounds(travel, d_a[exist], d_b[exist])
        return bounds, durations

    def extents(self, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Corners of the least boxes [m] that hold the connections, shapes (n, 3).

        Where there is no connection the box holds both vertices.
        """
        low, high = super().extents(*self._pairs(a, b))

        def widen(made: Connections, rows: slice) -> None:
            flights.extents_along(self._tracks, made.pieces, made.counts, low[rows], high[rows])

        self._blocks(a, b, widen)
        return low, high

    def samples(self, a: FloatArray, b: FloatArray) -> list[FloatArray]:
        """States that the connections pass at equal time steps of 0.1 s at most.

        Rows are x, y, z, heading and the index of the speed, a fraction between two speeds. The
        first is a[k] and the last b[k], whose heading may be whole turns from those before.
        """
        found: list[FloatArray] = [np.empty((0, WIDTH)) for _ in range(len(a))]

        def sample(made: Connections, rows: slice) -> None:
            for k, (pieces, count) in enumerate(zip(made.pieces, made.counts, strict=True)):
                if count:
                    found[rows.start + k] = self._sampled(pieces, int(count))

        self._blocks(a, b, sample)
        for k, states in enumerate(found):
            if len(states):
                states[0], states[-1] = a[k], b[k]
        return found

    def _sampled(self, pieces: FloatArray, count: int) -> FloatArray:
        """The way of so many pieces at equal time steps."""
        duration = float(pieces[:count, flights.DURATION].sum())
        steps = max(math.ceil(duration / STEP), 1)
        out = np.empty((steps + 1, WIDTH))
        speeds = self._tables.speeds
        flights.samples_along(self._tracks, speeds, pieces, count, duration / steps, out)
        return out

    def _connected(
        self, a: FloatArray, b: FloatArray, out: Any, answer: Callable[[Connections], NDArray[Any]]
    ) -> Any:
        """Connect some at a time, and write the answers into ``out``."""

        def work(made: Connections, rows: slice) -> None:
            out[rows] = answer(made)

        self._blocks(a, b, work)
        return out

    def _blocks(
        self, a: FloatArray, b: FloatArray, work: Callable[[Connections, slice], None]
    ) -> None:
        """Call ``work`` with some connections at a time and the rows that they are."""
        a, b = self._pairs(a, b)

        def chunk(i: int, j: int) -> None:
            for first in range(i, j, BLOCK):
                rows = slice(first, min(first + BLOCK, j))
                work(Connections.joining(self._tables, a[rows], b[rows]), rows)

        # a user's clearance need not bear several threads
        in_chunks(chunk, len(a), self._threads if self.compiled else 1, least=LEAST)

    def _pairs(self, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        if len(a) != len(b):
            raise ArgumentError("b.shape", np.shape(b), f"{np.shape(a)}, as a")
        return self._vertices("a", a), self._vertices("b", b)

    def _vertices(self, name: str, vertices: FloatArray) -> FloatArray:
        """Vertices as the kernels take them; a speed that there is not would read elsewhere."""
        array = _plain(vertices)
        if array.ndim != 2 or array.shape[1] != WIDTH:
            raise ArgumentError(f"{name}.shape", array.shape, f"(n, {WIDTH})")
        speed, count = array[:, 4], len(self._tables.speeds)
        good = np.isfinite(array).all(axis=1)
        good &= (speed >= 0.0) & (speed < count) & (speed == np.floor(speed))
        if not good.all():
            k = int(np.argmin(good))
            allowed = f"finite, the last an index of the {count} speeds, from 0 to {count - 1}"
            raise ArgumentError(f"{name}[{k}]", array[k].tolist(), allowed)
        return array


def flight_risk(tracks: Tracks, clearance: Any, risk: Risk) -> FlightRisk:
    """The quickest that can answer for a clearance.

    Raises:
        ArgumentError: a clearance that cannot be called, or one that needs an orientation.
    """
    if not callable(clearance):
        allowed = "callable with points (n, 3), as TerrainClearance"
        raise ArgumentError("clearance", clearance, allowed)
    if getattr(clearance, "uses_orientation", False):
        allowed = "one that does not use the orientation: here the body is a sphere"
        raise ArgumentError("clearance", clearance, allowed)
    asked: Any = clearance
    if answers_compiled(asked, risk):
        return TerrainFlightRisk(tracks, asked, risk)
    return SampledFlightRisk(tracks, clearance, risk)


def _plain(array: FloatArray) -> FloatArray:
    """As the kernels were compiled for: another layout would be compiled anew."""
    return np.require(array, np.float64, ["C", "W"])


def _distances(a: FloatArray, b: FloatArray) -> FloatArray:
    """Straight from a[k] to b[k] [m], shape (n,)."""
    return np.linalg.norm(b[:, :3] - a[:, :3], axis=1)
