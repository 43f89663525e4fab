"""Attitude and speed of a vehicle along its trajectory, also where the trajectory has none."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from ompl_risk._arrays import FloatArray
from ompl_risk.trajectory import Trajectory


def attitudes(trajectory: Trajectory) -> FloatArray:
    """Quaternions (x, y, z, w), shape (n, 4): the trajectory's, or level ones along the path.

    Where no way is covered over ground, the level ones keep the heading before.
    """
    if trajectory.orientations is not None:
        return trajectory.orientations
    heading = headings(velocities(trajectory))
    return Rotation.from_rotvec(heading[:, None] * [0.0, 0.0, 1.0]).as_quat()


def velocities(trajectory: Trajectory) -> FloatArray:
    """Velocities in the world [m/s], shape (n, 3): the trajectory's, or differences."""
    if trajectory.velocities is not None:
        return trajectory.velocities
    return np.gradient(trajectory.positions, trajectory.t, axis=0)


def headings(ways: FloatArray, start: float = 0.0) -> FloatArray:
    """Directions over ground [rad], continuous; of no way at all, the one before.

    Args:
        ways: displacements or velocities, shape (n, 2) or (n, 3).
        start: the direction as long as there is no way [rad].
    """
    moving = np.hypot(ways[:, 0], ways[:, 1]) > 1e-6
    last = np.maximum.accumulate(np.where(moving, np.arange(len(ways)), -1))
    found = np.arctan2(ways[last, 1], ways[last, 0])
    return np.unwrap(np.where(last >= 0, found, start))


def heading_and_bank(orientation: FloatArray) -> tuple[float, float]:
    """Compass heading [degree, 0 north, 90 east] and bank to the right [degree]."""
    yaw, _, roll = Rotation.from_quat(orientation).as_euler("ZYX")
    return (90.0 - math.degrees(yaw)) % 360.0, math.degrees(roll)
