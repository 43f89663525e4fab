"""One branch of a tree of flights: an act flown from a state, checked and paid for step by step."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.buckets import set_row
from ompl_risk._kernels.flight_checks import FINE, RADIUS, SPEED, fault
from ompl_risk._kernels.height_field import HeightField, opened
from ompl_risk._kernels.inner_loop import inputs
from ompl_risk._kernels.integrand import FAR, NUMBERS, avoid, least_integral
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.motion import CONTACT
from ompl_risk._kernels.nearest import signed_distance, workspace
from ompl_risk._kernels.propagation import world_velocity
from ompl_risk._kernels.rigid_body import step

AHEAD = 40.0
"""How much farther than needed a distance is measured [m]: so far it need not be measured again."""

# places in the settings, behind those of the integrand
DT, HOLD, POWER, TAU, WEIGHT = range(NUMBERS, NUMBERS + 5)
SETTINGS = NUMBERS + 5
"""Numbers in the settings: the integrand (all 0 if risk does not count), time step [s] and steps
for which inputs are held, exponent and tau [s] of the norm, cost of a second."""

GOAL, GOAL_ROOM = 9, 8
"""Numbers in a goal: position [m] and velocity in the world [m/s], tolerances of both, and the
clearance of the position [m]."""


class Vehicle(NamedTuple):
    """All that a branch needs to know.

    Attributes:
        given: parameters of the vehicle.
        allowed: see ``flight_checks``.
        low, high: range of the inputs, shapes (4,).
        loop: settings of the inner loop.
        goal: see ``GOAL``.
        settings: see ``SETTINGS``.
    """

    given: NDArray[np.float64]
    allowed: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    loop: NDArray[np.float64]
    goal: NDArray[np.float64]
    settings: NDArray[np.float64]


class Ground(NamedTuple):
    """The height field, and the work space of a distance query."""

    field: HeightField
    stack: NDArray[np.int64]
    keys: NDArray[np.float64]


@kernel
def room_at(vehicle, ground, state, bound):
    """Clearance d [m] of a state, at most ``bound``."""
    radius = vehicle.allowed[RADIUS]
    d = signed_distance(
        ground.field, state[0], state[1], state[2], bound + radius, ground.stack, ground.keys
    )
    return d - radius


@kernel
def least_cost(vehicle, state, room):
    """Lower bound for what is left to pay from a state with clearance ``room`` to the goal.

    No flight is faster than the top speed. So it takes a time, and in the end, before which d is no
    more than at the goal and the way from there, some risk, ``integral of f^p``. For tau > 0 the
    risk is also at least what f has to rise: ``f^2 + tau^2 f'^2 >= tau |(f^2)'|``.
    """
    goal, settings, speed = vehicle.goal, vehicle.settings, vehicle.allowed[SPEED]
    x, y, z = state[0] - goal[0], state[1] - goal[1], state[2] - goal[2]
    left = max(math.sqrt(x * x + y * y + z * z) - goal[6], 0.0)
    least = settings[WEIGHT] * left / speed
    far, d = settings[FAR], goal[GOAL_ROOM] + goal[6]
    if not 0.0 < d < far:
        return least
    f, last = avoid(max(room, CONTACT), settings), avoid(d, settings)
    rise = settings[TAU] * max(last * last - f * f, 0.0)
    return least + max(rise, least_integral(d, left, settings[POWER], settings) / speed)


@kernel
def is_reached(vehicle, state):
    """Whether a state is in the goal."""
    goal = vehicle.goal
    x, y, z = state[0] - goal[0], state[1] - goal[1], state[2] - goal[2]
    if not math.sqrt(x * x + y * y + z * z) <= goal[6]:
        return False
    u1, u2, u3 = world_velocity(state)
    u1, u2, u3 = u1 - goal[3], u2 - goal[4], u3 - goal[5]
    return math.sqrt(u1 * u1 + u2 * u2 + u3 * u3) <= goal[7]


@kernel
def risk_of_step(f0, f1, dt, p, tau):
    """Integral of f^p + tau^2 f'^2 over a step in which f >= 0 runs straight, exact."""
    if p == 2.0:
        rise = f1 - f0
        return dt * (f0 * f0 + f0 * f1 + f1 * f1) / 3.0 + tau * tau * rise * rise / dt
    most, q = max(f0, f1), p + 1.0
    fall = (most - min(f0, f1)) / most
    if fall == 0.0:
        return dt * most**p
    return dt * most**p * -math.expm1(q * math.log1p(-fall)) / (q * fall)


@kernel
def fly(vehicle, ground, state, room, act, steps, budget, control, controls, states):
    """Fly an act from a state, until the goal at most.

    Between two steps h apart d stays above ``(d0 + d1 - h) / 2``, which must be positive: no
    obstacle is jumped over. Distances that cannot matter are not measured.

    Args:
        vehicle, ground: the problem.
        state: where it begins, and where it ended.
        room: clearance at the beginning [m]; a lower bound will do where no risk depends on it.
        act: what to do.
        steps: for how long, a multiple of the steps that inputs are held.
        budget: the cost of branch and rest must stay below.
        control: work space, shape (4,).
        controls, states: where the inputs and states of every step go if long enough.

    Returns:
        Steps that were flown, 0 if it is not allowed; cost; room at the end; whether the goal is
        reached.
    """
    settings = vehicle.settings
    dt, hold, far, weight = settings[DT], int(settings[HOLD]), settings[FAR], settings[WEIGHT]
    watch = max(far, vehicle.allowed[SPEED] * dt)
    f, cost = avoid(room, settings), 0.0
    for k in range(steps):
        if k % hold == 0:
            inputs(act, state, vehicle.given, vehicle.low, vehicle.high, vehicle.loop, control)
        if k < len(controls):
            set_row(controls, k, control)
        x, y, z = state[0], state[1], state[2]
        step(state, control, dt, vehicle.given, state)
        if fault(state, vehicle.allowed) != FINE:
            return 0, math.inf, 0.0, False
        if k < len(states):
            set_row(states, k, state)
        h = math.sqrt((state[0] - x) ** 2 + (state[1] - y) ** 2 + (state[2] - z) ** 2)
        before, room = room, room - h
        if room < watch:
            room = room_at(vehicle, ground, state, watch + AHEAD)
            if room <= CONTACT or before + room <= h:
                return 0, math.inf, 0.0, False
        cost += weight * dt
        if far > 0.0:
            f0, f = f, avoid(room, settings)
            if f0 > 0.0 or f > 0.0:
                cost += risk_of_step(f0, f, dt, settings[POWER], settings[TAU])
        if (k + 1) % hold == 0:
            if cost + least_cost(vehicle, state, room) >= budget:
                return 0, math.inf, 0.0, False
            if is_reached(vehicle, state):
                return k + 1, cost, room, True
    return steps, cost, room, False


@entry
def fly_again(vehicle, handle, state, room, act, steps, controls, states):
    """Write the inputs and states of a branch that was flown before; returns as ``fly``."""
    stack, keys = workspace()
    ground, control = Ground(opened(handle), stack, keys), np.empty(4)
    now = state.copy()
    return fly(vehicle, ground, now, room, act, steps, math.inf, control, controls, states)


@entry
def first_room(vehicle, handle, state):
    """Clearance of a state as branches measure it; not positive if it is not allowed."""
    stack, keys = workspace()
    if fault(state, vehicle.allowed) != FINE:
        return -math.inf
    far = max(vehicle.settings[FAR], vehicle.allowed[SPEED] * vehicle.settings[DT])
    return room_at(vehicle, Ground(opened(handle), stack, keys), state, far + AHEAD)
