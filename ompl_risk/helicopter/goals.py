"""Where the helicopter should get to, and how fast it should be there."""

from __future__ import annotations

import math
from itertools import cycle
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob
from scipy.spatial.transform import Rotation

from ompl_risk._arrays import FloatArray, positive, real_number
from ompl_risk._kernels import flight_checks
from ompl_risk.bridge import faults
from ompl_risk.bridge.buffers import Buffer, table
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.model import STATE, as_state, world_velocity
from ompl_risk.helicopter.validity import HelicopterValidityChecker

HEADINGS = 16
"""Headings with which a hover may be reached."""

STILL = 1e-9
"""Velocities [m/s] and angular velocities [rad/s] up to which a state hovers."""


class HelicopterGoal(ob.GoalSampleableRegion):
    """Near a position, at nearly a velocity.

    ::

        max(|x - x*| / radius, |R v - u*| / tolerance) <= 1

    with u* the velocity in the world. A hover is u* = 0, its tolerance the greatest speed. The
    orientation does not count. Planners that sample goals get the state in the middle, and if it
    hovers the same with other headings, all round; so it must be valid, which is checked if the
    space information has its checker already.

    Args:
        si: over a space from ``state_space``.
        state: in the middle, shape (13,), or a position to hover at, shape (3,) [m].
        radius: greatest distance from its position [m].
        tolerance: greatest difference from its velocity [m/s]; inf if any will do.

    Raises:
        ArgumentError: no state, a radius or tolerance out of range, or a state in the middle that
            breaks a limit, lies outside the box or below ground.

    Attributes:
        state: in the middle, read-only, shape (13,).
        radius: see above.
        tolerance: see above.
    """

    def __init__(
        self,
        si: ob.SpaceInformation,
        state: ArrayLike,
        *,
        radius: float = 5.0,
        tolerance: float = 2.0,
    ) -> None:
        super().__init__(si)
        checker = si.getStateValidityChecker()
        known = isinstance(checker, HelicopterValidityChecker)
        self.state = checker.check("goal", state) if known else as_state("goal", state)
        self.radius = positive("radius", radius)
        self.tolerance = _tolerance(tolerance)
        self.setThreshold(1.0)
        space: Any = si.getStateSpace()
        self._read, self._write = space.serialize, space.deserialize
        self._here, self._middle = Buffer(STATE), Buffer(STATE)
        self._samples = _all_round(self.state)
        self._next = cycle(range(len(self._samples)))
        self._wanted = np.array(
            [*self.state[:3], *world_velocity(self.state), self.radius, self.tolerance]
        )
        self._places = table(self._here.address, self._wanted.ctypes.data)

    def distanceGoal(self, state: ob.State) -> float:
        """The larger of the two misses, in units of what is allowed."""
        try:
            self._read(self._here.capsule, state)
            return flight_checks.miss(self._places.ctypes.data)
        except BaseException as error:
            if not faults.keep(error):
                raise
            return math.inf

    def sampleGoal(self, state: ob.State) -> None:
        """Write the state in the middle, each time with the next heading if it hovers."""
        try:
            self._middle.numbers[:] = self._samples[next(self._next)]
            self._write(state, self._middle.capsule)
        except BaseException as error:
            if not faults.keep(error):
                raise

    def maxSampleCount(self) -> int:
        """One, or as many as there are headings to hover with."""
        return len(self._samples)


def _all_round(state: FloatArray) -> FloatArray:
    """The state, and if it hovers the same with other headings, shape (n, 13)."""
    if np.abs(state[7:]).max() > STILL:
        return state[None].copy()
    angles = 2.0 * np.pi * np.arange(HEADINGS) / HEADINGS
    turns = Rotation.from_rotvec(angles[:, None] * np.array([0.0, 0.0, 1.0]))
    states = np.tile(state, (HEADINGS, 1))
    states[:, 3:7] = (turns * Rotation.from_quat(state[3:7])).as_quat()
    states[0] = state
    return states


def _tolerance(value: float) -> float:
    allowed = "a speed above 0 [m/s], or inf"
    tolerance = real_number("tolerance", value, allowed)
    if not tolerance > 0.0:
        raise ArgumentError("tolerance", value, allowed)
    return tolerance
