"""Inputs of least effort that end a deviation from a trim, after a given number of steps."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.deviations import DEVIATION, deviation, placed
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.rigid_body import STATE, step

RAMP = 0.2
"""Part of the time at either end over which a correction is let in: no jumps of the inputs."""

MOST_ROUNDS = 20
"""Rounds of Newton's method."""


@kernel
def share(j, steps):
    """What step j of so many may take of a correction: 1, less near the ends, 0 at the ends."""
    ramp = RAMP * steps
    return min(1.0, j / ramp, (steps - 1 - j) / ramp)


@entry
def gramian(a, b, steps):
    """``sum of share A^i B B^T A^iT`` over the steps, shape (12, 12): C C^T of the inputs."""
    total, reach = np.zeros((DEVIATION, DEVIATION)), b.copy()
    for i in range(steps):
        total += share(steps - 1 - i, steps) * (reach @ reach.T)
        reach = a @ reach
    return total


@entry
def settle(start, control, end, a, b, inverse, spans, tolerances, dt, given, controls, states):
    """Find inputs that lead from ``start`` to ``end``; returns what is left.

    Newton's method with the constant pseudo-inverse: each round flies the inputs, and adds those
    of least norm that would undo the deviation at the end, ``-C^T (C C^T)^-1 e``.

    Args:
        start: the state, shape (13,).
        control: the trim's control, shape (4,).
        end: the trim's state at the end, shape (13,).
        a: A, shape (12, 12).
        b: B, shape (12, 4).
        inverse: of the Gramian, shape (12, 12).
        spans: units of the controls, shape (4,).
        tolerances: of the deviation at the end, shape (12,).
        dt: the step [s].
        given: parameters of the helicopter.
        controls: the inputs, written, shape (n, 4).
        states: the flight, written, shape (n + 1, 13).

    Returns:
        Greatest ratio of a deviation at the end to its tolerance.
    """
    steps = len(controls)
    for k in range(steps):
        controls[k] = control
    e, back = np.empty(DEVIATION), np.empty(DEVIATION)
    states[0] = start
    left = math.inf
    for _ in range(MOST_ROUNDS):
        for k in range(steps):
            step(states[k], controls[k], dt, given, states[k + 1])
        deviation(states[steps], end, e)
        before, left = left, np.max(np.abs(e) / tolerances)
        if left <= 1.0 or not left < 0.5 * before:
            break
        back[:] = -(inverse @ e)
        for k in range(steps - 1, -1, -1):
            controls[k] += share(k, steps) * spans * (b.T @ back)
            back[:] = a.T @ back
    return left


@entry
def excursion(states, trim, pose, stride):
    """Greatest distance [m] and angle [rad] of states from a trim, one step apart.

    Args:
        states: shape (n + 1, 13).
        trim: the trim's state at the origin, shape (13,).
        pose: where the trim is at the first state, shape (4,).
        stride: the trim's displacement in one step, shape (4,).
    """
    e, reference = np.empty(DEVIATION), np.empty(STATE)
    x, y, z, heading = pose
    distance, angle = 0.0, 0.0
    for k in range(len(states)):
        placed(trim, x, y, z, heading, reference)
        deviation(states[k], reference, e)
        distance = max(distance, e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
        angle = max(angle, e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
        c, s = math.cos(heading), math.sin(heading)
        x += c * stride[0] - s * stride[1]
        y += s * stride[0] + c * stride[1]
        z += stride[2]
        heading += stride[3]
    return math.sqrt(distance), math.sqrt(angle)
