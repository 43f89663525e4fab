"""Pieces that the helicopter's ways are made of, and where the vehicle is on them.

A piece is a row of ``COLUMNS`` numbers. A trim flies on at constant speed, climb and turn rate: a
straight line, an arc or a helix. A manoeuvre follows its track, which begins in the origin with
heading 0 and is moved to where the piece begins.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.jit import kernel

MOST_PIECES = 40
"""Pieces that a way can have."""

COLUMNS = 10
"""Numbers in a piece."""

# columns of a piece
KIND, DURATION, X, Y, Z, HEADING, SPEED, CLIMB, TURN, NUMBER = range(COLUMNS)

TRIM, MANOEUVRE = 0.0, 1.0
"""Kinds of pieces."""


class Tracks(NamedTuple):
    """Where the manoeuvres of a library lead, one after the other.

    Attributes:
        first: row where each manoeuvre begins, and the number of rows, shape (m + 1,).
        points: x, y, z [m] and heading [rad], not wrapped, at equal time steps, relative to the
            beginning of the manoeuvre, shape (total, 4).
        fastest: greatest speed between neighbouring points of each [m/s], shape (m,).
        dt: the time step [s].
    """

    first: NDArray[np.int64]
    points: NDArray[np.float64]
    fastest: NDArray[np.float64]
    dt: float


def joined_tracks(parts: Sequence[NDArray[Any]], dt: float) -> Tracks:
    """``Tracks`` of manoeuvres whose points (n + 1, 4), n >= 1, are given one by one; read-only."""
    first = np.cumsum([0, *(len(points) for points in parts)], dtype=np.int64)
    together = np.concatenate([np.empty((0, 4)), *parts])
    steps = (np.diff(points[:, :3], axis=0) for points in parts)
    fastest = np.array([np.sqrt((step * step).sum(axis=1).max()) / dt for step in steps])
    for array in (first, together, fastest):
        array.setflags(write=False)
    return Tracks(first, together, fastest, float(dt))


@kernel
def position_at(row, tracks, t):
    """Position [m] and heading [rad] on a piece, t seconds after it began.

    A trim's horizontal displacement is a chord: ``V t sin(u) / u`` in the direction heading + u,
    ``u = turn t / 2``, which is as good for small rates as for none. Between the points of a track
    the vehicle moves straight: 0.5 mm beside the curve at an acceleration of 1 g, and never faster
    than ``Tracks.fastest``.
    """
    heading = row[HEADING]
    if row[KIND] == TRIM:
        u = 0.5 * row[TURN] * t
        chord = row[SPEED] * t
        if abs(u) > 1e-4:
            chord *= math.sin(u) / u
        else:
            chord *= 1.0 - u * u / 6.0
        x = row[X] + chord * math.cos(heading + u)
        y = row[Y] + chord * math.sin(heading + u)
        return x, y, row[Z] + row[CLIMB] * t, heading + 2.0 * u
    k = int(row[NUMBER])
    begin, last = tracks.first[k], tracks.first[k + 1] - 1
    steps = t / tracks.dt
    i = min(begin + int(steps), last - 1)
    s = min(steps - (i - begin), 1.0)
    p = tracks.points
    right = p[i, 0] + s * (p[i + 1, 0] - p[i, 0])
    left = p[i, 1] + s * (p[i + 1, 1] - p[i, 1])
    up = p[i, 2] + s * (p[i + 1, 2] - p[i, 2])
    turned = p[i, 3] + s * (p[i + 1, 3] - p[i, 3])
    c, q = math.cos(heading), math.sin(heading)
    return (
        row[X] + c * right - q * left,
        row[Y] + q * right + c * left,
        row[Z] + up,
        heading + turned,
    )


@kernel
def fastest_on(row, tracks):
    """Greatest speed on a piece [m/s]."""
    if row[KIND] == TRIM:
        return math.sqrt(row[SPEED] * row[SPEED] + row[CLIMB] * row[CLIMB])
    return tracks.fastest[int(row[NUMBER])]
