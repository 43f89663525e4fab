"""Legs: what a route consists of, read from the pieces that a planner hands on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, readonly
from ompl_risk._kernels.pieces import (
    CLIMB,
    COLUMNS,
    DURATION,
    HEADING,
    KIND,
    MANOEUVRE,
    NUMBER,
    SPEED,
    TRIM,
    TURN,
    X,
)
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.poses import moved, seen_from
from ompl_risk.helicopter.primitives import Manoeuvre
from ompl_risk.helicopter.trims import Trim

TOLERANCE = 1e-6
"""How well pieces join [m, rad, s]."""

LONGEST = 60.0
"""Longer trims are flown as several [s]: deviations that rounding starts grow with time."""

Motion = Trim | Manoeuvre


class Leg(NamedTuple):
    """A trim or a manoeuvre of a route.

    Attributes:
        motion: which.
        begin: when it begins [s].
        duration: how long it takes [s].
        pose: where it begins: x, y, z [m] and heading [rad], shape (4,).
    """

    motion: Motion
    begin: float
    duration: float
    pose: FloatArray

    @property
    def end(self) -> FloatArray:
        """Where it ends, shape (4,)."""
        if isinstance(self.motion, Trim):
            return moved(self.pose, self.motion.displacement(self.duration))
        return moved(self.pose, self.motion.displacement)

    @property
    def last(self) -> Trim:
        """The trim in which it ends."""
        return self.motion if isinstance(self.motion, Trim) else self.motion.last


def legs_of(library: PrimitiveLibrary, start: ArrayLike, pieces: ArrayLike) -> tuple[Leg, ...]:
    """The legs of a route, see ``planned_route``."""
    trim, pose = _vertex(library, start)
    rows = readonly("pieces", pieces, (None, COLUMNS), f"(m, {COLUMNS})")
    legs: list[Leg] = []
    begin = 0.0
    for k, row in enumerate(rows):
        motion = _motion(library, k, row)
        _check_join(k, row, trim, motion, pose)
        leg = Leg(motion, begin, float(row[DURATION]), row[X : HEADING + 1].copy())
        begin, trim, pose = begin + leg.duration, leg.last, leg.end
        legs.append(leg)
    if not legs:
        raise ArgumentError("pieces.shape", rows.shape, f"(m, {COLUMNS}) with m >= 1")
    joined = [part for leg in _joined(legs) for part in _divided(leg, library.dt)]
    return tuple(joined) or (legs[0],)


def _vertex(library: PrimitiveLibrary, start: ArrayLike) -> tuple[Trim, FloatArray]:
    vertex = readonly("start", start, (5,), "(5,): x, y, z [m], heading [rad], index of the speed")
    index = float(vertex[4])
    if index not in range(len(library.speeds)):
        allowed = f"an index of library.speeds, 0 to {len(library.speeds) - 1}"
        raise ArgumentError("start[4]", index, allowed)
    return library.trim(float(library.speeds[int(index)])), vertex[:4]


def _motion(library: PrimitiveLibrary, k: int, row: FloatArray) -> Motion:
    kind, duration, number = row[KIND], float(row[DURATION]), float(row[NUMBER])
    if duration < 0.0:
        raise ArgumentError(f"pieces[{k}, DURATION]", duration, "0 or more [s]")
    if kind == TRIM:
        return library.trim(float(row[SPEED]), float(row[CLIMB]), float(row[TURN]))
    if kind != MANOEUVRE:
        raise ArgumentError(f"pieces[{k}, KIND]", float(kind), "0, a trim, or 1, a manoeuvre")
    if number not in range(len(library.manoeuvres)):
        allowed = f"a manoeuvre of the library, 0 to {len(library.manoeuvres) - 1}"
        raise ArgumentError(f"pieces[{k}, NUMBER]", number, allowed)
    found = library.manoeuvres[int(number)]
    if abs(found.duration - duration) > TOLERANCE:
        allowed = f"{found.duration:g} s, which manoeuvre {int(number)} takes"
        raise ArgumentError(f"pieces[{k}, DURATION]", duration, allowed)
    return found


def _check_join(k: int, row: FloatArray, trim: Trim, motion: Motion, pose: FloatArray) -> None:
    first = motion if isinstance(motion, Trim) else motion.first
    before = f"piece {k - 1}" if k else "the start"
    if first.key != trim.key:
        allowed = f"that of {before}, {tuple(trim.key)}"
        raise ArgumentError(f"first trim of pieces[{k}]", tuple(first.key), allowed)
    gap = np.abs(seen_from(pose, row[X : HEADING + 1]))
    scale = 1.0 + float(np.abs(pose[:3]).max()) * 1e-3
    if gap.max() > TOLERANCE * scale:
        where, allowed = row[X : HEADING + 1].tolist(), f"where {before} ends, {pose.tolist()}"
        raise ArgumentError(f"pieces[{k}, X:HEADING]", where, allowed)


def _joined(legs: list[Leg]) -> Iterator[Leg]:
    """Legs without trims of no duration, and with equal trims that follow each other as one."""
    held: Leg | None = None
    for leg in legs:
        if held is not None and held.motion is leg.motion and isinstance(leg.motion, Trim):
            held = held._replace(duration=held.duration + leg.duration)
            continue
        if held is not None and held.duration > 0.0:
            yield held
        held = leg
    if held is not None and held.duration > 0.0:
        yield held


def _divided(leg: Leg, dt: float) -> Iterator[Leg]:
    """A trim in parts of at most about a minute, all but the last of them of whole steps."""
    parts = math.ceil(leg.duration / LONGEST)
    if not isinstance(leg.motion, Trim) or parts < 2:
        yield leg
        return
    each = round(leg.duration / parts / dt) * dt
    for k in range(parts):
        pose = moved(leg.pose, leg.motion.displacement(k * each))
        duration = each if k < parts - 1 else leg.duration - k * each
        yield Leg(leg.motion, leg.begin + k * each, duration, pose)
