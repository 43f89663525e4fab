"""Motion of the helicopter of eqs. (7) and (8): one rigid body under rotor lift and tail force.

States are 13 numbers: position x, y, z [m] in the world, quaternion (x, y, z, w) from body to
world, velocity v [m/s] and angular velocity omega [rad/s], both in the body's frame, which points
forward, left and up.
"""

from __future__ import annotations

import math

from ompl_risk._kernels.jit import entry, inlined, kernel

STATE = 13
"""Numbers in a state."""

# places in the parameters
MASS, J1, J2, J3, HUB, TAIL, GRAVITY = range(7)
DRAG, WIND = 7, 10
PARAMETERS = 13
"""Numbers in the parameters: after the drag [kg/s] along the body's axes the wind [m/s]."""


@kernel
def wrench(u_c, u_psi, gamma_p, gamma_r, given):
    """Torque [N m] and force [N] of the controls in the body's frame, F(gamma) u."""
    sp, cp, sr, cr = (
        math.sin(gamma_p),
        math.cos(gamma_p),
        math.sin(gamma_r),
        math.cos(gamma_r),
    )
    return wrench_of(u_c, u_psi, sp, cp, sr, cr, given)


@inlined
def wrench_of(u_c, u_psi, sp, cp, sr, cr, given):
    """``wrench`` from the sines and cosines of the rotor's angles."""
    fx, fy, fz = u_c * sp * cr, -u_c * sr, u_c * cp * cr
    return -given[HUB] * fy, given[HUB] * fx, given[TAIL] * u_psi, fx, fy - u_psi, fz


@inlined
def rates(x, y, z, w, v1, v2, v3, o1, o2, o3, load, given):
    """Time derivatives of a state, eqs. (7) and (8), under a load that is fixed in the body."""
    t1, t2, t3, f1, f2, f3 = load
    m, g = given[MASS], given[GRAVITY]
    j1, j2, j3 = given[J1], given[J2], given[J3]
    # R, row by row, of a quaternion of any norm: stages are not quite of norm 1, and what is not a
    # rotation would weigh gravity and velocity differently in every direction.
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    n = 1.0 / (xx + yy + zz + ww)
    k = 2.0 * n
    r11, r12, r13 = n * (ww + xx - yy - zz), k * (x * y - w * z), k * (x * z + w * y)
    r21, r22, r23 = k * (x * y + w * z), n * (ww - xx + yy - zz), k * (y * z - w * x)
    r31, r32, r33 = k * (x * z - w * y), k * (y * z + w * x), n * (ww - xx - yy + zz)
    w1, w2, w3 = given[WIND], given[WIND + 1], given[WIND + 2]
    a1 = v1 - (r11 * w1 + r21 * w2 + r31 * w3)
    a2 = v2 - (r12 * w1 + r22 * w2 + r32 * w3)
    a3 = v3 - (r13 * w1 + r23 * w2 + r33 * w3)
    return (
        r11 * v1 + r12 * v2 + r13 * v3,
        r21 * v1 + r22 * v2 + r23 * v3,
        r31 * v1 + r32 * v2 + r33 * v3,
        0.5 * (w * o1 + y * o3 - z * o2),
        0.5 * (w * o2 + z * o1 - x * o3),
        0.5 * (w * o3 + x * o2 - y * o1),
        -0.5 * (x * o1 + y * o2 + z * o3),
        v2 * o3 - v3 * o2 - g * r31 + (f1 - given[DRAG] * a1) / m,
        v3 * o1 - v1 * o3 - g * r32 + (f2 - given[DRAG + 1] * a2) / m,
        v1 * o2 - v2 * o1 - g * r33 + (f3 - given[DRAG + 2] * a3) / m,
        ((j2 - j3) * o2 * o3 + t1) / j1,
        ((j3 - j1) * o3 * o1 + t2) / j2,
        ((j1 - j2) * o1 * o2 + t3) / j3,
    )


@kernel
def step(state, control, dt, given, out):
    """One step of the classical Runge-Kutta method of order 4, then a quaternion of norm 1.

    ``out`` may be ``state``.
    """
    load = wrench(control[0], control[1], control[2], control[3], given)
    after = advanced(
        state[0], state[1], state[2], state[3], state[4], state[5], state[6],
        state[7], state[8], state[9], state[10], state[11], state[12], load, dt, given,
    )  # fmt: skip
    for i in range(STATE):
        out[i] = after[i]


@inlined
def advanced(p1, p2, p3, q1, q2, q3, q4, v1, v2, v3, o1, o2, o3, load, dt, given):
    """The state after one step under a load that is fixed in the body."""
    h = 0.5 * dt
    a = rates(q1, q2, q3, q4, v1, v2, v3, o1, o2, o3, load, given)
    b = rates(
        q1 + h * a[3], q2 + h * a[4], q3 + h * a[5], q4 + h * a[6],
        v1 + h * a[7], v2 + h * a[8], v3 + h * a[9],
        o1 + h * a[10], o2 + h * a[11], o3 + h * a[12],
        load, given,
    )  # fmt: skip
    c = rates(
        q1 + h * b[3], q2 + h * b[4], q3 + h * b[5], q4 + h * b[6],
        v1 + h * b[7], v2 + h * b[8], v3 + h * b[9],
        o1 + h * b[10], o2 + h * b[11], o3 + h * b[12],
        load, given,
    )  # fmt: skip
    d = rates(
        q1 + dt * c[3], q2 + dt * c[4], q3 + dt * c[5], q4 + dt * c[6],
        v1 + dt * c[7], v2 + dt * c[8], v3 + dt * c[9],
        o1 + dt * c[10], o2 + dt * c[11], o3 + dt * c[12],
        load, given,
    )  # fmt: skip
    s = dt / 6.0
    q1 += s * (a[3] + 2.0 * (b[3] + c[3]) + d[3])
    q2 += s * (a[4] + 2.0 * (b[4] + c[4]) + d[4])
    q3 += s * (a[5] + 2.0 * (b[5] + c[5]) + d[5])
    q4 += s * (a[6] + 2.0 * (b[6] + c[6]) + d[6])
    unit = 1.0 / math.sqrt(q1 * q1 + q2 * q2 + q3 * q3 + q4 * q4)
    return (
        p1 + s * (a[0] + 2.0 * (b[0] + c[0]) + d[0]),
        p2 + s * (a[1] + 2.0 * (b[1] + c[1]) + d[1]),
        p3 + s * (a[2] + 2.0 * (b[2] + c[2]) + d[2]),
        q1 * unit,
        q2 * unit,
        q3 * unit,
        q4 * unit,
        v1 + s * (a[7] + 2.0 * (b[7] + c[7]) + d[7]),
        v2 + s * (a[8] + 2.0 * (b[8] + c[8]) + d[8]),
        v3 + s * (a[9] + 2.0 * (b[9] + c[9]) + d[9]),
        o1 + s * (a[10] + 2.0 * (b[10] + c[10]) + d[10]),
        o2 + s * (a[11] + 2.0 * (b[11] + c[11]) + d[11]),
        o3 + s * (a[12] + 2.0 * (b[12] + c[12]) + d[12]),
    )


@entry
def propagate(state, control, dt, given, out):
    """``out`` = the state after one step; ``out`` may be ``state``."""
    step(state, control, dt, given, out)


@entry
def hold(state, control, dt, steps, given, out):
    """``out`` = the state after so many steps under one control."""
    out[:] = state
    for _ in range(steps):
        step(out, control, dt, given, out)


@entry
def rollout(start, controls, dt, given, out):
    """``out[k + 1]`` = the state after holding ``controls[k]`` for dt; shapes (n, 4), (n+1, 13)."""
    out[0] = start
    for k in range(len(controls)):
        step(out[k], controls[k], dt, given, out[k + 1])
