"""Settling: small changes of the inputs that bring the vehicle from near a trim into it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk._kernels import deviations, rigid_body, settle
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.poses import moved
from ompl_risk.helicopter.tracking import trim_sensitivities, units
from ompl_risk.helicopter.trims import Trim

TOLERANCE = 1e-11
"""What a correction leaves of a deviation [m, rad, m/s, rad/s]; in position also some rounding."""

ENOUGH = 100.0
"""Tolerances within which a correction has succeeded: far from the origin, rounding leaves more."""

FEWEST = 15
"""Least number of steps: the first and the last are the trim's, and 12 deviations are to end."""


class Gains(NamedTuple):
    """How a trim answers to small changes: e' = A e + B du a step.

    Attributes:
        a: A, shape (12, 12).
        b: B, controls in halves of their ranges, shape (12, 4).
        inverse: of the Gramian of so many steps, shape (12, 12).
    """

    a: FloatArray
    b: FloatArray
    inverse: FloatArray


@dataclass(frozen=True, eq=False)
class Settled:
    """A flight that ends in a trim.

    Args:
        controls: shape (n, 4).
        states: shape (n + 1, 13).
        left: greatest deviation at the end, in tolerances.
        distance: greatest distance from the trim on the way [m].
        angle: greatest angle from the trim's attitude on the way [rad].
        effort: greatest input or change of an input on the way, as a part of what is allowed.
    """

    controls: FloatArray
    states: FloatArray
    left: float
    distance: float
    angle: float
    effort: float

    @property
    def succeeded(self) -> bool:
        """Whether it ends where it should, within the limits."""
        return self.left <= ENOUGH and self.effort <= 1.0


@dataclass(frozen=True)
class Settler:
    """Finds the inputs that end a deviation from a trim.

    In the frame of the trim the deviation e (position, rotation vector, velocity, rates) of a
    step follows from that of the step before by constant matrices, ``e' = A e + B du``. So ::

        du = -C^T (C C^T)^-1 A^n e,   C = [A^{n-1} B, ..., A B, B]

    ends it after n steps, and among all such changes of the inputs it is the least, measured in
    the inputs' ranges and let in and out over a fifth of the time. What the neglected terms leave
    is removed by Newton's method with the same C and the true flight.

    Args:
        helicopter: what flies.
        limits: what it may do.
        dt: time for which each input is held [s].

    Raises:
        ArgumentError: a time step that is not positive.
    """

    helicopter: Helicopter
    limits: Limits
    dt: float

    def __post_init__(self) -> None:
        positive("dt", self.dt)

    def settle(
        self,
        trim: Trim,
        state: ArrayLike,
        pose: ArrayLike,
        steps: int,
        before: ArrayLike | None = None,
    ) -> Settled:
        """Fly from a state near a trim into the trim; the first and last input are the trim's.

        Args:
            trim: where to end.
            state: the vehicle's state, shape (13,).
            pose: where the trim shall be at the end: x, y, z [m] and heading [rad], shape (4,).
            steps: how many there are for it, at least 15.
            before: the control before the first, shape (4,); the trim's if left out.

        Raises:
            ArgumentError: a wrong shape, or fewer steps.
        """
        if steps < FEWEST:
            raise ArgumentError("steps", steps, f"{FEWEST} or more")
        start = readonly("state", state, (rigid_body.STATE,), "(13,)")
        end = readonly("pose", pose, (4,), "(4,): x, y, z [m], heading [rad]")
        gains = _gains(self, trim, steps)
        tolerances = np.full(deviations.DEVIATION, TOLERANCE)
        # positions are rounded, to whole multiples of this, at every step
        tolerances[:3] += 16.0 * np.spacing(np.abs(end[:3]).max())
        controls, states = np.empty((steps, 4)), np.empty((steps + 1, rigid_body.STATE))
        scales = (units(self.limits, self.helicopter), tolerances, self.dt, self.helicopter.given)
        last = trim.state(end[:3], end[3])
        left = settle.settle(start, trim.control, last, *gains, *scales, controls, states)
        first = moved(end, trim.displacement(-steps * self.dt))
        stride = trim.displacement(self.dt)
        distance, angle = settle.excursion(states, trim.state(), first, stride)
        old = trim.control if before is None else readonly("before", before, (4,), "(4,)")
        return Settled(controls, states, left, distance, angle, self._effort(old, controls))

    def _effort(self, before: FloatArray, controls: FloatArray) -> float:
        """Greatest of inputs and of their changes, as parts of what is allowed."""
        low, high = self.limits.controls(self.helicopter)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        changes = np.abs(np.diff(np.vstack([before, controls]), axis=0)) / self.dt
        rates = self.limits.control_rates(self.helicopter)
        return float(max((np.abs(controls - middle) / half).max(), (changes / rates).max()))


@lru_cache(maxsize=2048)
def _gains(settler: Settler, trim: Trim, steps: int) -> Gains:
    spans = units(settler.limits, settler.helicopter)
    a, b = trim_sensitivities(settler.helicopter, trim, settler.dt, spans)
    gramian = settle.gramian(a, b, steps)
    # entries of very different size: invert what has 1 on its diagonal
    scale = 1.0 / np.sqrt(np.diag(gramian))
    inverse = scale[:, None] * np.linalg.inv(scale[:, None] * gramian * scale) * scale
    return Gains(a, b, inverse)
