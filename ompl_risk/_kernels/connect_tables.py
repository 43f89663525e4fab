"""What the quickest connections are computed from: turn blocks, climbs and changes of speed."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.jit import kernel

# columns of a vertex
EAST, NORTH, UP, HEADING, SPEED_INDEX = range(5)

# columns of a turn block: A, B, heading change and duration if the turn trim is not held at all,
# turn rate, the longest time that it may be held, the tangent of the greatest heading change
# (inf: any), and the manoeuvres before and after the trim, NONE for none
A_RE, A_IM, B_RE, B_IM, LEAST_TURN, LEAST_TIME, RATE, MOST_HOLD, MOST_TAN = range(9)
BEFORE, AFTER, BLOCK_COLUMNS = 9, 12, 15

# columns of a climb: the climb rate, and length, height, duration of both manoeuvres together
CLIMB_RATE, CLIMB_LENGTH, CLIMB_HEIGHT, CLIMB_TIME, CLIMB_ENTRY, CLIMB_EXIT = range(6)
CLIMB_COLUMNS = 6

# columns of a change of speed
CHANGE_LENGTH, CHANGE_TIME, CHANGE = range(3)

# columns of an option for the straight flight: it takes FIXED + length * SLOWNESS seconds if its
# length is in [LEAST, MOST], at the speed of that index, with these climbs held for these times
LEAST, MOST, FIXED, SLOWNESS, CRUISE, ASCENT, ASCENT_TIME, DESCENT, DESCENT_TIME, ENDS = range(10)

MOST_OPTIONS = 16
"""Options for the straight flight that the workspace has room for."""
STILL = 1e-10
"""Lengths [m] and heights that count as none."""
NONE = -1


class ConnectTables(NamedTuple):
    """What the kernels look up, for a library of trims and manoeuvres.

    Blocks, changes and climbs that a library does not have take an infinite time.

    Attributes:
        speeds: horizontal speeds that vertices can have [m/s], shape (n,).
        blocks: turn blocks at each speed, gentler ones last and those for any heading change
            first, shape (n, k, BLOCK_COLUMNS).
        changes: length [m], duration [s] and manoeuvre of the change from one
            speed to another, shape (n, n, 3).
        climbs: ascents (0) and descents (1) at each speed, gentler ones first, shape
            (n, 2, j, CLIMB_COLUMNS).
        cruise: indices of the speeds of straight flights, fastest first, shape (m,).
        ends: displacement x, y, z [m] and heading [rad] of each manoeuvre, shape (q, 4).
        durations: of each manoeuvre [s], shape (q,).
        allowance: what turning may take beyond the ratio at each speed [s], shape (n,).
        longest_ratio: a way may take so many times as long as straight flight.
    """

    speeds: NDArray[np.float64]
    blocks: NDArray[np.float64]
    changes: NDArray[np.float64]
    climbs: NDArray[np.float64]
    cruise: NDArray[np.int64]
    ends: NDArray[np.float64]
    durations: NDArray[np.float64]
    allowance: NDArray[np.float64]
    longest_ratio: float


@kernel
def _profile(tables, k, rise, level, row):
    """Climb and descent in an option: length, duration beyond that of level flight, or inf."""
    row[ASCENT] = row[DESCENT] = NONE
    row[ASCENT_TIME] = row[DESCENT_TIME] = 0.0
    if abs(rise) <= STILL:
        return 0.0, 0.0
    way = 0 if rise > 0.0 else 1
    climb = tables.climbs[k, way, level]
    speed = tables.speeds[k]
    rest = rise - climb[CLIMB_HEIGHT]
    length, time = climb[CLIMB_LENGTH], climb[CLIMB_TIME]
    if rest * rise >= 0.0:
        hold = rest / climb[CLIMB_RATE]
        row[ASCENT + 2 * way], row[ASCENT_TIME + 2 * way] = level, hold
        length += speed * hold
        time += hold
    elif level == 0:  # less than the two manoeuvres climb: up and down again
        back = tables.climbs[k, 1 - way, 0]
        rest -= back[CLIMB_HEIGHT]
        more = way if rest * rise >= 0.0 else 1 - way
        hold = rest / tables.climbs[k, more, 0, CLIMB_RATE]
        row[ASCENT] = row[DESCENT] = 0.0
        row[ASCENT_TIME + 2 * more] = hold
        length += back[CLIMB_LENGTH] + speed * hold
        time += back[CLIMB_TIME] + hold
    else:
        return 0.0, math.inf
    return length, time if speed == 0.0 else time - length / speed


@kernel
def straight_options(tables, i, j, rise, work):
    """Write into the first rows of ``work`` how to fly straight from one speed to another.

    Options of the same cruise speed follow each other, the gentler climb first.

    Returns:
        How many there are.
    """
    count = 0
    steepest = tables.climbs.shape[2] if abs(rise) > STILL else 1
    for m in range(len(tables.cruise)):
        k = tables.cruise[m]
        speed = tables.speeds[k]
        if speed == 0.0 and not (i == k and j == k):
            continue
        first, last = tables.changes[i, k], tables.changes[k, j]
        time = first[CHANGE_TIME] + last[CHANGE_TIME]
        ends = first[CHANGE_LENGTH] + last[CHANGE_LENGTH]
        for level in range(steepest):
            row = work[count]
            length, extra = _profile(tables, k, rise, level, row)
            if time + extra == math.inf:
                continue
            row[LEAST], row[CRUISE], row[ENDS] = ends + length, k, ends
            if speed == 0.0:
                row[MOST], row[FIXED], row[SLOWNESS] = STILL, extra, 0.0
            else:
                row[MOST], row[SLOWNESS] = math.inf, 1.0 / speed
                row[FIXED] = time + extra - ends / speed
            count += 1
    return count


@kernel
def straight_time(work, options, s):
    """Least duration of a straight flight of length s and its option; inf if there is none."""
    best, chosen, fitted = math.inf, NONE, -1.0
    for m in range(options):
        row = work[m]
        # of one cruise speed the gentlest climb that fits
        if row[CRUISE] != fitted and row[LEAST] <= s <= row[MOST]:
            fitted = row[CRUISE]
            time = row[FIXED] + s * row[SLOWNESS]
            if time < best:
                best, chosen = time, m
    return best, chosen
