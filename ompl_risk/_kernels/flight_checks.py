"""Whether the helicopter may be in a state: its limits, the box it flies in, and the ground."""

from __future__ import annotations

import math

from numba import carray  # pyright: ignore[reportPrivateImportUsage]

from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.nearest import STACK, signed_distance
from ompl_risk._kernels.pointers import float64_at, int64_at
from ompl_risk._kernels.propagation import world_velocity
from ompl_risk._kernels.rigid_body import STATE

# places in what is allowed
SPEED, RATE, UPRIGHT, LOW, HIGH, RADIUS, CONTACT = 0, 1, 2, 3, 6, 9, 10
ALLOWED = 11
"""Numbers in what is allowed: greatest speed [m/s] and rate about an axis [rad/s], least cosine of
the attitude, least and greatest position [m], radius of the body and least clearance [m]."""

# what may be wrong with a state
FINE, TOO_FAST, TURNS_TOO_FAST, TILTED, OUTSIDE = range(5)


@kernel
def fault(state, allowed):
    """The first limit that a state breaks, FINE if none; a state with a NaN is not FINE."""
    x, y = state[3], state[4]
    speed2 = state[7] * state[7] + state[8] * state[8] + state[9] * state[9]
    if not speed2 <= allowed[SPEED] * allowed[SPEED]:
        return TOO_FAST
    for k in range(10, 13):
        if not abs(state[k]) <= allowed[RATE]:
            return TURNS_TOO_FAST
    if not 1.0 - 2.0 * (x * x + y * y) >= allowed[UPRIGHT]:
        return TILTED
    for k in range(3):
        if not allowed[LOW + k] <= state[k] <= allowed[HIGH + k]:
            return OUTSIDE
    return FINE


@entry
def first_fault(state, allowed):
    """See ``fault``."""
    return fault(state, allowed)


@entry
def is_within(address):
    """Whether the state keeps the limits; addresses of the state and of what is allowed."""
    table = carray(int64_at(address), (2,))
    state = carray(float64_at(table[0]), (STATE,))
    return fault(state, carray(float64_at(table[1]), (ALLOWED,))) == FINE


@entry
def is_flyable(address):
    """Whether the state keeps the limits, clear of the ground.

    Args:
        address: of a table: addresses of the state and of what is allowed, of the two work spaces
            of a distance query, and the handle of the height field.
    """
    table = carray(int64_at(address), (12,))
    state = carray(float64_at(table[0]), (STATE,))
    allowed = carray(float64_at(table[1]), (ALLOWED,))
    if fault(state, allowed) != FINE:
        return False
    stack = carray(int64_at(table[2]), (STACK, 3))
    keys = carray(float64_at(table[3]), (STACK,))
    bound = allowed[RADIUS] + allowed[CONTACT]
    d = signed_distance(opened(table[4:]), state[0], state[1], state[2], bound, stack, keys)
    return d > allowed[RADIUS]


@entry
def miss(address):
    """How far a state is from a goal: the larger of the parts of its two tolerances.

    ::

        max(|p - p*| / radius, |R v - u*| / tolerance)

    Args:
        address: of a table: addresses of the state, and of the goal, p* [m], u* [m/s], radius [m]
            and tolerance [m/s].
    """
    table = carray(int64_at(address), (2,))
    state = carray(float64_at(table[0]), (STATE,))
    goal = carray(float64_at(table[1]), (8,))
    dx, dy, dz = state[0] - goal[0], state[1] - goal[1], state[2] - goal[2]
    u1, u2, u3 = world_velocity(state)
    du, dv, dw = u1 - goal[3], u2 - goal[4], u3 - goal[5]
    apart = math.sqrt(dx * dx + dy * dy + dz * dz) / goal[6]
    return max(apart, math.sqrt(du * du + dv * dv + dw * dw) / goal[7])
