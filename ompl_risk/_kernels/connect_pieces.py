"""The pieces of a way whose turn blocks and straight flight are known."""

from __future__ import annotations

import math

from ompl_risk._kernels.connect_tables import (
    AFTER,
    ASCENT,
    ASCENT_TIME,
    BEFORE,
    BLOCK_COLUMNS,
    CHANGE,
    CLIMB_ENTRY,
    CLIMB_EXIT,
    CLIMB_RATE,
    CRUISE,
    DESCENT,
    DESCENT_TIME,
    EAST,
    LEAST,
    NONE,
    NORTH,
    RATE,
    SPEED_INDEX,
    UP,
)
from ompl_risk._kernels.connect_tables import HEADING as VERTEX_HEADING
from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.pieces import (
    CLIMB,
    DURATION,
    HEADING,
    KIND,
    MANOEUVRE,
    NUMBER,
    SPEED,
    TRIM,
    TURN,
    X,
    Y,
    Z,
)

SHORTEST = 1e-12
"""Trims of less duration [s] are left out."""


@kernel
def _begin(row, pose, kind, duration):
    """Make a row a piece from a pose x, y, z, heading on."""
    row[:] = 0.0
    row[KIND], row[DURATION], row[NUMBER] = kind, duration, NONE
    row[X], row[Y], row[Z], row[HEADING] = pose


@kernel
def put_trim(pieces, count, pose, speed, climb, turn, duration):
    """Hold a trim; the number of pieces and the pose after it."""
    if duration < SHORTEST:
        return count, pose
    row = pieces[count]
    _begin(row, pose, TRIM, duration)
    row[SPEED], row[CLIMB], row[TURN] = speed, climb, turn
    x, y, z, heading = pose
    half = 0.5 * turn * duration
    chord = speed * duration
    if half != 0.0:
        chord *= math.sin(half) / half
    x += chord * math.cos(heading + half)
    y += chord * math.sin(heading + half)
    return count + 1, (x, y, z + climb * duration, heading + 2.0 * half)


@kernel
def put_manoeuvre(tables, pieces, count, pose, number):
    """Fly a manoeuvre, NONE for none; the number of pieces and the pose after it."""
    if number == NONE:
        return count, pose
    row = pieces[count]
    _begin(row, pose, MANOEUVRE, tables.durations[int(number)])
    row[NUMBER] = number
    x, y, z, heading = pose
    c, s = math.cos(heading), math.sin(heading)
    end = tables.ends[int(number)]
    x += c * end[0] - s * end[1]
    y += s * end[0] + c * end[1]
    return count + 1, (x, y, z + end[2], heading + end[3])


@kernel
def _put_turn(tables, pieces, count, pose, k, m, hold):
    """A turn block, its trim held so long; m may be NONE."""
    if m == NONE:
        return count, pose
    block = tables.blocks[k, m]
    for column in range(BEFORE, AFTER):
        count, pose = put_manoeuvre(tables, pieces, count, pose, block[column])
    count, pose = put_trim(pieces, count, pose, tables.speeds[k], 0.0, block[RATE], hold)
    for column in range(AFTER, BLOCK_COLUMNS):
        count, pose = put_manoeuvre(tables, pieces, count, pose, block[column])
    return count, pose


@kernel
def _put_climb(tables, pieces, count, pose, k, way, level, hold):
    """An ascent (way 0) or a descent (1), its trim held so long; level may be NONE."""
    if level == NONE:
        return count, pose
    climb = tables.climbs[k, way, int(level)]
    speed = tables.speeds[k]
    count, pose = put_manoeuvre(tables, pieces, count, pose, climb[CLIMB_ENTRY])
    count, pose = put_trim(pieces, count, pose, speed, climb[CLIMB_RATE], 0.0, hold)
    return put_manoeuvre(tables, pieces, count, pose, climb[CLIMB_EXIT])


@kernel
def write_pieces(tables, a, b, pieces, one, first, length, option, two, last):
    """Write a way: how many pieces it has.

    An ascent comes as soon as the cruise speed is reached, a descent as late as possible: the
    vehicle stays high in between, away from the ground.

    Args:
        tables: ConnectTables.
        a: vertex, shape (5,).
        b: vertex, shape (5,).
        pieces: holds the options for the straight flight, and is overwritten.
        one: turn block at a, held for ``first`` [s].
        first: see one.
        length: of the straight flight [m].
        option: row of the straight flight.
        two: turn block at b, held for ``last`` [s].
        last: see two.
    """
    chosen = pieces[option]
    k = int(chosen[CRUISE])
    ascent, ascent_time = chosen[ASCENT], chosen[ASCENT_TIME]
    descent, descent_time = chosen[DESCENT], chosen[DESCENT_TIME]
    speed = tables.speeds[k]
    level = (length - chosen[LEAST]) / speed if speed > 0.0 else 0.0
    i, j = int(a[SPEED_INDEX]), int(b[SPEED_INDEX])
    pose = (a[EAST], a[NORTH], a[UP], a[VERTEX_HEADING])
    count, pose = _put_turn(tables, pieces, 0, pose, i, one, first)
    count, pose = put_manoeuvre(tables, pieces, count, pose, tables.changes[i, k, CHANGE])
    count, pose = _put_climb(tables, pieces, count, pose, k, 0, ascent, ascent_time)
    count, pose = put_trim(pieces, count, pose, speed, 0.0, 0.0, level)
    count, pose = _put_climb(tables, pieces, count, pose, k, 1, descent, descent_time)
    count, pose = put_manoeuvre(tables, pieces, count, pose, tables.changes[k, j, CHANGE])
    count, pose = _put_turn(tables, pieces, count, pose, j, two, last)
    return count
