"""Flying beside a reference: inputs that are corrected by the deviation, within the limits."""

from __future__ import annotations

import numpy as np

from ompl_risk._kernels.deviations import DEVIATION, deviation
from ompl_risk._kernels.jit import entry
from ompl_risk._kernels.rigid_body import step


@entry
def backward_gains(a, b, weights, last):
    """Gains of the linear quadratic regulator along a flight, shape (n, 4, 12).

    Args:
        a: A of every step, shape (n, 12, 12).
        b: B of every step, controls in units that cost 1, shape (n, 12, 4).
        weights: cost of the squared deviations, shape (12,).
        last: cost matrix P after the last step, shape (12, 12).
    """
    n = len(a)
    gains, p = np.empty((n, 4, DEVIATION)), last.copy()
    for k in range(n - 1, -1, -1):
        pa, pb = p @ a[k], p @ b[k]
        gains[k] = np.linalg.solve(np.eye(4) + b[k].T @ pb, b[k].T @ pa)
        p = a[k].T @ (pa - pb @ gains[k])
        p = 0.5 * (p + p.T)
        for i in range(DEVIATION):
            p[i, i] += weights[i]
    return gains


@entry
def eased(inputs, change):
    """Inputs (n, 4) without changes above ``change``: the mean of one that lags and one that leads.

    A ramp that is too steep is passed half before its time and half after, so that what one half
    does to the vehicle the other half undoes.
    """
    lagging, leading = inputs.copy(), inputs.copy()
    n = len(inputs)
    for k in range(1, n):
        for i in range(4):
            old = lagging[k - 1, i]
            lagging[k, i] = min(max(inputs[k, i], old - change[i]), old + change[i])
            old = leading[n - k, i]
            leading[n - 1 - k, i] = min(max(inputs[n - 1 - k, i], old - change[i]), old + change[i])
    return 0.5 * (lagging + leading)


@entry
def track(
    start, before, references, inputs, gains, units, low, high, change, dt, given, controls, states
):
    """Fly along references: ``u = input - unit * (gain e)``, as far as the limits allow.

    Args:
        start: the state, shape (13,).
        before: the input before the first, shape (4,).
        references: where to be, shape (n + 1, 13).
        inputs: what leads along the references, the last row again and again, shape (m, 4).
        gains: the last again and again, shape (m, 4, 12).
        units: of the controls, shape (4,).
        low: least controls, shape (4,).
        high: greatest controls, shape (4,).
        change: greatest change from one input to the next, shape (4,).
        dt: the step [s].
        given: parameters of the helicopter.
        controls: written, shape (n, 4).
        states: written, shape (n + 1, 13).
    """
    e, last = np.empty(DEVIATION), len(inputs) - 1
    states[0] = start
    for k in range(len(controls)):
        deviation(states[k], references[k], e)
        held, gain = inputs[min(k, last)], gains[min(k, last)]
        for i in range(4):
            u = held[i]
            for j in range(DEVIATION):
                u -= units[i] * gain[i, j] * e[j]
            old = before[i] if k == 0 else controls[k - 1, i]
            u = min(max(u, old - change[i]), old + change[i])
            controls[k, i] = min(max(u, low[i]), high[i])
        step(states[k], controls[k], dt, given, states[k + 1])
