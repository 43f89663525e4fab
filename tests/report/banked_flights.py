"""Synthetic flights: a banked circle, and a level line without attitude."""

import numpy as np
from scipy.spatial.transform import Rotation

from ompl_risk import Trajectory

GRAVITY = 9.81


def circling(centre, radius, height, speed, name="A", *, turns=0.75, samples=301, start=0.0):
    """A coordinated level turn to the left: bank angle atan(v^2 / (r g)) to the left."""
    rate = speed / radius
    t = np.linspace(0.0, 2.0 * np.pi * turns / rate, samples)
    angle = start + rate * t
    out = np.stack([np.cos(angle), np.sin(angle), 0.0 * t], axis=1)
    positions = np.array([*centre, height]) + radius * out
    heading = angle + 0.5 * np.pi
    bank = np.arctan2(speed**2, radius * GRAVITY)
    angles = np.stack([heading, 0.0 * t, np.full_like(t, -bank)], axis=1)
    velocities = speed * np.stack([np.cos(heading), np.sin(heading), 0.0 * t], axis=1)
    q = Rotation.from_euler("ZYX", angles).as_quat()
    return Trajectory(t, positions, name, orientations=q, velocities=velocities)


def level(begin, end, speed, name="B"):
    """A straight line, from which only positions are known."""
    return Trajectory.at_constant_speed([begin, end], speed, name)
