"""Inputs that make the helicopter accelerate as wanted: an inner loop around its attitude.

Random inputs turn a helicopter over within half a second. An act is a simple intention instead,
which the loop turns into inputs, held for a while each, from the state that they are applied in.
The inputs that an act has led to are therefore known from the state in which it began.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import kernel
from ompl_risk._kernels.propagation import world_velocity
from ompl_risk._kernels.rigid_body import GRAVITY, HUB, J1, MASS, TAIL

HELD, PUSH, REACH = 0.0, 1.0, 2.0
"""Kinds of acts: the inputs that follow; an acceleration in the world [m/s^2]; a position [m] and
a velocity there [m/s], with the deceleration on the way [m/s^2]."""

ACT = 8
"""Numbers in an act, the kind first."""

# places in the settings of the loop
RATE_GAIN, ATTITUDE_GAIN, SPEED_GAIN, TOP_SPEED, TOP_RATE, STEEPEST, BRAKE = range(7)
LOOP = 7
"""Numbers in the settings: gains [1/s], speed [m/s] and rates [rad/s] that the loop keeps to, the
tangent of the tilt that it asks for at most, and the angular acceleration [rad/s^2] with which it
counts on ending a turn."""

UNHURRIED = 2.0
"""Least time in which a target is reached for, in time constants of the speed: with less it would
swing about the target."""

LIGHTEST = 0.3
"""Least lift that the loop asks for, in weights: with less it could not tilt the lift."""


@kernel
def inputs(act, state, given, low, high, loop, control):
    """Write the inputs for an act at a state.

    Args:
        act: what to do, shape (ACT,).
        state: of the vehicle, shape (13,).
        given: its parameters.
        low, high: range of the inputs, shapes (4,).
        loop: settings, shape (LOOP,).
        control: where the inputs go, shape (4,).
    """
    if act[0] == HELD:
        for k in range(4):
            control[k] = act[1 + k]
        return
    ax, ay, az = _wanted(act, state, loop)
    ax, ay, up = _lift(ax, ay, az, given, high, loop)
    total = math.sqrt(ax * ax + ay * ay + up * up)
    x, y, z, w = state[3], state[4], state[5], state[6]
    # direction of the lift in the body: R^T (ax, ay, up)
    b1 = (1.0 - 2.0 * (y * y + z * z)) * ax + 2.0 * ((x * y + w * z) * ay + (x * z - w * y) * up)
    b2 = (1.0 - 2.0 * (x * x + z * z)) * ay + 2.0 * ((x * y - w * z) * ax + (y * z + w * x) * up)
    b3 = (1.0 - 2.0 * (x * x + y * y)) * up + 2.0 * ((x * z + w * y) * ax + (y * z - w * x) * ay)
    control[0] = min(max(given[MASS] * b3, low[0]), high[0])
    level = math.sqrt(b1 * b1 + b2 * b2)
    r1, r2 = 0.0, 0.0
    if level > 1e-12 * total:
        angle = math.atan2(level, b3)
        turn = min(loop[ATTITUDE_GAIN] * angle, math.sqrt(2.0 * loop[BRAKE] * angle))
        turn = min(turn, loop[TOP_RATE]) / level
        r1, r2 = -turn * b2, turn * b1
    _turn(r1, r2, state, given, low, high, loop, control)


@kernel
def _wanted(act, state, loop):
    """Acceleration that an act asks for; along the velocity no more than keeps the top speed."""
    u1, u2, u3 = world_velocity(state)
    top, gain = loop[TOP_SPEED], loop[SPEED_GAIN]
    if act[0] == PUSH:
        ax, ay, az = act[1], act[2], act[3]
    else:
        ax, ay, az = _towards(act, state, u1, u2, u3, top, UNHURRIED / gain)
    speed = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
    if speed > 1e-9:
        excess = (ax * u1 + ay * u2 + az * u3) / speed - gain * (top - speed)
        if excess > 0.0:
            share = excess / speed
            return ax - share * u1, ay - share * u2, az - share * u3
    return ax, ay, az


@kernel
def _towards(act, state, u1, u2, u3, top, least):
    """Acceleration towards a position and a velocity there.

    Of all ways to be there after a time t, the one of least effort begins with ::

        a = (6 e - (4 u + 2 u*) t) / t^2

    for a displacement e and velocities u now and u* then. With t from the deceleration b,
    ``sqrt(u*^2 + 2 b |e|) = |u*| + b t``, it brakes with b. Times below ``least`` would ask for too
    much: the target is then where it would be later if it moved on.

    Reference: D'Souza, An optimal guidance law for planetary landing, AIAA GNC 1997.
    """
    x, y, z = act[1] - state[0], act[2] - state[1], act[3] - state[2]
    w1, w2, w3, b = act[4], act[5], act[6], act[7]
    left = math.sqrt(x * x + y * y + z * z)
    last = math.sqrt(w1 * w1 + w2 * w2 + w3 * w3)
    due = max((math.sqrt(last * last + 2.0 * b * left) - last) / b, left / top)
    t = max(due, least)
    late = t - due
    p, q, r = 6.0 / (t * t), 4.0 / t, 2.0 / t
    return (
        p * (x + w1 * late) - q * u1 - r * w1,
        p * (y + w2 * late) - q * u2 - r * w2,
        p * (z + w3 * late) - q * u3 - r * w3,
    )


@kernel
def _lift(ax, ay, az, given, high, loop):
    """Lift per mass for an acceleration: what holds the height comes first, the rest is tilt."""
    g, most = given[GRAVITY], high[0] / given[MASS]
    up = min(max(az + g, LIGHTEST * g), 0.98 * most)
    level = math.sqrt(ax * ax + ay * ay)
    allowed = min(loop[STEEPEST] * up, math.sqrt(most * most - up * up))
    share = allowed / level if level > allowed else 1.0
    return share * ax, share * ay, up


@kernel
def _turn(r1, r2, state, given, low, high, loop, control):
    """The inputs besides the lift, for angular velocities (r1, r2, 0) of the body."""
    o1, o2, o3 = state[10], state[11], state[12]
    gain = loop[RATE_GAIN]
    j1, j2, j3 = given[J1], given[J1 + 1], given[J1 + 2]
    t1 = gain * j1 * (r1 - o1) - (j2 - j3) * o2 * o3
    t2 = gain * j2 * (r2 - o2) - (j3 - j1) * o3 * o1
    t3 = -gain * j3 * o3 - (j1 - j2) * o1 * o2
    arm = given[HUB] * max(control[0], 1e-9 * given[MASS])
    roll = math.asin(min(max(t1 / arm, -1.0), 1.0))
    control[3] = min(max(roll, low[3]), high[3])
    pitch = math.asin(min(max(t2 / (arm * math.cos(control[3])), -1.0), 1.0))
    control[2] = min(max(pitch, low[2]), high[2])
    control[1] = min(max(t3 / given[TAIL], low[1]), high[1])
