"""Rollouts of a point mass beside a planned motion, in gusts, by an estimate of its state."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.closed_loop import ASIDE, LOST
from ompl_risk._kernels.gusts import GUST, advance_gust, begin_gust
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.navigation import NAVIGATION, advance_navigation, begin_navigation
from ompl_risk._kernels.watch import begin_watch, lose, opened_watch, watched


class PointLoop(NamedTuple):
    """A planned motion and the law that keeps a point mass beside it.

    Attributes:
        positions: planned [m], shape (n + 1, 3).
        velocities: planned [m/s], shape (n + 1, 3), with
            ``positions[i + 1] = positions[i] + dt velocities[i + 1]``.
        directions: cosine and sine of the direction of flight, shape (n, 2).
        position_gain: [1/s^2].
        velocity_gain: [1/s].
        limit: greatest acceleration that can be commanded [m/s^2].
        mass: [kg].
        dt: the step [s].
    """

    positions: NDArray[np.float64]
    velocities: NDArray[np.float64]
    directions: NDArray[np.float64]
    position_gain: float
    velocity_gain: float
    limit: float
    mass: float
    dt: float


@entry
def roll_out_point(loop, air, first, last, record):
    """Fly rollouts ``first`` to ``last - 1``, with random numbers as ``closed_loop.roll_out``."""
    n, watch = len(loop.directions), opened_watch(air.handle)
    state, command = np.empty(6), np.empty(3)
    gust, wind = np.zeros(GUST), np.zeros(3)
    bias, error = np.zeros(NAVIGATION), np.zeros(NAVIGATION)
    seed, aside = np.empty(1, np.uint64), np.empty(1, np.uint64)
    gusty, uncertain = len(air.filters) > 0, len(air.navigation) > 0
    for k in range(first, last):
        seed[0], aside[0] = air.seeds[k], air.seeds[k] ^ ASIDE
        state[:3], state[3:] = loop.positions[0], loop.velocities[0]
        if gusty:
            begin_gust(gust, air.filters[0], seed)
        if uncertain:
            begin_navigation(bias, air.navigation, aside)
        going = begin_watch(watch, air, k, state, loop.dt, record)
        i = 0
        while going and i < n:
            if not _distance(state, loop.positions[i]) < LOST:  # nor if it is NaN
                lose(watch, air, k, state, record)
                break
            if gusty:
                advance_gust(gust, air.filters[i], seed, wind)
            if uncertain and i % air.update == 0:
                advance_navigation(bias, air.navigation, aside, error)
            _command(loop, i, state, error, command)
            _advance(loop, i, air.drag, wind, command, state)
            i += 1
            going = watched(watch, air, k, state, i == n, record)


@kernel
def _distance(state, position):
    dx, dy, dz = state[0] - position[0], state[1] - position[1], state[2] - position[2]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def _command(loop, i, state, error, command):
    """The acceleration of step i: as planned, less the gains times the believed deviation."""
    c, s = loop.directions[i, 0], loop.directions[i, 1]
    misled = c * error[6] - s * error[7], s * error[6] + c * error[7], error[8]
    size = 0.0
    for j in range(3):
        change = (loop.velocities[i + 1, j] - loop.velocities[i, j]) / loop.dt
        away = state[j] + error[j] - loop.positions[i, j]
        faster = state[3 + j] + misled[j] - loop.velocities[i, j]
        command[j] = change - loop.position_gain * away - loop.velocity_gain * faster
        size += command[j] * command[j]
    size = math.sqrt(size)
    if size > loop.limit:
        for j in range(3):
            command[j] *= loop.limit / size


@kernel
def _advance(loop, i, drag, wind, command, state):
    """One step: the air pushes with what it moves past the vehicle more than planned."""
    c, s = loop.directions[i, 0], loop.directions[i, 1]
    x = wind[0] - state[3] + loop.velocities[i, 0]
    y = wind[1] - state[4] + loop.velocities[i, 1]
    z = wind[2] - state[5] + loop.velocities[i, 2]
    forward, left = drag[0] * (c * x + s * y), drag[1] * (c * y - s * x)
    state[3] += loop.dt * (command[0] + (c * forward - s * left) / loop.mass)
    state[4] += loop.dt * (command[1] + (s * forward + c * left) / loop.mass)
    state[5] += loop.dt * (command[2] + drag[2] * z / loop.mass)
    for j in range(3):
        state[j] += loop.dt * state[3 + j]
