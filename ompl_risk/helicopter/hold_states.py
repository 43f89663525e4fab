"""Which states the helicopter can be held in: level straight flight, and hover."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, readonly
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.poses import pose_in
from ompl_risk.helicopter.trims import Trim

TOLERANCE = 1e-6
"""How far a state may be from a trim, in quaternion, v [m/s] and omega [rad/s]."""

PARTS = {
    "quaternion x": 3, "quaternion y": 4, "quaternion z": 5, "quaternion w": 6,
    "forward speed [m/s]": 7, "leftward speed [m/s]": 8, "upward speed [m/s]": 9,
    "roll rate [rad/s]": 10, "pitch rate [rad/s]": 11, "yaw rate [rad/s]": 12,
}  # fmt: skip


def held_vertex(library: PrimitiveLibrary, state: ArrayLike) -> FloatArray:
    """The vertex x, y, z, heading, index of the speed that stands for a state, shape (5,).

    Args:
        library: its speeds are those of vertices.
        state: shape (13,).

    Raises:
        ArgumentError: a wrong shape, no unit quaternion, a speed beyond the limits or none of the
            library's, or a state that its trim does not have: names the number that is wrong.
    """
    given = readonly("state", state, (13,), "(13,)")
    norm = float(np.linalg.norm(given[3:7]))
    if abs(norm - 1.0) > TOLERANCE:
        raise ArgumentError("norm of state[3:7]", norm, "1: a unit quaternion (x, y, z, w)")
    index = _speed_index(library, given)
    trim = library.trim(float(library.speeds[index]))
    pose = pose_in(trim, given)
    _check(given, trim, float(pose[3]))
    return np.array([*given[:3], math.remainder(float(pose[3]), 2.0 * math.pi), float(index)])


def _speed_index(library: PrimitiveLibrary, state: FloatArray) -> int:
    speed = float(np.linalg.norm(state[7:10]))
    if speed > library.limits.speed:
        allowed = f"at most limits.speed = {library.limits.speed:g} m/s"
        raise ArgumentError("speed of state [m/s]", speed, allowed)
    index = int(np.abs(library.speeds - speed).argmin())
    if abs(library.speeds[index] - speed) > 2.0 * TOLERANCE:
        there = ", ".join(f"{v:g}" for v in library.speeds.tolist())
        allowed = f"one of {there} m/s: no other state can be held in level straight flight"
        raise ArgumentError("speed of state [m/s]", speed, allowed)
    return index


def _check(state: FloatArray, trim: Trim, heading: float) -> None:
    wanted = trim.state(state[:3], heading)
    if wanted[3:7] @ state[3:7] < 0.0:  # q and -q are the same attitude
        wanted[3:7] *= -1.0
    apart = np.abs(state - wanted)
    worst = int(apart[3:].argmax()) + 3
    if apart[worst] > TOLERANCE:
        name = next(part for part, place in PARTS.items() if place == worst)
        allowed = (
            f"{wanted[worst]:.9g}, within {TOLERANCE:g}: no trim holds another state "
            f"at {trim.speed:g} m/s"
        )
        raise ArgumentError(f"{name} of state", float(state[worst]), allowed)
