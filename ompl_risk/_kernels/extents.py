"""Where pieces reach to, and whether they stay on the map, whose edge no clearance announces."""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.pieces import (
    DURATION,
    HEADING,
    KIND,
    NUMBER,
    TRIM,
    TURN,
    X,
    Y,
    Z,
    fastest_on,
    position_at,
)

QUARTER = 0.5 * math.pi


@kernel
def box_of(field):
    """West, east, south and north edge of the map [m], rounded as ``Terrain.extent``."""
    ny, nx = field.heights.shape
    x0, y0, dx, dy = field.grid[0], field.grid[1], field.grid[2], field.grid[3]
    return x0, x0 + (nx - 1) * dx, y0, y0 + (ny - 1) * dy


@kernel
def stays_within(box, row, tracks):
    """Whether every position of a piece lies in a box (west, east, south, north), edges included.

    Most pieces are so short that the distances of their ends from the edges tell.
    """
    seconds = row[DURATION]
    m0, m1 = _margin(box, row, tracks, 0.0), _margin(box, row, tracks, seconds)
    if not (m0 >= 0.0 and m1 >= 0.0):  # so that NaN lies outside
        return False
    if m0 + m1 >= fastest_on(row, tracks) * seconds:
        return True
    x0, x1, y0, y1, _, _ = extent_of(row, tracks)
    return x0 >= box[0] and x1 <= box[1] and y0 >= box[2] and y1 <= box[3]


@kernel
def _margin(box, row, tracks, t):
    """Distance from the nearest edge of the box [m], negative outside."""
    x, y, _, _ = position_at(row, tracks, t)
    return min(x - box[0], box[1] - x, y - box[2], box[3] - y)


@kernel
def extent_of(row, tracks):
    """Least and greatest x, least and greatest y, least and greatest z of a piece [m]."""
    x, y, z, _ = position_at(row, tracks, 0.0)
    extent = (x, x, y, y, z, z)
    if row[KIND] != TRIM:
        return _track_extent(row, tracks, extent)
    x, y, z, _ = position_at(row, tracks, row[DURATION])
    extent = _widened(extent, x, y, z)
    turn, heading = row[TURN], row[HEADING]
    if turn == 0.0:
        return extent
    # an arc is farthest out where it heads along an axis
    turned = heading + turn * row[DURATION]
    first = math.ceil(min(heading, turned) / QUARTER)
    last = math.floor(max(heading, turned) / QUARTER)
    for k in range(first, min(last, first + 3) + 1):
        x, y, _, _ = position_at(row, tracks, (k * QUARTER - heading) / turn)
        extent = _widened(extent, x, y, z)
    return extent


@kernel
def _track_extent(row, tracks, extent):
    """The same for a manoeuvre: between the points of its track it is straight."""
    k, p = int(row[NUMBER]), tracks.points
    c, s = math.cos(row[HEADING]), math.sin(row[HEADING])
    for i in range(tracks.first[k], tracks.first[k + 1]):
        x = row[X] + c * p[i, 0] - s * p[i, 1]
        y = row[Y] + s * p[i, 0] + c * p[i, 1]
        extent = _widened(extent, x, y, row[Z] + p[i, 2])
    return extent


@kernel
def _widened(extent, x, y, z):
    """The extent of a position more."""
    x0, x1, y0, y1, z0, z1 = extent
    return min(x0, x), max(x1, x), min(y0, y), max(y1, y), min(z0, z), max(z1, z)
