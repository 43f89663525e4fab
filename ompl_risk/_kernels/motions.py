"""Many straight motions over a height field at a time; see ``motion`` for what is computed."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._kernels.height_field import opened
from ompl_risk._kernels.jit import entry
from ompl_risk._kernels.motion import DEPTH, Motion, bound_between, cost_between, is_free_between
from ompl_risk._kernels.nearest import workspace


@entry
def motion_costs(handle, a, b, given, out):
    """``out[k]`` = cost of the motion from ``a[k]`` to ``b[k]``, shapes (n, 3) [m]."""
    field, (stack, keys), pieces = opened(handle), workspace(), np.empty((DEPTH, 2))
    for k in range(len(a)):
        out[k] = cost_between(Motion(field, stack, keys, pieces, a[k], b[k], given))


@entry
def are_motions_free(handle, a, b, given, out):
    """``out[k]`` = whether every state of the motion from ``a[k]`` to ``b[k]`` is free."""
    field, (stack, keys), pieces = opened(handle), workspace(), np.empty((DEPTH, 2))
    for k in range(len(a)):
        out[k] = is_free_between(Motion(field, stack, keys, pieces, a[k], b[k], given))


@entry
def heuristics(a, b, d0, d1, given, out):
    """``out[k]`` = lower bound for the cost of any way between two states with clearances d [m]."""
    for k in range(len(a)):
        x, y, z = b[k, 0] - a[k, 0], b[k, 1] - a[k, 1], b[k, 2] - a[k, 2]
        out[k] = bound_between(math.sqrt(x * x + y * y + z * z), d0[k], d1[k], given)
