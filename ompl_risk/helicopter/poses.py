"""Poses x, y, z [m] and heading [rad], and displacements, which are poses seen from a pose."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.helicopter.trims import Trim


def moved(pose: FloatArray, displacement: FloatArray) -> FloatArray:
    """The pose that a displacement leads to, shape (4,)."""
    c, s = math.cos(pose[3]), math.sin(pose[3])
    x, y, z, turn = displacement
    return np.array([pose[0] + c * x - s * y, pose[1] + s * x + c * y, pose[2] + z, pose[3] + turn])


def seen_from(pose: FloatArray, other: FloatArray) -> FloatArray:
    """The displacement from ``pose`` to ``other``, its turn within -pi and pi, shape (4,)."""
    c, s = math.cos(pose[3]), math.sin(pose[3])
    x, y, z, turn = other - pose
    return np.array([c * x + s * y, c * y - s * x, z, math.remainder(turn, 2.0 * math.pi)])


def pose_in(trim: Trim, state: FloatArray) -> FloatArray:
    """The pose at which a trim's state comes nearest to a state, shape (4,)."""
    x, y, z, w = trim.orientation.tolist()
    a, b, c, d = state[3:7].tolist()
    upward = -a * y + b * x + c * w - d * z  # of q q0^-1, which turns about the vertical
    scalar = a * x + b * y + c * z + d * w
    return np.array([*state[:3], 2.0 * math.atan2(upward, scalar)])
