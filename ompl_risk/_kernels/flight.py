"""Collision check and risk of ways made of pieces over a height field.

As for straight motions: d changes by at most the distance travelled. On a piece that is never
faster than v, d stays above ``(d0 + d1 - v h) / 2`` between two times h apart. The map's edge is
no obstacle that d knows of, so whether a piece stays on the map is found out separately.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.extents import box_of, stays_within
from ompl_risk._kernels.height_field import HeightField
from ompl_risk._kernels.integrand import FAR, avoid, reach
from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.motion import CONTACT, FIRST, clearance_at, enough
from ompl_risk._kernels.pieces import DURATION, Tracks, fastest_on, position_at
from ompl_risk._kernels.shares import COARSE, POWER, WEIGHT, settled


class Flight(NamedTuple):
    """All that evaluating a way needs besides its pieces.

    Attributes:
        field: the terrain.
        stack, keys: work space of a distance query.
        waiting: work space for halving, shape (DEPTH, 2).
        tracks: where manoeuvres lead.
        given: the parameters, as for a straight motion.
    """

    field: HeightField
    stack: NDArray[np.int64]
    keys: NDArray[np.float64]
    waiting: NDArray[np.float64]
    tracks: Tracks
    given: NDArray[np.float64]


@kernel
def _clearance_on(flight, row, t, bound):
    """Clearance [m], at most ``bound``, t seconds after a piece began."""
    x, y, z, _ = position_at(row, flight.tracks, t)
    return clearance_at(flight, bound, x, y, z)


@kernel
def _longest(flight, pieces, count):
    """How far the vehicle can move on any one piece, and on all of them [m]."""
    most, total = 0.0, 0.0
    for i in range(count):
        travel = fastest_on(pieces[i], flight.tracks) * pieces[i, DURATION]
        most = max(most, travel)
        total += travel
    return most, total


@kernel
def cost_along(flight, pieces, count):
    """Risk of a way of ``count`` pieces plus weight times duration; inf in collision.

    The risk is the p-th power of the norm, or for p = inf the maximum of f.
    """
    if math.isinf(flight.given[POWER]):
        return _maximum_along(flight, pieces, count)
    seconds = 0.0
    for i in range(count):
        seconds += pieces[i, DURATION]
    return _power_along(flight, pieces, count) + flight.given[WEIGHT] * seconds


@kernel
def _power_along(flight, pieces, count):
    """Integral of f^p + tau^2 f'^2 along a way by adaptive halving; inf in collision."""
    most, _ = _longest(flight, pieces, count)
    bound = flight.given[FAR] + most
    box = box_of(flight.field)
    d0, total = _clearance_on(flight, pieces[0], 0.0, bound), 0.0
    for i in range(count):
        row = pieces[i]
        d1 = _clearance_on(flight, row, row[DURATION], bound)
        if d0 <= CONTACT or d1 <= CONTACT or not stays_within(box, row, flight.tracks):
            return math.inf
        total += _power_on(flight, row, d0, d1)
        d0 = d1
    return total


@kernel
def _power_on(flight, row, d0, d1):
    """The share of one piece, from the clearances at its ends."""
    given, waiting = flight.given, flight.waiting
    far, v = given[FAR], fastest_on(row, flight.tracks)
    t0, t1, total = 0.0, row[DURATION], 0.0
    waiting[0, 0], waiting[0, 1] = t1, d1
    top = 1
    longest = COARSE * reach(min(d0, d1, far), given)
    if v * t1 > longest and d0 + d1 - v * t1 < 2.0 * far:
        waiting[1, 0] = FIRST * t1
        waiting[1, 1] = _clearance_on(flight, row, FIRST * t1, far + v * t1)
        top = 2
        if waiting[1, 1] <= CONTACT:
            return math.inf
    while top > 0:
        t1, d1 = waiting[top - 1, 0], waiting[top - 1, 1]
        h = v * (t1 - t0)
        share = 0.0
        if d0 + d1 - h < 2.0 * far:
            t = 0.5 * (t0 + t1)
            d = _clearance_on(flight, row, t, far + h)
            if d <= CONTACT:
                return math.inf
            share = settled(d0, d, d1, h, t1 - t0, given)
            if share < 0.0:
                waiting[top, 0], waiting[top, 1] = t, d
                top += 1
                continue
        total += share
        t0, d0 = t1, d1
        top -= 1
    return total


@kernel
def _maximum_along(flight, pieces, count):
    """Maximum of f along a way, to the relative tolerance, never below a sampled value."""
    most, _ = _longest(flight, pieces, count)
    bound = flight.given[FAR] + most
    box = box_of(flight.field)
    d0 = _clearance_on(flight, pieces[0], 0.0, bound)
    least = d0
    for i in range(count):
        row = pieces[i]
        d1 = _clearance_on(flight, row, row[DURATION], bound)
        if not stays_within(box, row, flight.tracks):
            return math.inf
        least = _least_on(flight, row, d0, d1, min(least, d1))
        if least <= CONTACT:
            return math.inf
        d0 = d1
    return avoid(least, flight.given)


@kernel
def _least_on(flight, row, d0, d1, least):
    """The lesser of ``least`` and the least clearance on a piece, as near as the tolerance asks."""
    given, waiting = flight.given, flight.waiting
    far, v = given[FAR], fastest_on(row, flight.tracks)
    t0 = 0.0
    waiting[0, 0], waiting[0, 1] = row[DURATION], d1
    top = 1
    while top > 0 and least > CONTACT:
        t1, d1 = waiting[top - 1, 0], waiting[top - 1, 1]
        h = v * (t1 - t0)
        if 0.5 * (d0 + d1 - h) >= enough(least, given):
            t0, d0 = t1, d1
            top -= 1
            continue
        t = 0.5 * (t0 + t1)
        d = _clearance_on(flight, row, t, far + h)
        least = min(least, d)
        waiting[top, 0], waiting[top, 1] = t, d
        top += 1
    return least


@kernel
def is_free_along(flight, pieces, count):
    """Whether every state of a way of ``count`` pieces is free, for certain.

    Marches by the clearance, which nothing can be nearer than; what is left of it at the end of a
    piece carries over to the next.
    """
    _, ahead = _longest(flight, pieces, count)
    box = box_of(flight.field)
    carried = 0.0
    for i in range(count):
        row = pieces[i]
        v, seconds, t = fastest_on(row, flight.tracks), row[DURATION], 0.0
        if not stays_within(box, row, flight.tracks):
            return False
        while carried <= v * (seconds - t):
            t += carried / v if v > 0.0 else 0.0
            d = _clearance_on(flight, row, t, ahead - v * t + 2.0 * CONTACT)
            if d <= CONTACT:
                return False
            carried = d - 0.5 * CONTACT
        carried -= v * (seconds - t)
        ahead -= v * seconds
    last = pieces[count - 1]
    return _clearance_on(flight, last, last[DURATION], 2.0 * CONTACT) > CONTACT
