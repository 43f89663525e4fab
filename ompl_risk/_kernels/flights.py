"""Many ways made of pieces at a time; see ``flight`` for what is computed.

Pieces of n ways have the shape (n, MOST_PIECES, COLUMNS); ``counts[k]`` of them are flown, none if
there is no way.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.connect import connect
from ompl_risk._kernels.extents import extent_of, stays_within
from ompl_risk._kernels.flight import Flight, cost_along, is_free_along
from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.motion import DEPTH, bound_between
from ompl_risk._kernels.nearest import workspace
from ompl_risk._kernels.pieces import DURATION, HEADING, KIND, SPEED, TRIM, X, position_at


@entry
def connections(tables, a, b, pieces, counts, durations):
    """The ways from the vertices ``a[k]`` to ``b[k]``, shape (n, 5); durations are inf for none.

    A way that leads nowhere is one piece of no duration.
    """
    for k in range(len(a)):
        counts[k], durations[k] = connect(tables, a[k], b[k], pieces[k])
        if counts[k] == 0 and durations[k] < math.inf:
            row = pieces[k, 0]
            row[:] = 0.0
            row[KIND] = TRIM
            row[X : HEADING + 1] = a[k, :4]
            counts[k] = 1


@entry
def costs_along(handle, tracks, pieces, counts, given, out):
    """``out[k]`` = cost of the k-th way; inf in collision or without a way."""
    field, (stack, keys), waiting = opened(handle), workspace(), np.empty((DEPTH, 2))
    flight = Flight(field, stack, keys, waiting, tracks, given)
    for k in range(len(counts)):
        out[k] = cost_along(flight, pieces[k], counts[k]) if counts[k] > 0 else math.inf


@entry
def are_free_along(handle, tracks, pieces, counts, given, out):
    """``out[k]`` = whether there is a k-th way and every state of it is free."""
    field, (stack, keys), waiting = opened(handle), workspace(), np.empty((DEPTH, 2))
    flight = Flight(field, stack, keys, waiting, tracks, given)
    for k in range(len(counts)):
        out[k] = counts[k] > 0 and is_free_along(flight, pieces[k], counts[k])


@entry
def travel_bounds(travel, d0, d1, given, out):
    """``out[k]`` = lower bound for the cost of ways so long [m] between such clearances [m]."""
    for k in range(len(travel)):
        out[k] = bound_between(travel[k], d0[k], d1[k], given)


@entry
def extents_along(tracks, pieces, counts, low, high):
    """Widen ``low[k]`` and ``high[k]`` [m], shapes (n, 3), until the box holds the k-th way."""
    for k in range(len(counts)):
        for i in range(counts[k]):
            x0, x1, y0, y1, z0, z1 = extent_of(pieces[k, i], tracks)
            low[k, 0], high[k, 0] = min(low[k, 0], x0), max(high[k, 0], x1)
            low[k, 1], high[k, 1] = min(low[k, 1], y0), max(high[k, 1], y1)
            low[k, 2], high[k, 2] = min(low[k, 2], z0), max(high[k, 2], z1)


@entry
def are_within(box, tracks, rows, out):
    """``out[k]`` = whether the piece ``rows[k]`` stays within west, east, south and north."""
    edges = (box[0], box[1], box[2], box[3])
    for k in range(len(rows)):
        out[k] = stays_within(edges, rows[k], tracks)


@entry
def positions_on(tracks, rows, which, t, out):
    """``out[k]`` = position [m] on the piece ``rows[which[k]]``, ``t[k]`` s after it began."""
    for k in range(len(t)):
        out[k, 0], out[k, 1], out[k, 2], _ = position_at(rows[which[k]], tracks, t[k])


@kernel
def _speed_on(row, tracks, t):
    """Horizontal speed on a piece [m/s]."""
    if row[KIND] == TRIM:
        return row[SPEED]
    h = min(tracks.dt, row[DURATION])
    t0 = min(max(t - 0.5 * h, 0.0), row[DURATION] - h)
    x0, y0, _, _ = position_at(row, tracks, t0)
    x1, y1, _, _ = position_at(row, tracks, t0 + h)
    return math.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2) / h


@kernel
def _index_of(speeds, speed):
    """Place of a speed among increasing ones, a fraction in between."""
    if speed <= speeds[0]:
        return 0.0
    for k in range(1, len(speeds)):
        if speed < speeds[k]:
            return k - (speeds[k] - speed) / (speeds[k] - speeds[k - 1])
    return len(speeds) - 1.0


@entry
def samples_along(tracks, speeds, pieces, count, step, out):
    """``out[i]`` = x, y, z [m], heading [rad] and index of the speed, i steps [s] from the start.

    Rows beyond the end of the way are those of its end.
    """
    i, t = 0, 0.0
    for k in range(len(out)):
        while i < count - 1 and k * step - t > pieces[i, DURATION]:
            t += pieces[i, DURATION]
            i += 1
        row = pieces[i]
        since = min(k * step - t, row[DURATION])
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = position_at(row, tracks, since)
        out[k, 4] = _index_of(speeds, _speed_on(row, tracks, since))
