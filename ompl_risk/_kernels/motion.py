"""Collision check and risk of a straight motion at constant speed over a height field.

Both rest on one fact: d changes along the motion by at most the distance travelled. Between two
samples h apart with clearances d0 and d1 it therefore stays above ``(d0 + d1 - h) / 2``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import carray  # pyright: ignore[reportPrivateImportUsage]
from numpy.typing import NDArray

from ompl_risk._kernels.height_field import HeightField, opened
from ompl_risk._kernels.integrand import FAR, STEADY, avoid, least_integral
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import STACK, inside, signed_distance
from ompl_risk._kernels.pointers import float64_at, int64_at
from ompl_risk._kernels.shares import (
    COARSE,
    PARAMETERS,
    POWER,
    RADIUS,
    SPEED,
    TAU,
    TOLERANCE,
    WEIGHT,
    settled,
)

CONTACT = 1e-3
"""Clearance [m] below which a motion counts as touching: keeps the number of steps finite."""

FIRST = 0.382
"""Where a motion is split before the halving begins: at no simple fraction, so that samples do not
keep step with regular ground."""

NEAR = 0.01
"""Clearance below which the maximum of f = 1/d is found to an absolute accuracy, in units of d0:
level flight a hand's breadth over flat ground would else take millions of samples."""

DEPTH = 96
"""Pieces that can wait while their left neighbours are halved."""


class Motion(NamedTuple):
    """A motion and all that its evaluation needs.

    Attributes:
        field: the terrain.
        stack, keys: work space of a distance query.
        pieces: work space for halving, shape (DEPTH, 2).
        a, b: states whose first three numbers are the position [m].
        given: the parameters.
    """

    field: HeightField
    stack: NDArray[np.int64]
    keys: NDArray[np.float64]
    pieces: NDArray[np.float64]
    a: NDArray[np.float64]
    b: NDArray[np.float64]
    given: NDArray[np.float64]


@entry
def opened_motion(handle):
    """The motion behind a handle: that of the field, then addresses in ``Motion``'s order."""
    return Motion(
        opened(handle),
        carray(int64_at(handle[8]), (STACK, 3)),
        carray(float64_at(handle[9]), (STACK,)),
        carray(float64_at(handle[10]), (DEPTH, 2)),
        carray(float64_at(handle[11]), (3,)),
        carray(float64_at(handle[12]), (3,)),
        carray(float64_at(handle[13]), (PARAMETERS,)),
    )


@kernel
def clearance_at(motion, bound, x, y, z):
    """Clearance d [m] at a position, at most ``bound``; ``motion`` may be a ``Flight``."""
    radius = motion.given[RADIUS]
    d = signed_distance(motion.field, x, y, z, bound + radius, motion.stack, motion.keys)
    return d - radius


@entry
def clearance(handle):
    """Clearance d [m] at state a."""
    motion = opened_motion(handle)
    return clearance_at(motion, math.inf, motion.a[0], motion.a[1], motion.a[2])


@entry
def is_free(handle):
    """Whether state a is free: d > 0."""
    motion = opened_motion(handle)
    return clearance_at(motion, CONTACT, motion.a[0], motion.a[1], motion.a[2]) > 0.0


@entry
def is_motion_free(handle):
    """Whether every state of the straight motion from a to b is free, for certain."""
    return is_free_between(opened_motion(handle))


@kernel
def is_free_between(motion):
    """March along the motion by the clearance, which nothing can be nearer than."""
    a, b = motion.a, motion.b
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    length = math.sqrt(ux * ux + uy * uy + uz * uz)
    if not inside(motion.field, b[0], b[1]):
        return False
    s = 0.0
    while True:
        t = s / length if length > 0.0 else 0.0
        x, y, z = a[0] + t * ux, a[1] + t * uy, a[2] + t * uz
        d = clearance_at(motion, length - s + 2.0 * CONTACT, x, y, z)
        if d <= CONTACT:
            return False
        s += d - 0.5 * CONTACT
        if s >= length:
            return clearance_at(motion, 2.0 * CONTACT, b[0], b[1], b[2]) > CONTACT


@entry
def motion_cost(handle):
    """Risk of the motion from a to b plus weight times duration; inf in collision.

    The risk is the p-th power of the norm, or for p = inf the maximum of f.
    """
    return cost_between(opened_motion(handle))


@kernel
def cost_between(motion):
    """See ``motion_cost``."""
    a, b, given = motion.a, motion.b, motion.given
    length = math.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)
    if math.isinf(given[POWER]):
        return _motion_maximum(motion, length)
    return _motion_power(motion, length) + given[WEIGHT] * length / given[SPEED]


@kernel
def _motion_power(motion, length):
    """Integral of f^p + tau^2 f'^2 along the motion by adaptive halving.

    A piece is accepted once halving it changes its share by less than the tolerance; the
    difference also extrapolates it. Ripples of f that are short against the clearance can be
    missed, not so collisions.
    """
    a, b, given, pieces = motion.a, motion.b, motion.given, motion.pieces
    speed, far = given[SPEED], given[FAR]
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    bound = far + length
    d0 = clearance_at(motion, bound, a[0], a[1], a[2])
    d1 = clearance_at(motion, bound, b[0], b[1], b[2])
    if d0 <= CONTACT or d1 <= CONTACT:
        return math.inf
    s0, total = 0.0, 0.0
    pieces[0, 0], pieces[0, 1] = length, d1
    x, y, z = a[0] + FIRST * ux, a[1] + FIRST * uy, a[2] + FIRST * uz
    pieces[1, 0], pieces[1, 1] = FIRST * length, clearance_at(motion, bound, x, y, z)
    if pieces[1, 1] <= CONTACT:
        return math.inf
    top = 2
    while top > 0:
        s1, d1 = pieces[top - 1, 0], pieces[top - 1, 1]
        h = s1 - s0
        if d0 + d1 - h >= 2.0 * far:
            s0, d0 = s1, d1
            top -= 1
            continue
        s = 0.5 * (s0 + s1)
        t = s / length if length > 0.0 else 0.0
        d = clearance_at(motion, far + h, a[0] + t * ux, a[1] + t * uy, a[2] + t * uz)
        if d <= CONTACT:
            return math.inf
        share = settled(d0, d, d1, h, h / speed, given)
        if share >= 0.0:
            total += share
            s0, d0 = s1, d1
            top -= 1
            continue
        pieces[top, 0], pieces[top, 1] = s, d
        top += 1
    return total


@kernel
def enough(least, given):
    """Clearance [m] above which nothing changes the maximum of f by more than the tolerance.

    Args:
        least: the least clearance that was found [m].
        given: the parameters.
    """
    length = COARSE * given[STEADY] if given[STEADY] > 0.0 else max(least, NEAR * given[FAR])
    return min(max(least - given[TOLERANCE] * length, 0.5 * CONTACT), given[FAR])


@kernel
def _motion_maximum(motion, length):
    """Maximum of f along the motion, to the relative tolerance, never below a sampled value."""
    a, b, given, pieces = motion.a, motion.b, motion.given, motion.pieces
    far = given[FAR]
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    bound = far + length
    d0 = clearance_at(motion, bound, a[0], a[1], a[2])
    d1 = clearance_at(motion, bound, b[0], b[1], b[2])
    least = min(d0, d1)
    s0 = 0.0
    pieces[0, 0], pieces[0, 1] = length, d1
    top = 1
    while top > 0:
        if least <= CONTACT:
            return math.inf
        s1, d1 = pieces[top - 1, 0], pieces[top - 1, 1]
        if 0.5 * (d0 + d1 - (s1 - s0)) >= enough(least, given):
            s0, d0 = s1, d1
            top -= 1
            continue
        t = 0.5 * (s0 + s1) / length
        d = clearance_at(motion, bound, a[0] + t * ux, a[1] + t * uy, a[2] + t * uz)
        least = min(least, d)
        pieces[top, 0], pieces[top, 1] = 0.5 * (s0 + s1), d
        top += 1
    return avoid(least, given)


@entry
def heuristic(handle):
    """Lower bound for the cost of any way from a to b that is no faster than ``speed``.

    However the vehicle flies, d moves away from its values at a and b no faster than the vehicle
    moves. For tau > 0 also ``f^2 + tau^2 f'^2 >= tau |(f^2)'|``.
    """
    motion = opened_motion(handle)
    a, b, given = motion.a, motion.b, motion.given
    far = given[FAR]
    length = math.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)
    d0 = clearance_at(motion, far, a[0], a[1], a[2])
    d1 = clearance_at(motion, far, b[0], b[1], b[2])
    return bound_between(length, d0, d1, given)


@kernel
def bound_between(length, d0, d1, given):
    """The same from the length of the motion and the clearances at its ends [m]."""
    speed, p, tau = given[SPEED], given[POWER], given[TAU]
    least = given[WEIGHT] * length / speed
    if d0 <= CONTACT or d1 <= CONTACT:
        return least
    f0, f1 = avoid(d0, given), avoid(d1, given)
    if math.isinf(p):
        return max(f0, f1)
    split = min(max(0.5 * (length + d1 - d0), 0.0), length)
    power = least_integral(d0, split, p, given) + least_integral(d1, length - split, p, given)
    return least + max(power / speed, tau * abs(f1 * f1 - f0 * f0))
