"""What the tests of SST's compiled code share."""

import math

import numba
import numpy as np
from sst_scene import rotations

from ompl_risk._kernels.branch import least_cost

WEIGHTS = np.array([1.0, 9.0, 1.0])

entry = numba.njit(error_model="numpy")  # not cached: the library drops only its own stale kernels


def apart(a, b):
    """The metric, by rotation matrices."""
    states = np.vstack([a, b])
    turns = rotations(states)
    angle = np.arccos(np.clip((np.trace(turns[0].T @ turns[1]) - 1.0) / 2.0, -1.0, 1.0))
    chord = 2.0 * math.sin(0.5 * angle)
    p, u, o = (((a - b)[part] ** 2).sum() for part in (slice(3), slice(7, 10), slice(10, 13)))
    return math.sqrt(p + WEIGHTS[0] * u + WEIGHTS[1] * chord**2 + WEIGHTS[2] * o)


def at_rest(x=20.0, y=60.0, z=60.0):
    return np.array([x, y, z, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6])


@entry
def left_to_pay(vehicle, states, rooms, out):
    for k in range(len(states)):
        out[k] = least_cost(vehicle, states[k], rooms[k])
