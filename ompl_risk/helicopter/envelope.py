"""Where, and how, the helicopter may fly: its limits within a box."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, readonly
from ompl_risk._kernels import flight_checks
from ompl_risk._kernels.flight_checks import OUTSIDE, TILTED, TOO_FAST, TURNS_TOO_FAST
from ompl_risk._kernels.motion import CONTACT
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight_limits import SLACK
from ompl_risk.helicopter.model import as_state
from ompl_risk.helicopter.parameters import Limits


@dataclass(frozen=True, eq=False, init=False)
class Envelope(ReadOnlyArrays):
    """States that keep the limits and lie in a box.

    ::

        |v| <= speed,  |omega_k| <= rate,  angle of the body's upward axis to the vertical <=
        attitude,  low <= x <= high

    Args:
        low: least position [m], shape (3,).
        high: greatest position [m], shape (3,).
        limits: what the helicopter may do.

    Raises:
        ArgumentError: a wrong shape, or a box without volume.
    """

    low: FloatArray
    high: FloatArray
    limits: Limits

    def __init__(self, low: ArrayLike, high: ArrayLike, limits: Limits | None = None) -> None:
        lowest = readonly("low", low, (3,), "(3,): x, y, z [m]")
        highest = readonly("high", high, (3,), "(3,): x, y, z [m]")
        if not (lowest < highest).all():
            allowed = f"above low = {lowest.tolist()} in every coordinate"
            raise ArgumentError("high", highest.tolist(), allowed)
        object.__setattr__(self, "low", lowest)
        object.__setattr__(self, "high", highest)
        object.__setattr__(self, "limits", Limits() if limits is None else limits)

    def given(self, radius: float = 0.0) -> FloatArray:
        """The same as kernels take it, for a body of this radius [m]; rounding is forgiven."""
        limits = self.limits
        slack = 1.0 + SLACK
        upright = math.cos(min(limits.attitude * slack, math.pi))
        head = [limits.speed * slack, limits.rate * slack, upright]
        values = [*head, *self.low, *self.high, radius, CONTACT]
        return readonly("allowed", values, (flight_checks.ALLOWED,), "(11,)")

    def contains(self, state: ArrayLike) -> bool:
        """Whether a state, shape (13,), is one of these."""
        return flight_checks.first_fault(as_state("state", state), self.given()) == 0

    def check(self, name: str, value: ArrayLike) -> FloatArray:
        """A state that is one of these, read-only.

        Args:
            name: what errors call it.
            value: a state, shape (13,), or a position to be at rest at, shape (3,) [m].

        Raises:
            ArgumentError: it is no state, or breaks a limit; the message has both.
        """
        state = as_state(name, value)
        fault = flight_checks.first_fault(state, self.given())
        limits, x = self.limits, state[:3]
        up = 1.0 - 2.0 * (state[3] ** 2 + state[4] ** 2)
        if fault == TOO_FAST:
            speed = float(np.linalg.norm(state[7:10]))
            raise ArgumentError(f"speed of {name}", speed, f"at most {limits.speed:g} m/s")
        if fault == TURNS_TOO_FAST:
            rate = float(np.abs(state[10:]).max())
            allowed = f"at most {limits.rate:g} rad/s about any axis of the body"
            raise ArgumentError(f"rate of {name}", rate, allowed)
        if fault == TILTED:
            angle = math.acos(min(max(up, -1.0), 1.0))
            allowed = f"at most {limits.attitude:g} rad from the vertical"
            raise ArgumentError(f"attitude of {name}", angle, allowed)
        if fault == OUTSIDE:
            allowed = f"within {self.low.tolist()} and {self.high.tolist()} m"
            raise ArgumentError(f"position of {name}", x.tolist(), allowed)
        return state
