"""The helicopter's steering: from one trim at a place to another, by trims and manoeuvres."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly, real_number
from ompl_risk._kernels.connect import connection, connection_durations
from ompl_risk._kernels.pieces import COLUMNS, MOST_PIECES
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.batch import PrimitiveBatch, fastest
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.flight_limits import broken_in_controls, broken_in_states
from ompl_risk.helicopter.flying import fly
from ompl_risk.helicopter.hold_states import held_vertex
from ompl_risk.helicopter.library import PrimitiveLibrary, default_library
from ompl_risk.helicopter.parameters import Limits
from ompl_risk.helicopter.planned_route import PlannedRoute, planned_route
from ompl_risk.helicopter.primitive_path import PrimitivePath
from ompl_risk.helicopter.primitives import Manoeuvre
from ompl_risk.helicopter.tables import connect_tables, tracks, used
from ompl_risk.motion.base import Risk
from ompl_risk.motion.batch import MotionBatch
from ompl_risk.motion.kinodynamic import KinodynamicSteering

VERTEX = "(5,): x, y, z [m], heading [rad], index of the speed"


class HelicopterSteering(ReadOnlyArrays, KinodynamicSteering):
    """Connects vertices by the quickest turn, straight flight and turn of a primitive library.

    A vertex is x, y, z [m], heading [rad] and an index into ``library.speeds``: level straight
    flight at that speed, or hover. A connection is ::

        turn at the first speed | change of speed, cruise with a climb, change of speed | turn

    as a Dubins airplane flies, with the displacement and the duration of every manoeuvre accounted
    for exactly, so that it ends in the second vertex. Turns are hard or gentle, to either side; a
    change of heading smaller than that of the manoeuvres is flown as a turn and a counter-turn. Of
    all combinations, cruise speeds included, the one of least duration is taken. The climb is the
    gentlest that fits into the straight flight, which then takes no more time than a level one;
    a change of height smaller than that of the manoeuvres is flown up and down again.

    There is no way where the straight flight is too short for the manoeuvres or the climb: three
    turns in a row are not offered, nor turning while climbing. Hover to hover, a way leads straight
    up or down, but turning on the spot is one only if the manoeuvres return to the spot. Ways that
    take more than ``longest_ratio`` times as long as straight flight and half a hard circle at
    both ends are not offered either.

    Args:
        library: trims and manoeuvres; None: the one that comes with the package.
        cruise: speeds of straight flights [m/s], shape (m,); None: all of the library above 0.
            Start and goal may have any speed of the library.
        speeds: speeds of the roadmap's vertices [m/s], of the library's, shape (k,); None: as
            ``cruise``. With the fastest alone, ways through as many vertices are faster over open
            country; slow ones turn more tightly.
        longest_ratio: see above, 1 or more.
        height_weight: in the distance between vertices, what a metre of height counts: about the
            metres of straight flight that a gentle climb takes.
        reach: in that distance, what a heading counts: about a radian as much as this length [m].
        hover: for how long flights stay at a goal that is a hover and missed by more than a
            millimetre, in order to get there [s]. 0: not at all; it is missed by decimetres at
            most, and flights of equal time stay that.

    Raises:
        ArgumentError: no library, a speed that it does not have, or a number out of range.

    Example:
        >>> steering = HelicopterSteering()
        >>> a = steering.vertex_at((0.0, 0.0, 100.0), 0.0, speed=20.0)
        >>> b = steering.vertex_at((400.0, 100.0, 120.0), 1.0, speed=20.0)
        >>> steering.connect(a, b).exists
        True

    Reference: Dubins, On curves of minimal length with a constraint on average curvature, 1957;
    Chitsaz & LaValle, Time-optimal paths for a Dubins airplane, CDC 2007; Frazzoli, Dahleh & Feron,
    Maneuver-based motion planning for nonlinear systems with symmetries, IEEE T-RO 21(6), 2005.
    """

    width = 5
    state_width = 13
    dimensions = 4
    slack = 0.5

    def __init__(
        self,
        library: PrimitiveLibrary | None = None,
        *,
        cruise: ArrayLike | None = None,
        speeds: ArrayLike | None = None,
        longest_ratio: float = 3.0,
        height_weight: float = 10.0,
        reach: float = 400.0,
        hover: float = 0.0,
    ) -> None:
        self.library = default_library() if library is None else library
        if not isinstance(self.library, PrimitiveLibrary):
            raise ArgumentError("library", library, "a PrimitiveLibrary, or None")
        self.tables = connect_tables(self.library, cruise=cruise, longest_ratio=longest_ratio)
        self.tracks = tracks(self.library)
        self.cruise = tuple(v for v in self.library.speeds[self.tables.cruise].tolist() if v > 0.0)
        chosen = self.cruise if speeds is None else readonly("speeds", speeds, (None,), "(k,)")
        self._indices = [self._index(f"speeds[{k}]", v) for k, v in enumerate(chosen)]
        if not self._indices:
            raise ArgumentError("speeds", [], f"at least one of {self._offered()}")
        self._height_weight = positive("height_weight", height_weight)
        self._reach = real_number("reach", reach, "a finite length in metres, 0 or more")
        if not 0.0 <= self._reach < math.inf:
            raise ArgumentError("reach", reach, "a finite length in metres, 0 or more")
        self._hover = real_number("hover", hover, "a finite time in seconds, 0 or more")
        if not 0.0 <= self._hover < math.inf:
            raise ArgumentError("hover", hover, "a finite time in seconds, 0 or more")
        flown = (self.library.manoeuvres[k].fastest for k in used(self.tables))
        self.speed = max(fastest(self.tables, self.tracks), *flown, 0.0)

    def vertices(self, unit: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
        """Vertices in a box, one for each speed at every point.

        Args:
            unit: uniform numbers in [0, 1), shape (n, 4): position, and heading over 2 pi.
            low: least coordinates [m], shape (3,).
            high: greatest coordinates [m], shape (3,).

        Returns:
            Shape (n * k, 5), the k vertices from a point one after the other.
        """
        points = np.column_stack([low + unit[:, :3] * (high - low), 2.0 * math.pi * unit[:, 3]])
        speeds = np.tile(np.array(self._indices, dtype=np.float64), len(points))
        return np.column_stack([points.repeat(len(self._indices), axis=0), speeds])

    def places(self, vertices: FloatArray) -> FloatArray:
        """x, y, weighted z, and the heading as a point on a circle [m], shape (n, 5).

        Neighbours should be vertices that can be reached: little higher or lower for their
        distance, and of a heading not too different. The direction in which a vertex lies from
        another has no part, since distances are the same both ways. Weights and reach are what
        gave the fastest ways between random vertices of a roadmap without obstacles.
        """
        heading = vertices[:, 3]
        return np.column_stack(
            [
                vertices[:, :2],
                self._height_weight * vertices[:, 2],
                self._reach * np.cos(heading),
                self._reach * np.sin(heading),
            ]
        )

    def batch(self, clearance: Any, risk: Risk, *, threads: int | None = None) -> MotionBatch:
        """Clearances of vertices, durations and risks of connections, see the base class."""
        return PrimitiveBatch(self.tables, self.tracks, clearance, risk, threads)

    def vertex(self, state: FloatArray) -> FloatArray:
        """The vertex that stands for a state, shape (5,).

        Args:
            state: shape (13,): level straight flight at a speed of the library to 1e-6 in
                quaternion, v [m/s] and omega [rad/s], anywhere and in any heading.

        Raises:
            ArgumentError: another state: no trim holds it. Says which number is wrong, and what
                it is in the nearest trim.
        """
        return held_vertex(self.library, state)

    def vertex_at(self, position: ArrayLike, heading: float, *, speed: float) -> FloatArray:
        """The vertex at a position [m] and heading [rad], in level flight at a speed [m/s].

        Raises:
            ArgumentError: a speed that the library does not have, or a number out of range.
        """
        where = readonly("position", position, (3,), "(3,)")
        allowed = "a finite angle [rad]"
        if not math.isfinite(real_number("heading", heading, allowed)):
            raise ArgumentError("heading", heading, allowed)
        return np.array([*where, float(heading), float(self._index("speed", speed))])

    def state(self, vertex: FloatArray) -> FloatArray:
        """The state that a vertex stands for, shape (13,)."""
        row = self._checked("vertex", vertex)
        trim = self.library.trim(float(self.library.speeds[int(row[4])]))
        return trim.state(row[:3], float(row[3]))

    def connect(self, a: ArrayLike, b: ArrayLike) -> PrimitivePath:
        """The quickest way from vertex a to vertex b, shapes (5,); see ``PrimitivePath.exists``.

        Raises:
            ArgumentError: no vertices.
        """
        first, last = self._checked("a", a), self._checked("b", b)
        pieces = np.empty((MOST_PIECES, COLUMNS))
        count, duration = connection(self.tables, first, last, pieces)
        flown = pieces[:count].copy()
        flown.setflags(write=False)
        return PrimitivePath(self.library, first, flown, float(duration))

    def durations(self, a: ArrayLike, b: ArrayLike) -> FloatArray:
        """Durations [s] of the ways from a[k] to b[k], shapes (n, 5); inf where there is none.

        Raises:
            ArgumentError: rows that are no vertices.
        """
        first, last = (self._rows(name, rows) for name, rows in (("a", a), ("b", b)))
        if len(first) != len(last):
            raise ArgumentError("len(b)", len(last), f"{len(first)}, as many as a")
        out = np.empty(len(first))
        connection_durations(self.tables, first, last, out)
        return out

    @property
    def specimen(self) -> Manoeuvre:
        """The longest manoeuvre of the library that turns."""
        turning = [m for m in self.library.manoeuvres if m.first.key.turn or m.last.key.turn]
        return max(turning or self.library.manoeuvres, key=lambda m: m.duration)

    def broken_limit(self, limits: Limits) -> str | None:
        """Which limit a trim or manoeuvre breaks, and how, in words; None if none does."""
        library = self.library
        states = [trim.state((0.0, 0.0, 0.0), 0.0)[None] for trim in library.trims]
        states += [manoeuvre.states for manoeuvre in library.manoeuvres]
        controls = [trim.control[None] for trim in library.trims]
        controls += [manoeuvre.controls for manoeuvre in library.manoeuvres]
        broken = broken_in_states(limits, np.concatenate(states)) or broken_in_controls(
            limits, library.helicopter, np.concatenate(controls)
        )
        return None if broken is None else str(broken)

    def flight(self, vertices: FloatArray) -> Flight:
        """The flight along a chain of vertices, with its inputs: see ``Flight``.

        Args:
            vertices: each connected to the next, shape (k, 5), k >= 2.

        Raises:
            ArgumentError: fewer than two, rows that are no vertices, or no way between two: says
                which.
        """
        return fly(self.library, *self._chained(vertices), hover=self._hover)

    def planned(self, vertices: FloatArray) -> PlannedRoute:
        """What `flight` is meant to fly; takes and raises the same, a hundred times faster."""
        return planned_route(self.library, *self._chained(vertices))

    def _chained(self, vertices: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The first vertex and all pieces of a chain."""
        chain = self._rows("vertices", vertices)
        if len(chain) < 2:
            raise ArgumentError("len(vertices)", len(chain), "2 or more")
        ways = [self.connect(a, b) for a, b in pairwise(chain)]
        for k, way in enumerate(ways):
            if not way.exists:
                allowed = f"a vertex to which there is a way from vertices[{k}]"
                raise ArgumentError(f"vertices[{k + 1}]", chain[k + 1].tolist(), allowed)
        return chain[0], np.concatenate([way.pieces for way in ways])

    def _index(self, name: str, speed: float) -> int:
        """Index of a speed of the library."""
        real_number(name, speed, f"one of {self._offered()}")
        found = np.flatnonzero(np.abs(self.library.speeds - speed) <= 1e-9)
        if not len(found):
            raise ArgumentError(name, float(speed), f"one of {self._offered()}")
        return int(found[0])

    def _offered(self) -> str:
        return ", ".join(f"{v:g}" for v in self.library.speeds.tolist()) + " m/s"

    def _checked(self, name: str, vertex: ArrayLike) -> FloatArray:
        row = readonly(name, vertex, (5,), VERTEX)
        self._check_index(f"{name}[4]", row[4])
        return row

    def _rows(self, name: str, vertices: ArrayLike) -> FloatArray:
        rows = readonly(name, vertices, (None, 5), "(n, 5), rows of " + VERTEX)
        for k in np.flatnonzero(~np.isin(rows[:, 4], np.arange(len(self.library.speeds)))):
            self._check_index(f"{name}[{k}, 4]", rows[k, 4])
        return rows

    def _check_index(self, name: str, index: float) -> None:
        if float(index) not in range(len(self.library.speeds)):
            allowed = f"an index of library.speeds, 0 to {len(self.library.speeds) - 1}"
            raise ArgumentError(name, float(index), allowed)
