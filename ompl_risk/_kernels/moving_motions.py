"""Straight timed motions among moving obstacles: least distance, freedom, relative travel.

Every motion is cut where an obstacle's row ends, so that relative motion is uniform, and a piece is
split until its lower bound settles it; see ``moving_pieces``.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.moving import CORNER, REACH, ROUND, row_at, row_end
from ompl_risk._kernels.moving_pieces import END, end_at, lowest

DEPTH = 160
"""Pieces that can wait while their left neighbours are split."""

LEAST_SHARE = 0.3
"""A piece is split no nearer to its ends than this part of it: bounds the depth."""


@kernel
def beyond_sweep(tracks, j, a, b):
    """Lower bound [m] for the distance from the segment a to b to all that obstacle j sweeps.

    -inf where it may be within: how deep is not known.
    """
    total = 0.0
    for axis in range(3):
        low, high = min(a[axis], b[axis]), max(a[axis], b[axis])
        gap = max(tracks.swept[j, axis] - high, low - tracks.swept[j, axis + 3], 0.0)
        total += gap * gap
    return math.sqrt(total) if total > 0.0 else -math.inf


@kernel
def relative(tracks, k, t, x, y, z):
    """Position [m] of a point against the origin of the frame of row k at time t."""
    begun = tracks.times[k]
    since = t - begun if begun > -math.inf else 0.0
    return (
        x - (tracks.places[k, 0] + since * tracks.velocities[k, 0]),
        y - (tracks.places[k, 1] + since * tracks.velocities[k, 1]),
        z - (tracks.places[k, 2] + since * tracks.velocities[k, 2]),
    )


@kernel
def origin_distance(tracks, k, t0, t1, x, y, z, vx, vy, vz):
    """Least distance [m] from the origin of row k's frame, and the relative speed [m/s].

    The point is at (x, y, z) at t0 and has the velocity (vx, vy, vz).
    """
    rx, ry, rz = relative(tracks, k, t0, x, y, z)
    vx, vy, vz = (
        vx - tracks.velocities[k, 0],
        vy - tracks.velocities[k, 1],
        vz - tracks.velocities[k, 2],
    )
    square = vx * vx + vy * vy + vz * vz
    since = 0.0
    if square > 0.0:
        since = min(max(-(rx * vx + ry * vy + rz * vz) / square, 0.0), t1 - t0)
    rx, ry, rz = rx + since * vx, ry + since * vy, rz + since * vz
    return math.sqrt(rx * rx + ry * ry + rz * rz), math.sqrt(square)


@kernel
def piece_least(tracks, j, k, a, v, ta, t0, t1, least, when, floor, tolerance, stack):
    """Least distance of a motion to obstacle j between two instants of its row k.

    Args:
        tracks: the obstacles.
        j, k: obstacle and row.
        a, v, ta: the motion is at ``a + (t - ta) v``.
        t0, t1: the instants.
        least, when: least distance found so far, and its time.
        floor: the search ends where a distance of this or less is found.
        tolerance: how far below ``least`` the distance may be, unnoticed.
        stack: work space, shape (DEPTH, END).

    Returns:
        ``least`` and ``when``, improved.
    """
    x, y, z = a[0] + (t0 - ta) * v[0], a[1] + (t0 - ta) * v[1], a[2] + (t0 - ta) * v[2]
    near, speed = origin_distance(tracks, k, t0, t1, x, y, z, v[0], v[1], v[2])
    if near - tracks.sizes[j, CORNER] - tracks.sizes[j, ROUND] >= least - tolerance:
        return least, when
    e0 = end_at(tracks, j, k, t0, x, y, z)
    if e0[1] < least:
        least, when = e0[1], t0
    x, y, z = a[0] + (t1 - ta) * v[0], a[1] + (t1 - ta) * v[1], a[2] + (t1 - ta) * v[2]
    stack[0] = end_at(tracks, j, k, t1, x, y, z)
    if stack[0, 1] < least:
        least, when = stack[0, 1], t1
    top = 1
    while top > 0 and least > floor:
        e1 = stack[top - 1]
        bound, split = lowest(tracks, j, k, speed, e0, e1)
        t = e0[0] + min(max(split, LEAST_SHARE), 1.0 - LEAST_SHARE) * (e1[0] - e0[0])
        if bound >= least - tolerance or not e0[0] < t < e1[0] or top == len(stack):
            e0 = (e1[0], e1[1], e1[2], e1[3], e1[4], e1[5], e1[6], e1[7])
            top -= 1
            continue
        x, y, z = a[0] + (t - ta) * v[0], a[1] + (t - ta) * v[1], a[2] + (t - ta) * v[2]
        stack[top] = end_at(tracks, j, k, t, x, y, z)
        if stack[top, 1] < least:
            least, when = stack[top, 1], t
        top += 1
    return least, when


@kernel
def motion_least(tracks, j, a, b, ta, tb, least, when, floor, tolerance, v, stack):
    """The same for a whole motion; ``v`` is work space for its velocity, shape (3,)."""
    if beyond_sweep(tracks, j, a, b) >= least - tolerance:
        return least, when
    for axis in range(3):
        v[axis] = (b[axis] - a[axis]) / (tb - ta) if tb > ta else 0.0
    k, t0 = row_at(tracks, j, ta), ta
    while True:
        t1 = min(row_end(tracks, j, k), tb)
        least, when = piece_least(
            tracks, j, k, a, v, ta, t0, t1, least, when, floor, tolerance, stack
        )
        if t1 >= tb or least <= floor:
            return least, when
        k, t0 = k + 1, t1


@entry
def least_between(tracks, last, a, ta, b, tb, tolerance, least, when):
    """``least[i]`` = least distance on the motion i to obstacles 0 to last - 1, if below it now.

    No more than ``tolerance`` too great; ``when[i]`` becomes the time of it then.
    """
    v, stack = np.empty(3), np.empty((DEPTH, END))
    for i in range(len(a)):
        for j in range(last):
            least[i], when[i] = motion_least(
                tracks, j, a[i], b[i], ta[i], tb[i],
                least[i], when[i], -math.inf, tolerance, v, stack,
            )  # fmt: skip


@entry
def are_beyond(tracks, first, last, a, ta, b, tb, limits, slack, out):
    """``out[i]`` = whether motion i stays beyond ``limits[i]`` of obstacles first to last - 1.

    Certain if true; may be false where that is not so of ``limits[i] + slack``. Rows that are false
    already stay so.
    """
    v, stack = np.empty(3), np.empty((DEPTH, END))
    for i in range(len(a)):
        enough = limits[i] + slack
        # From just above `enough` on, half of the slack below it may go unnoticed.
        start = np.nextafter(enough, math.inf)
        for j in range(first, last):
            if not out[i]:
                break
            least, _ = motion_least(
                tracks, j, a[i], b[i], ta[i], tb[i],
                start, ta[i], enough, 0.5 * slack, v, stack,
            )  # fmt: skip
            out[i] = least > enough


@kernel
def nearby_travel(tracks, j, a, b, ta, tb, far):
    """Relative travel of a motion and obstacle j while that may be nearer than ``far`` [m]."""
    total, duration = 0.0, tb - ta
    if beyond_sweep(tracks, j, a, b) >= far:
        return total
    k, t0 = row_at(tracks, j, ta), ta
    while True:
        t1 = min(row_end(tracks, j, k), tb)
        s = (t0 - ta) / duration if duration > 0.0 else 0.0
        scale = 1.0 / duration if duration > 0.0 else 0.0
        ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
        near, speed = origin_distance(
            tracks, k, t0, t1, a[0] + s * ux, a[1] + s * uy, a[2] + s * uz,
            ux * scale, uy * scale, uz * scale,
        )  # fmt: skip
        if near - tracks.sizes[j, REACH] - tracks.sizes[j, ROUND] < far:
            total += (t1 - t0) * (speed + tracks.rates[k] * tracks.sizes[j, REACH])
        if t1 >= tb:
            return total
        k, t0 = k + 1, t1


@entry
def travels(tracks, first, last, a, ta, b, tb, far, out):
    """``out[i]`` rises to the greatest relative travel of motion i and a near obstacle [m]."""
    for i in range(len(a)):
        for j in range(first, last):
            out[i] = max(out[i], nearby_travel(tracks, j, a[i], b[i], ta[i], tb[i], far))


@entry
def relative_travels(tracks, j, a, ta, b, tb, out):
    """Motions as seen from the origin of obstacle j: length, distance of the ends, and turning.

    ``out[:, i]`` = of motion i; the turning is that of the point that reaches farthest [m].
    """
    for i in range(len(a)):
        duration, path, turning = tb[i] - ta[i], 0.0, 0.0
        k, t0 = row_at(tracks, j, ta[i]), ta[i]
        x0, y0, z0 = relative(tracks, k, t0, a[i, 0], a[i, 1], a[i, 2])
        x, y, z = x0, y0, z0
        while True:
            t1 = min(row_end(tracks, j, k), tb[i])
            s = (t1 - ta[i]) / duration if duration > 0.0 else 1.0
            px, py, pz = relative(
                tracks, k, t1, a[i, 0] + s * (b[i, 0] - a[i, 0]),
                a[i, 1] + s * (b[i, 1] - a[i, 1]), a[i, 2] + s * (b[i, 2] - a[i, 2]),
            )  # fmt: skip
            path += math.sqrt((px - x) ** 2 + (py - y) ** 2 + (pz - z) ** 2)
            turning += tracks.rates[k] * (t1 - t0) * tracks.sizes[j, REACH]
            x, y, z = px, py, pz
            if t1 >= tb[i]:
                break
            k, t0 = k + 1, t1
        chord = math.sqrt((x - x0) ** 2 + (y - y0) ** 2 + (z - z0) ** 2)
        out[0, i], out[1, i], out[2, i] = path, chord, turning
