"""How near a point in uniform straight motion can come to an obstacle, between two instants.

Within a row the point's path in the obstacle's frame is straight but for the turning, and the
distance to a convex body is a convex function of the place: it lies above its tangents at both
ends. Turning by an angle ``w h`` in h seconds bends the path away from its chord by no more than ::

    (2 w h |v| h + (w h)^2 r) / 8

with v the relative velocity of the frame's origin and r the greatest distance from it. Apart from
that d changes by no more than the points of the obstacle move: ``|v| h + w h reach``.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.moving import CENTRE, CORNER, HALF, ROUND, from_obstacle

END = 8
"""Numbers of an end of a piece: time, distance, place in the obstacle's frame, gradient there."""


@kernel
def end_at(tracks, j, k, t, x, y, z):
    """An end of a piece: time t in row k, the point at (x, y, z) in the world."""
    px, py, pz = from_obstacle(tracks, k, t, x, y, z)
    sizes = tracks.sizes
    x, y, z = px - sizes[j, CENTRE], py - sizes[j, CENTRE + 1], pz - sizes[j, CENTRE + 2]
    ox, oy, oz = abs(x) - sizes[j, HALF], abs(y) - sizes[j, HALF + 1], abs(z) - sizes[j, HALF + 2]
    inward = max(ox, oy, oz)
    gx, gy, gz = max(ox, 0.0), max(oy, 0.0), max(oz, 0.0)
    d = math.sqrt(gx * gx + gy * gy + gz * gz)
    if d > 0.0:
        gx, gy, gz = gx / d, gy / d, gz / d
    else:
        d = inward
        gx = 1.0 if ox == inward else 0.0
        gy = 1.0 if oy == inward and gx == 0.0 else 0.0
        gz = 1.0 - gx - gy
    return (
        t,
        d - sizes[j, ROUND],
        px,
        py,
        pz,
        math.copysign(gx, x),
        math.copysign(gy, y),
        math.copysign(gz, z),
    )


@kernel
def bend(rate, h, speed, e0, e1):
    """How far the path can be from its chord [m]."""
    angle = rate * h
    if angle == 0.0:
        return 0.0
    r0 = e0[2] * e0[2] + e0[3] * e0[3] + e0[4] * e0[4]
    r1 = e1[2] * e1[2] + e1[3] * e1[3] + e1[4] * e1[4]
    return 0.125 * angle * (2.0 * speed * h + angle * math.sqrt(max(r0, r1)))


@kernel
def travel(tracks, j, k, h, speed):
    """How far any point of the box moves against the moving point in h seconds [m]."""
    return h * (speed + tracks.rates[k] * tracks.sizes[j, CORNER])


@kernel
def lowest(tracks, j, k, speed, e0, e1):
    """A lower bound for d between two ends, and the fraction where it is reached.

    Args:
        tracks: the obstacles.
        j, k: obstacle and row.
        speed: of the point relative to the obstacle's frame [m/s].
        e0, e1: the ends, in order of time.
    """
    ux, uy, uz = e1[2] - e0[2], e1[3] - e0[3], e1[4] - e0[4]
    d0, d1, h = e0[1], e1[1], e1[0] - e0[0]
    leaving = e0[5] * ux + e0[6] * uy + e0[7] * uz
    arriving = e1[5] * ux + e1[6] * uy + e1[7] * uz
    split, bound = 0.5, min(d0, d1)
    if leaving < 0.0 < arriving:
        split = min(max((d0 + arriving - d1) / (arriving - leaving), 0.0), 1.0)
        bound = min(bound, d0 + split * leaving)
    bound -= bend(tracks.rates[k], h, speed, e0, e1)
    return max(bound, 0.5 * (d0 + d1 - travel(tracks, j, k, h, speed))), split


@kernel
def highest(tracks, j, k, speed, e0, e1):
    """An upper bound for d between two ends."""
    d0, d1, h = e0[1], e1[1], e1[0] - e0[0]
    bound = max(d0, d1) + bend(tracks.rates[k], h, speed, e0, e1)
    return min(bound, 0.5 * (d0 + d1 + travel(tracks, j, k, h, speed)))
