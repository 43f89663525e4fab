"""One rollout after the other by the library's own deviation and controls, as an oracle."""

import math

import numba
import numpy as np

from ompl_risk._kernels.closed_loop import ASIDE
from ompl_risk._kernels.deviations import deviation, rotated
from ompl_risk._kernels.gusts import GUST, advance_gust, begin_gust
from ompl_risk._kernels.lanes import PLACE
from ompl_risk._kernels.navigation import NAVIGATION, advance_navigation, begin_navigation
from ompl_risk._kernels.rigid_body import DRAG, advanced, wrench


@numba.njit
def scalar_loop(loop, air, k):
    """States (n + 1, 13) and controls (n, 4) of rollout k."""
    n = len(loop.controls)
    states, controls, e = np.empty((n + 1, 13)), np.empty((n, 4)), np.empty(12)
    gust, wind, push = np.zeros(GUST), np.zeros(3), np.zeros(3)
    bias, error = np.zeros(NAVIGATION), np.zeros(NAVIGATION)
    seed, aside = np.empty(1, np.uint64), np.empty(1, np.uint64)
    seed[0], aside[0] = air.seeds[k], air.seeds[k] ^ ASIDE
    if len(air.filters):
        begin_gust(gust, air.filters[0], seed)
    if len(air.navigation):
        begin_navigation(bias, air.navigation, aside)
    states[0] = loop.states[0]
    before = loop.controls[0].copy()
    for i in range(n):
        deviation(states[i], loop.states[i], e)
        if len(air.filters):
            advance_gust(gust, air.filters[i], seed, wind)
            _push(loop, i, air.drag, wind, states[i], push)
        if len(air.navigation) and i % air.update == 0:
            advance_navigation(bias, air.navigation, aside, error)
        r = loop.states[i, 3:7]
        x, y, z = rotated(-r[0], -r[1], -r[2], r[3], error[0], error[1], error[2])
        e[0], e[1], e[2] = e[0] + x, e[1] + y, e[2] + z
        e[3:9] += error[3:9]
        _level(e, loop.states[i])
        _correct(loop, i, e, before, controls[i])
        before[:] = controls[i]
        u, s = controls[i], states[i]
        t1, t2, t3, f1, f2, f3 = wrench(u[0], u[1], u[2], u[3], loop.given)
        load = t1, t2, t3, f1 + push[0], f2 + push[1], f3 + push[2]
        after = advanced(
            s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], s[9], s[10], s[11], s[12],
            load, loop.dt, loop.given,
        )  # fmt: skip
        for j in range(13):
            states[i + 1, j] = after[j]
    return states, controls


@numba.njit
def _push(loop, i, drag, wind, state, push):
    q1, q2, q3, q4 = -state[3], -state[4], -state[5], state[6]
    w = rotated(q1, q2, q3, q4, wind[0], wind[1], wind[2])
    v = loop.velocities[i]
    v = rotated(q1, q2, q3, q4, v[0], v[1], v[2])
    for j in range(3):
        damping = max(drag[j] - loop.given[DRAG + j], 0.0)
        push[j] = drag[j] * w[j] - damping * (state[7 + j] - v[j])


@numba.njit
def _level(e, reference):
    """By the quaternion of the rotation vector, and the library's rotation."""
    v1, v2, v3 = reference[7] + e[6], reference[8] + e[7], reference[9] + e[8]
    angle = math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
    s = 0.5 if angle == 0.0 else math.sin(0.5 * angle) / angle
    v = rotated(s * e[3], s * e[4], s * e[5], math.cos(0.5 * angle), v1, v2, v3)
    for j in range(3):
        e[6 + j] = v[j] - reference[7 + j]


@numba.njit
def _correct(loop, i, e, before, control):
    for j in range(4):
        gain, most = loop.gains[i, j], loop.most[i, j]
        outer = min(max((gain[:3] * e[:3]).sum(), -PLACE * most), PLACE * most)
        outer = min(max(outer + (gain[6:9] * e[6:9]).sum(), -most), most)
        u = loop.controls[i, j] - outer - (gain[3:6] * e[3:6]).sum() - (gain[9:] * e[9:]).sum()
        u = min(max(u, before[j] - loop.change[j]), before[j] + loop.change[j])
        control[j] = min(max(u, loop.low[j]), loop.high[j])
