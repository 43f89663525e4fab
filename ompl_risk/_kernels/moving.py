"""Signed distance to balls and boxes that move on known tracks.

An obstacle is a box about a point of its own frame, rounded by a radius: a ball is a box without
extent. Its frame moves in rows: from a row's time on it has the row's velocity and turns at the
row's constant rate, up to the next row's time. The first row, at time -inf, and the last stand
still.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from numpy.typing import NDArray

from ompl_risk._kernels.jit import entry, kernel

HALF, CENTRE, ROUND, REACH, CORNER = 0, 3, 6, 7, 8
"""Places in a row of ``Tracks.sizes``."""
SIZES = 9


class Tracks(NamedTuple):
    """Obstacles 0 to m - 1 and how they move.

    Attributes:
        first: first row of each obstacle, then the number of rows, shape (m + 1,).
        times: when a row begins [s], shape (rows,).
        places: position of the frame then [m], shape (rows, 3).
        turned: orientation then, quaternion (x, y, z, w) from body to world, shape (rows, 4).
        velocities: [m/s], shape (rows, 3).
        axes: unit axis of the turning in the body's frame, shape (rows, 3).
        rates: rate of turning [rad/s], shape (rows,).
        sizes: half extents and centre of the box in the body's frame, its rounding, and how far
            the body and the box reach from the frame's origin, without the rounding [m], shape
            (m, SIZES). The box is the body, or for a mesh the one about it.
        swept: box that holds the obstacle at all times, least and greatest corner [m], (m, 6).
    """

    first: NDArray
    times: NDArray
    places: NDArray
    turned: NDArray
    velocities: NDArray
    axes: NDArray
    rates: NDArray
    sizes: NDArray
    swept: NDArray


@kernel
def row_at(tracks, j, t):
    """The row of obstacle j that is in force at time t."""
    low, high = tracks.first[j], tracks.first[j + 1]
    while high - low > 1:
        middle = (low + high) // 2
        if tracks.times[middle] <= t:
            low = middle
        else:
            high = middle
    return low


@kernel
def row_end(tracks, j, k):
    """When row k of obstacle j ends [s]."""
    return tracks.times[k + 1] if k + 1 < tracks.first[j + 1] else math.inf


@kernel
def from_obstacle(tracks, k, t, x, y, z):
    """A point of the world at time t, in the frame of row k's obstacle [m]."""
    begun = tracks.times[k]
    since = t - begun if begun > -math.inf else 0.0
    rx = x - (tracks.places[k, 0] + since * tracks.velocities[k, 0])
    ry = y - (tracks.places[k, 1] + since * tracks.velocities[k, 1])
    rz = z - (tracks.places[k, 2] + since * tracks.velocities[k, 2])
    q1, q2, q3, q4 = (
        tracks.turned[k, 0],
        tracks.turned[k, 1],
        tracks.turned[k, 2],
        tracks.turned[k, 3],
    )
    if tracks.rates[k] > 0.0:
        angle = 0.5 * since * tracks.rates[k]
        s, c = math.sin(angle), math.cos(angle)
        a1, a2, a3 = s * tracks.axes[k, 0], s * tracks.axes[k, 1], s * tracks.axes[k, 2]
        q1, q2, q3, q4 = (
            q4 * a1 + q1 * c + q2 * a3 - q3 * a2,
            q4 * a2 - q1 * a3 + q2 * c + q3 * a1,
            q4 * a3 + q1 * a2 - q2 * a1 + q3 * c,
            q4 * c - q1 * a1 - q2 * a2 - q3 * a3,
        )
    # R^T r = r + 2 v x (v x r - w r), v the vector part, w the scalar part
    cx = q2 * rz - q3 * ry - q4 * rx
    cy = q3 * rx - q1 * rz - q4 * ry
    cz = q1 * ry - q2 * rx - q4 * rz
    return (
        rx + 2.0 * (q2 * cz - q3 * cy),
        ry + 2.0 * (q3 * cx - q1 * cz),
        rz + 2.0 * (q1 * cy - q2 * cx),
    )


@kernel
def box_distance(tracks, j, px, py, pz):
    """Signed distance [m] of a point of its frame to obstacle j."""
    sizes = tracks.sizes
    x = abs(px - sizes[j, CENTRE]) - sizes[j, HALF]
    y = abs(py - sizes[j, CENTRE + 1]) - sizes[j, HALF + 1]
    z = abs(pz - sizes[j, CENTRE + 2]) - sizes[j, HALF + 2]
    inward = min(max(x, y, z), 0.0)
    x, y, z = max(x, 0.0), max(y, 0.0), max(z, 0.0)
    return math.sqrt(x * x + y * y + z * z) + inward - sizes[j, ROUND]


@kernel
def distance(tracks, j, t, x, y, z):
    """Signed distance [m] of a point of the world to obstacle j at time t."""
    k = row_at(tracks, j, t)
    px, py, pz = from_obstacle(tracks, k, t, x, y, z)
    return box_distance(tracks, j, px, py, pz)


@entry
def least_distances(tracks, first, last, points, times, least, which):
    """``least[i]`` = least distance of point i to obstacles first to last - 1, if below it now.

    ``which[i]`` becomes the obstacle then.
    """
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        for j in range(first, last):
            d = distance(tracks, j, times[i], x, y, z)
            if d < least[i]:
                least[i], which[i] = d, j


@entry
def are_near(tracks, j, points, times, limits, out):
    """``out[i]`` = whether point i is nearer to the box of obstacle j than ``limits[i]``."""
    for i in range(len(points)):
        d = distance(tracks, j, times[i], points[i, 0], points[i, 1], points[i, 2])
        out[i] = d < limits[i]


@entry
def to_obstacle(tracks, j, points, times, out):
    """``out[i]`` = point i in the frame of obstacle j at its time [m]."""
    for i in range(len(points)):
        k = row_at(tracks, j, times[i])
        out[i, 0], out[i, 1], out[i, 2] = from_obstacle(
            tracks, k, times[i], points[i, 0], points[i, 1], points[i, 2]
        )


@entry
def greatest_speeds(tracks, begin, end, out):
    """``out[i]`` = greatest speed of any point of any obstacle from begin[i] to end[i] [m/s]."""
    for i in range(len(begin)):
        out[i] = 0.0
        for j in range(len(tracks.first) - 1):
            k = row_at(tracks, j, begin[i])
            while True:
                v = tracks.velocities[k]
                speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
                speed += tracks.rates[k] * tracks.sizes[j, REACH]
                out[i] = max(out[i], speed)
                k += 1
                if k == tracks.first[j + 1] or tracks.times[k] >= end[i]:
                    break
