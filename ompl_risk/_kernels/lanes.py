"""Helicopters in lockstep: one step of LANES vehicles beside the same planned state.

Every array holds LANES numbers for a first component, then LANES for a second, and so on. Loops
over the lanes are free of branches and of calls, sines and the like being polynomials: the
compiler does four vehicles at a time.
"""

from __future__ import annotations

from ompl_risk._kernels.jit import inlined, kernel
from ompl_risk._kernels.rigid_body import DRAG, advanced, wrench_of

LANES = 16
"""With fewer the compiler writes the loop out, instead of doing several rounds at a time."""

PLACE = 0.6
"""Part of a bound that the place alone may take up."""


@inlined
def sine(x):
    """Within 1e-15 for angles up to a right one: Taylor's polynomial."""
    t = x * x
    return x * (1.0 - t * (1.0 / 6.0) * (1.0 - t * (1.0 / 20.0) * (1.0 - t * (1.0 / 42.0) * (
        1.0 - t * (1.0 / 72.0) * (1.0 - t * (1.0 / 110.0) * (1.0 - t * (1.0 / 156.0) * (
        1.0 - t * (1.0 / 210.0) * (1.0 - t * (1.0 / 272.0) * (1.0 - t * (1.0 / 342.0))))
    ))))))  # fmt: skip


@inlined
def cosine(x):
    """Within 1e-15 for angles up to a right one."""
    t = x * x
    return (1.0 - t * (1.0 / 2.0) * (1.0 - t * (1.0 / 12.0) * (1.0 - t * (1.0 / 30.0) * (
        1.0 - t * (1.0 / 56.0) * (1.0 - t * (1.0 / 90.0) * (1.0 - t * (1.0 / 132.0) * (
        1.0 - t * (1.0 / 182.0) * (1.0 - t * (1.0 / 240.0) * (1.0 - t * (1.0 / 306.0) * (
        1.0 - t * (1.0 / 380.0)))))))))))  # fmt: skip


@inlined
def sine_share(t):
    """sin(a) / a of a^2, for angles up to 3.5 within 1e-13."""
    return (1.0 - t * (1.0 / 6.0) * (1.0 - t * (1.0 / 20.0) * (1.0 - t * (1.0 / 42.0) * (
        1.0 - t * (1.0 / 72.0) * (1.0 - t * (1.0 / 110.0) * (1.0 - t * (1.0 / 156.0) * (
        1.0 - t * (1.0 / 210.0) * (1.0 - t * (1.0 / 272.0) * (1.0 - t * (1.0 / 342.0) * (
        1.0 - t * (1.0 / 420.0) * (1.0 - t * (1.0 / 506.0) * (1.0 - t * (1.0 / 600.0) * (
        1.0 - t * (1.0 / 702.0) * (1.0 - t * (1.0 / 812.0)))))))))))))))  # fmt: skip


@inlined
def cosine_share(t):
    """(1 - cos(a)) / a^2 of a^2, for angles up to 3.5 within 1e-13."""
    return 0.5 * (1.0 - t * (1.0 / 12.0) * (1.0 - t * (1.0 / 30.0) * (1.0 - t * (1.0 / 56.0) * (
        1.0 - t * (1.0 / 90.0) * (1.0 - t * (1.0 / 132.0) * (1.0 - t * (1.0 / 182.0) * (
        1.0 - t * (1.0 / 240.0) * (1.0 - t * (1.0 / 306.0) * (1.0 - t * (1.0 / 380.0) * (
        1.0 - t * (1.0 / 462.0) * (1.0 - t * (1.0 / 552.0) * (1.0 - t * (1.0 / 650.0) * (
        1.0 - t * (1.0 / 756.0) * (1.0 - t * (1.0 / 870.0)))))))))))))))  # fmt: skip


@inlined
def arc_share(t):
    """arctan(a) / a of a^2, for a up to 1 within 2e-14: interpolated at Chebyshev's points."""
    return (
        0.9999999999999813 + t * (-0.3333333333255279 + t * (
            0.1999999993581937 + t * (-0.1428571204574935 + t * (
            0.11111068342131036 + t * (-0.09090400463720133 + t * (
            0.07688232927692465 + t * (-0.06643505678213611 + t * (
            0.05785485614834687 + t * (-0.0495689849024251 + t * (
            0.04013961256673462 + t * (-0.029088911946599065 + t * (
            0.0177171911227864 + t * (-0.008464656925153968 + t * (
            0.0029164394995327384 + t * (-0.0006364041542474389 + t * (
            6.552513441722181e-05))))))))))))))))
    )  # fmt: skip


@kernel
def see(states, errors, reference, seen):
    """What the law sees of the vehicles' deviations from a reference.

    As ``deviations.deviation``, with the errors of the navigation and, instead of the difference of
    the velocities, each in its own body's frame, R_r^T (v - v_r). Seen in the body's frame a
    helicopter that climbs and banks drifts sideways, and a law that is linear in that drift banks
    it further until it turns over.

    Args:
        states: shape (13 LANES,).
        errors: of the navigation, shape (9 LANES,).
        reference: the planned state, shape (13,).
        seen: written, shape (12 LANES,).
    """
    p1, p2, p3 = reference[0], reference[1], reference[2]
    r1, r2, r3, r4 = reference[3], reference[4], reference[5], reference[6]
    u1, u2, u3 = reference[7], reference[8], reference[9]
    o1, o2, o3 = reference[10], reference[11], reference[12]
    m11, m12, m13, m21, m22, m23, m31, m32, m33 = _matrix(r1, r2, r3, r4)
    for n in range(LANES):
        x = states[n] - p1 + errors[n]
        y = states[LANES + n] - p2 + errors[LANES + n]
        z = states[2 * LANES + n] - p3 + errors[2 * LANES + n]
        seen[n] = m11 * x + m21 * y + m31 * z
        seen[LANES + n] = m12 * x + m22 * y + m32 * z
        seen[2 * LANES + n] = m13 * x + m23 * y + m33 * z
        q1, q2 = states[3 * LANES + n], states[4 * LANES + n]
        q3, q4 = states[5 * LANES + n], states[6 * LANES + n]
        w = r4 * q4 + r1 * q1 + r2 * q2 + r3 * q3
        x = r4 * q1 - r1 * q4 - r2 * q3 + r3 * q2
        y = r4 * q2 + r1 * q3 - r2 * q4 - r3 * q1
        z = r4 * q3 - r1 * q2 + r2 * q1 - r3 * q4
        half = 1.0 / (1.0 + abs(w))  # the tangent of a quarter of the angle is sine times this
        scale = 4.0 * half * arc_share((x * x + y * y + z * z) * half * half)
        scale = -scale if w < 0.0 else scale
        x = scale * x + errors[3 * LANES + n]
        y = scale * y + errors[4 * LANES + n]
        z = scale * z + errors[5 * LANES + n]
        seen[3 * LANES + n], seen[4 * LANES + n], seen[5 * LANES + n] = x, y, z
        v1 = states[7 * LANES + n] + errors[6 * LANES + n]
        v2 = states[8 * LANES + n] + errors[7 * LANES + n]
        v3 = states[9 * LANES + n] + errors[8 * LANES + n]
        t = x * x + y * y + z * z
        a, b = sine_share(t), cosine_share(t)
        c1, c2, c3 = y * v3 - z * v2, z * v1 - x * v3, x * v2 - y * v1
        seen[6 * LANES + n] = v1 - u1 + a * c1 + b * (y * c3 - z * c2)
        seen[7 * LANES + n] = v2 - u2 + a * c2 + b * (z * c1 - x * c3)
        seen[8 * LANES + n] = v3 - u3 + a * c3 + b * (x * c2 - y * c1)
        seen[9 * LANES + n] = states[10 * LANES + n] - o1
        seen[10 * LANES + n] = states[11 * LANES + n] - o2
        seen[11 * LANES + n] = states[12 * LANES + n] - o3


@inlined
def _matrix(x, y, z, w):
    """The rotation of a unit quaternion, row by row."""
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


@kernel
def answer(seen, gain, planned, most, low, high, change, j, controls):
    """Control j of every vehicle, which may differ from the one before by ``change``.

    What place and velocity ask for is bounded, and what place alone asks for is bounded more
    closely: far from the plan the vehicle leans by so much and not more, and flies back at a
    speed at which it can still stop.

    Args:
        seen: from ``see``.
        gain: of the control, shape (12,).
        planned: the control as planned.
        most: bound for what place and velocity ask for.
        low: least control.
        high: greatest control.
        change: greatest change.
        j: which control.
        controls: read and written, shape (4 LANES,).
    """
    k0, k1, k2, k3, k4, k5 = gain[0], gain[1], gain[2], gain[3], gain[4], gain[5]
    k6, k7, k8, k9, k10, k11 = gain[6], gain[7], gain[8], gain[9], gain[10], gain[11]
    for n in range(LANES):
        place = k0 * seen[n] + k1 * seen[LANES + n] + k2 * seen[2 * LANES + n]
        outer = min(max(place, -PLACE * most), PLACE * most)
        outer += k6 * seen[6 * LANES + n] + k7 * seen[7 * LANES + n] + k8 * seen[8 * LANES + n]
        outer = min(max(outer, -most), most)
        inner = k3 * seen[3 * LANES + n] + k4 * seen[4 * LANES + n] + k5 * seen[5 * LANES + n]
        inner += k9 * seen[9 * LANES + n] + k10 * seen[10 * LANES + n] + k11 * seen[11 * LANES + n]
        old = controls[j * LANES + n]
        u = min(max(planned - outer - inner, old - change), old + change)
        controls[j * LANES + n] = min(max(u, low), high)


@kernel
def blow(states, winds, drag, velocity, given, pushes):
    """Forces of gusts in the bodies [N]: C (R^T w - (v - R^T v_r)).

    v_r is the planned velocity in the world: the drag that goes with it is part of the plan. A
    vehicle that a gust carries along feels it the less, and is carried no faster than by w. Where
    the helicopter's own drag does that already it is not done twice.

    Args:
        states: shape (13 LANES,).
        winds: w in the world [m/s], shape (3 LANES,).
        drag: the diagonal of C [kg/s], shape (3,).
        velocity: v_r [m/s], shape (3,).
        given: parameters of the helicopter.
        pushes: written, shape (3 LANES,).
    """
    c1, c2, c3 = drag[0], drag[1], drag[2]
    d1, d2 = max(c1 - given[DRAG], 0.0), max(c2 - given[DRAG + 1], 0.0)
    d3 = max(c3 - given[DRAG + 2], 0.0)
    u1, u2, u3 = velocity[0], velocity[1], velocity[2]
    for n in range(LANES):
        m11, m12, m13, m21, m22, m23, m31, m32, m33 = _matrix(
            states[3 * LANES + n], states[4 * LANES + n],
            states[5 * LANES + n], states[6 * LANES + n],
        )  # fmt: skip
        x, y, z = winds[n], winds[LANES + n], winds[2 * LANES + n]
        v1 = states[7 * LANES + n] - (m11 * u1 + m21 * u2 + m31 * u3)
        v2 = states[8 * LANES + n] - (m12 * u1 + m22 * u2 + m32 * u3)
        v3 = states[9 * LANES + n] - (m13 * u1 + m23 * u2 + m33 * u3)
        pushes[n] = c1 * (m11 * x + m21 * y + m31 * z) - d1 * v1
        pushes[LANES + n] = c2 * (m12 * x + m22 * y + m32 * z) - d2 * v2
        pushes[2 * LANES + n] = c3 * (m13 * x + m23 * y + m33 * z) - d3 * v3


@kernel
def step_all(states, controls, pushes, dt, parameters):
    """One step of every vehicle under its control and a further force; see ``rigid_body.step``.

    Args:
        states: read and written, shape (13 LANES,).
        controls: shape (4 LANES,); angles up to a right one.
        pushes: in the body [N], shape (3 LANES,).
        dt: the step [s].
        parameters: of the helicopter.
    """
    p = parameters  # taken out of their array: the compiler cannot know that it is not written
    given = p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], p[8], p[9], p[10], p[11], p[12]
    for n in range(LANES):
        pitch, roll = controls[2 * LANES + n], controls[3 * LANES + n]
        t1, t2, t3, f1, f2, f3 = wrench_of(
            controls[n], controls[LANES + n],
            sine(pitch), cosine(pitch), sine(roll), cosine(roll), given,
        )  # fmt: skip
        f1, f2, f3 = f1 + pushes[n], f2 + pushes[LANES + n], f3 + pushes[2 * LANES + n]
        after = advanced(
            states[n], states[LANES + n], states[2 * LANES + n], states[3 * LANES + n],
            states[4 * LANES + n], states[5 * LANES + n], states[6 * LANES + n],
            states[7 * LANES + n], states[8 * LANES + n], states[9 * LANES + n],
            states[10 * LANES + n], states[11 * LANES + n], states[12 * LANES + n],
            (t1, t2, t3, f1, f2, f3), dt, given,
        )  # fmt: skip
        states[n], states[LANES + n], states[2 * LANES + n] = after[0], after[1], after[2]
        states[3 * LANES + n], states[4 * LANES + n] = after[3], after[4]
        states[5 * LANES + n], states[6 * LANES + n] = after[5], after[6]
        states[7 * LANES + n], states[8 * LANES + n] = after[7], after[8]
        states[9 * LANES + n], states[10 * LANES + n] = after[9], after[10]
        states[11 * LANES + n], states[12 * LANES + n] = after[11], after[12]
