"""The quickest way from one vertex to another: turn, straight flight, turn.

Everything is computed in the frame of the first vertex: its position is the origin and its heading
is 0. A turn block that changes the heading by theta moves the vehicle by ``A + e^{i theta} B``.
With p and psi_b the second vertex, a straight flight of length s and heading psi between block 1
and block 2 closes the way if ::

    D = e^{i psi} (s + K),  D = p - e^{i psi_b} B_2 - A_1,  K = A_2 + B_1 = k_r + i k_i
    s = sqrt(|D|^2 - k_i^2) - k_r,  psi = arg D - arg(s + K)

The other root of the square has s + k_r < 0: the blocks alone would lead backwards.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.connect_pieces import write_pieces
from ompl_risk._kernels.connect_tables import (
    A_IM,
    A_RE,
    B_IM,
    B_RE,
    EAST,
    FIXED,
    HEADING,
    LEAST,
    LEAST_TIME,
    LEAST_TURN,
    MOST,
    MOST_HOLD,
    MOST_OPTIONS,
    MOST_TAN,
    NONE,
    NORTH,
    RATE,
    SLOWNESS,
    SPEED_INDEX,
    STILL,
    UP,
    straight_options,
    straight_time,
)
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.pieces import COLUMNS, MOST_PIECES

WHOLE = 2.0 * math.pi
AHEAD = 1e-12
"""Heading changes [rad] that count as none."""


@kernel
def _longest(tables, i, j, work, options, distance):
    """How long a way may take: ``longest_ratio`` straight flights, and turning at both ends."""
    straight = math.inf
    for m in range(options):
        length = max(distance, work[m, LEAST])
        if length <= work[m, MOST]:
            straight = min(straight, work[m, FIXED] + length * work[m, SLOWNESS])
    return tables.longest_ratio * straight + tables.allowance[i] + tables.allowance[j]


@kernel
def held_turn(block, turn):
    """For how long a block holds its turn trim [s] to change the heading by turn, modulo 2 pi.

    inf if that is longer than it may.
    """
    rate = block[RATE]
    more = turn - block[LEAST_TURN] if rate > 0.0 else block[LEAST_TURN] - turn
    more -= WHOLE * math.floor(more / WHOLE)
    hold = 0.0 if more > WHOLE - AHEAD else more / abs(rate)
    return hold if hold <= block[MOST_HOLD] else math.inf


@kernel
def _aligned(tables, i, j, x, y, turn, work, options, found):
    """The best of ``found`` and the ways that lack a turn block at one end or at both."""
    c, s = math.cos(turn), math.sin(turn)
    blocks = tables.blocks.shape[1]
    if abs(turn) <= AHEAD and abs(y) <= STILL:
        time, option = straight_time(work, options, max(x, 0.0) if x > -STILL else x)
        if time <= found[0]:
            found = (time, NONE, NONE, max(x, 0.0), 0.0, option)
    for m in range(blocks):
        block = tables.blocks[j, m]
        aside = work[MOST_OPTIONS + m, 1] - block[A_IM]
        if abs(aside) <= STILL:
            length = work[MOST_OPTIONS + m, 0] - block[A_RE]
            length = max(length, 0.0) if length > -STILL else length
            time, option = straight_time(work, options, length)
            time += block[LEAST_TIME] + held_turn(block, turn)
            if time <= found[0]:
                found = (time, NONE, m, length, 0.0, option)
        block = tables.blocks[i, m]
        east, north = x - block[A_RE], y - block[A_IM]
        aside = c * north - s * east - block[B_IM]
        if abs(aside) <= STILL:
            length = c * east + s * north - block[B_RE]
            length = max(length, 0.0) if length > -STILL else length
            time, option = straight_time(work, options, length)
            time += block[LEAST_TIME] + held_turn(block, turn)
            if time <= found[0]:
                found = (time, m, NONE, length, turn, option)
    return found


@kernel
def _is_too_wide(block, ahead, aside):
    """Whether a block cannot change the heading by atan2(aside, ahead)."""
    most = block[MOST_TAN]
    return most < math.inf and (ahead <= 0.0 or abs(aside) > most * ahead)


@kernel
def search(tables, a, b, work):
    """The quickest way from vertex a to vertex b.

    Ways are compared hard turns first, since these are quick most of the time, and dropped before
    their angles are known if turns of least duration make them too long already.

    Args:
        tables: ConnectTables.
        a: vertex, shape (5,).
        b: vertex, shape (5,).
        work: workspace, shape (MOST_PIECES, COLUMNS); holds the options for the straight flight
            afterwards.

    Returns:
        Duration [s], inf if there is none; blocks at a and b, NONE for no turn; length of the
        straight flight [m]; its heading from that of a [rad]; its option.
    """
    i, j = int(a[SPEED_INDEX]), int(b[SPEED_INDEX])
    c, s = math.cos(a[HEADING]), math.sin(a[HEADING])
    east, north = b[EAST] - a[EAST], b[NORTH] - a[NORTH]
    x, y = c * east + s * north, c * north - s * east
    turn = b[HEADING] - a[HEADING]
    turn -= WHOLE * math.floor(turn / WHOLE + 0.5)
    options = straight_options(tables, i, j, b[UP] - a[UP], work)
    longest = _longest(tables, i, j, work, options, math.sqrt(x * x + y * y))
    c, s = math.cos(turn), math.sin(turn)
    blocks = tables.blocks.shape[1]
    for m in range(blocks):
        block = tables.blocks[j, m]
        work[MOST_OPTIONS + m, 0] = x - (c * block[B_RE] - s * block[B_IM])
        work[MOST_OPTIONS + m, 1] = y - (s * block[B_RE] + c * block[B_IM])
    found = (longest, NONE, NONE, 0.0, 0.0, NONE)
    found = _aligned(tables, i, j, x, y, turn, work, options, found)
    for m in range(blocks):
        one = tables.blocks[i, m]
        for n in range(blocks):
            two = tables.blocks[j, n]
            p, q = work[MOST_OPTIONS + n, 0] - one[A_RE], work[MOST_OPTIONS + n, 1] - one[A_IM]
            k_r, k_i = two[A_RE] + one[B_RE], two[A_IM] + one[B_IM]
            square = p * p + q * q - k_i * k_i
            if square < 0.0:
                continue
            along = math.sqrt(square)
            # psi = arg D - arg(s + K), whose cosine and sine these are up to a factor
            ahead, aside = p * along + q * k_i, q * along - p * k_i
            if _is_too_wide(one, ahead, aside):
                continue
            if _is_too_wide(two, c * ahead + s * aside, s * ahead - c * aside):
                continue
            time, option = straight_time(work, options, along - k_r)
            time += one[LEAST_TIME] + two[LEAST_TIME]
            if time > found[0]:
                continue
            psi = math.atan2(aside, ahead)
            time += held_turn(one, psi) + held_turn(two, turn - psi)
            if time <= found[0]:
                found = (time, m, n, along - k_r, psi, option)
    if found[5] == NONE:
        return math.inf, NONE, NONE, 0.0, 0.0, NONE
    return found


@kernel
def connect(tables, a, b, pieces):
    """Write the pieces of the quickest way from vertex a to vertex b.

    Args:
        tables: ConnectTables.
        a: vertex, shape (5,).
        b: vertex, shape (5,).
        pieces: shape (MOST_PIECES, COLUMNS); what it held before is lost.

    Returns:
        How many pieces there are, and the duration [s]: inf if there is no way.
    """
    time, one, two, length, psi, option = search(tables, a, b, pieces)
    if option == NONE:
        return 0, math.inf
    turn = b[HEADING] - a[HEADING] - psi
    first = held_turn(tables.blocks[int(a[SPEED_INDEX]), one], psi) if one != NONE else 0.0
    last = held_turn(tables.blocks[int(b[SPEED_INDEX]), two], turn) if two != NONE else 0.0
    return write_pieces(tables, a, b, pieces, one, first, length, option, two, last), time


@entry
def connection(tables, a, b, pieces):
    """``connect``, for Python."""
    return connect(tables, a, b, pieces)


@entry
def connection_durations(tables, a, b, out):
    """Durations [s] of the ways from a[k] to b[k], inf where there is none; shapes (n, 5), (n,)."""
    work = np.empty((MOST_PIECES, COLUMNS))
    for k in range(len(a)):
        out[k] = search(tables, a[k], b[k], work)[0]
