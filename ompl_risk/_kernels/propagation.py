"""One step of the helicopter between buffers whose addresses are known: OMPL asks for millions."""

from __future__ import annotations

import numpy as np
from numba import carray  # pyright: ignore[reportPrivateImportUsage]

from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.pointers import float64_at, int64_at
from ompl_risk._kernels.rigid_body import PARAMETERS, STATE, rates, step, wrench


@entry
def advance(address, dt):
    """Move the state on by dt [s], in place.

    Args:
        address: of a table: addresses of the state, of the control and of the parameters.
        dt: step, negative to go back [s].
    """
    table = carray(int64_at(address), (3,))
    state = carray(float64_at(table[0]), (STATE,))
    control = carray(float64_at(table[1]), (4,))
    step(state, control, dt, carray(float64_at(table[2]), (PARAMETERS,)), state)


@entry
def derivative(state, control, given):
    """Time derivative of a state, shape (13,)."""
    load = wrench(control[0], control[1], control[2], control[3], given)
    x, y, z, w = state[3], state[4], state[5], state[6]
    v1, v2, v3 = state[7], state[8], state[9]
    o1, o2, o3 = state[10], state[11], state[12]
    return np.array(rates(x, y, z, w, v1, v2, v3, o1, o2, o3, load, given))


@entry
def load_on_body(control, given):
    """Torque [N m] and force [N] of the controls, shape (6,)."""
    return np.array(wrench(control[0], control[1], control[2], control[3], given))


@kernel
def world_velocity(state):
    """R v [m/s], east, north and up."""
    x, y, z, w = state[3], state[4], state[5], state[6]
    v1, v2, v3 = state[7], state[8], state[9]
    return (
        (1.0 - 2.0 * (y * y + z * z)) * v1 + 2.0 * ((x * y - w * z) * v2 + (x * z + w * y) * v3),
        (1.0 - 2.0 * (x * x + z * z)) * v2 + 2.0 * ((x * y + w * z) * v1 + (y * z - w * x) * v3),
        (1.0 - 2.0 * (x * x + y * y)) * v3 + 2.0 * ((x * z - w * y) * v1 + (y * z + w * x) * v2),
    )


@entry
def velocity_in_world(state):
    """R v as an array, shape (3,)."""
    return np.array(world_velocity(state))
