"""How far a state is from another one, and how small deviations grow along a flight.

A deviation is 12 numbers, all in the body's frame of the reference: displacement [m], rotation
vector [rad], and the differences of velocity [m/s] and of angular velocity [rad/s]. Seen so, it
matters neither where the vehicle is nor where it heads: along a trim small deviations follow
e' = A e + B du with constant matrices, and along a manoeuvre with the same ones wherever it
begins.
"""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.rigid_body import STATE, step

DEVIATION = 12
"""Numbers in a deviation."""


@kernel
def product(a1, a2, a3, a4, b1, b2, b3, b4):
    """Product of two quaternions (x, y, z, w)."""
    return (
        a4 * b1 + a1 * b4 + a2 * b3 - a3 * b2,
        a4 * b2 - a1 * b3 + a2 * b4 + a3 * b1,
        a4 * b3 + a1 * b2 - a2 * b1 + a3 * b4,
        a4 * b4 - a1 * b1 - a2 * b2 - a3 * b3,
    )


@kernel
def rotated(x, y, z, w, v1, v2, v3):
    """A vector turned by a unit quaternion."""
    a1, a2, a3, a4 = product(x, y, z, w, v1, v2, v3, 0.0)
    b1, b2, b3, _ = product(a1, a2, a3, a4, -x, -y, -z, w)
    return b1, b2, b3


@kernel
def placed(body, x, y, z, heading, out):
    """``out`` = the state ``body``, given about the origin and heading 0, moved to a pose."""
    c, s = math.cos(heading), math.sin(heading)
    right, left, up = body[0], body[1], body[2]
    half_c, half_s = math.cos(0.5 * heading), math.sin(0.5 * heading)
    turned = product(0.0, 0.0, half_s, half_c, body[3], body[4], body[5], body[6])
    out[0], out[1], out[2] = x + c * right - s * left, y + s * right + c * left, z + up
    out[3], out[4], out[5], out[6] = turned
    for i in range(7, STATE):
        out[i] = body[i]


@kernel
def deviation(state, reference, out):
    """``out`` (12,) = how far a state is from a reference."""
    r1, r2, r3, r4 = reference[3], reference[4], reference[5], reference[6]
    dx, dy, dz = state[0] - reference[0], state[1] - reference[1], state[2] - reference[2]
    out[0], out[1], out[2] = rotated(-r1, -r2, -r3, r4, dx, dy, dz)
    q1, q2, q3, q4 = product(-r1, -r2, -r3, r4, state[3], state[4], state[5], state[6])
    sine = math.sqrt(q1 * q1 + q2 * q2 + q3 * q3)
    if q4 < 0.0:
        q1, q2, q3, q4 = -q1, -q2, -q3, -q4
    scale = 2.0 if sine == 0.0 else 2.0 * math.atan2(sine, q4) / sine
    out[3], out[4], out[5] = scale * q1, scale * q2, scale * q3
    for i in range(6):
        out[6 + i] = state[7 + i] - reference[7 + i]


@kernel
def deviated(reference, e, out):
    """``out`` = the state that deviates by ``e`` from a reference."""
    r1, r2, r3, r4 = reference[3], reference[4], reference[5], reference[6]
    dx, dy, dz = rotated(r1, r2, r3, r4, e[0], e[1], e[2])
    angle = math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
    scale = 0.5 if angle == 0.0 else math.sin(0.5 * angle) / angle
    s1, s2, s3 = scale * e[3], scale * e[4], scale * e[5]
    turned = product(r1, r2, r3, r4, s1, s2, s3, math.cos(0.5 * angle))
    out[0], out[1], out[2] = reference[0] + dx, reference[1] + dy, reference[2] + dz
    out[3], out[4], out[5], out[6] = turned
    for i in range(6):
        out[7 + i] = reference[7 + i] + e[6 + i]


@kernel
def _answer(reference, e, control, following, dt, given, state, out):
    """``out`` = the deviation one step after ``e``; ``state`` (13,) is room to work in."""
    deviated(reference, e, state)
    step(state, control, dt, given, state)
    deviation(state, following, out)


@entry
def sensitivities(states, controls, dt, given, spans, h):
    """A (n, 12, 12) and B (n, 12, 4) of every step of a flight, by central differences.

    Args:
        states: the flight, shape (n + 1, 13).
        controls: its inputs, shape (n, 4).
        dt: the step [s].
        given: parameters of the helicopter.
        spans: what counts as one unit of each control, shape (4,).
        h: half the difference.
    """
    n = len(controls)
    a, b = np.zeros((n, DEVIATION, DEVIATION)), np.zeros((n, DEVIATION, 4))
    e, u, state = np.zeros(DEVIATION), np.empty(4), np.empty(STATE)
    above, below = np.empty(DEVIATION), np.empty(DEVIATION)
    for k in range(n):
        u[:] = controls[k]
        for i in range(DEVIATION):
            e[i] = h
            _answer(states[k], e, u, states[k + 1], dt, given, state, above)
            e[i] = -h
            _answer(states[k], e, u, states[k + 1], dt, given, state, below)
            e[i] = 0.0
            a[k, :, i] = (above - below) / (2.0 * h)
        for i in range(4):
            u[i] = controls[k, i] + h * spans[i]
            _answer(states[k], e, u, states[k + 1], dt, given, state, above)
            u[i] = controls[k, i] - h * spans[i]
            _answer(states[k], e, u, states[k + 1], dt, given, state, below)
            u[i] = controls[k, i]
            b[k, :, i] = (above - below) / (2.0 * h)
    return a, b


@entry
def separation(states, others):
    """Distance [m] and angle [rad] between states of two flights, shape (n, 2)."""
    found, e = np.empty((len(states), 2)), np.empty(DEVIATION)
    for k in range(len(states)):
        deviation(states[k], others[k], e)
        found[k, 0] = math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
        found[k, 1] = math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
    return found


@entry
def velocities_in_world(states):
    """R v [m/s] of states (n, 13), shape (n, 3)."""
    found = np.empty((len(states), 3))
    for k in range(len(states)):
        q, v = states[k, 3:7], states[k, 7:10]
        found[k, 0], found[k, 1], found[k, 2] = rotated(q[0], q[1], q[2], q[3], v[0], v[1], v[2])
    return found
