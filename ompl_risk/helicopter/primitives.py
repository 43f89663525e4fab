"""Manoeuvres: flights from one trim to another under inputs of fixed rate, replayed exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly
from ompl_risk._kernels import rigid_body
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight_limits import (
    BrokenLimit,
    broken_in_changes,
    broken_in_controls,
    broken_in_states,
)
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.trims import Trim

DT = 0.02
"""Time for which every input is held [s]: 50 a second."""

_STATE_MIRROR = np.array([1, -1, 1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1], dtype=np.float64)
_CONTROL_MIRROR = np.array([1, -1, 1, -1], dtype=np.float64)


def mirrored_states(states: ArrayLike) -> FloatArray:
    """States with left and right exchanged, y to -y, shape (..., 13)."""
    return np.asarray(states, dtype=np.float64) * _STATE_MIRROR + 0.0


def mirrored_controls(controls: ArrayLike) -> FloatArray:
    """Controls with left and right exchanged, shape (..., 4)."""
    return np.asarray(controls, dtype=np.float64) * _CONTROL_MIRROR + 0.0


def headings(states: FloatArray) -> FloatArray:
    """Angle of the forward axis from east at each state [rad], unwrapped, shape (n,)."""
    x, y, z, w = states[:, 3:7].T
    return np.unwrap(np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z)))


@dataclass(frozen=True, eq=False)
class Manoeuvre(ReadOnlyArrays):
    """A flight from one trim to another: inputs that are held for ``dt`` each, and its states.

    Begun elsewhere, at any heading, it flies the same track to rounding.

    Args:
        number: its place among the manoeuvres of its library.
        first: the trim in whose state it begins, at position 0 and heading 0.
        last: the trim in whose state it ends, elsewhere.
        controls: u_c [N], u_psi [N], gamma_p and gamma_r [rad], shape (n, 4).
        states: what `rigid_body.rollout` makes of them, shape (n + 1, 13).
        dt: time for which each input is held [s].
    """

    number: int
    first: Trim
    last: Trim
    controls: FloatArray
    states: FloatArray
    dt: float

    @property
    def duration(self) -> float:
        """Time that it takes [s]."""
        return len(self.controls) * self.dt

    @cached_property
    def track(self) -> FloatArray:
        """x, y, z [m] and heading [rad], unwrapped, at every step, shape (n + 1, 4)."""
        track = np.column_stack([self.states[:, :3], headings(self.states)])
        track.setflags(write=False)
        return track

    @property
    def displacement(self) -> FloatArray:
        """x, y, z [m] and heading [rad] of its end, seen from its beginning, shape (4,)."""
        return self.track[-1]

    @cached_property
    def fastest(self) -> float:
        """Greatest speed at a step [m/s]."""
        v = self.states[:, 7:10]
        return float(np.sqrt((v * v).sum(axis=1).max()))

    @cached_property
    def miss(self) -> float:
        """Greatest difference of its end from the last trim, in v, omega and the quaternion.

        Place and heading are free [m/s, rad/s, 1].
        """
        wanted = self.last.state(heading=self.track[-1, 3])[3:]
        end = self.states[-1, 3:]
        if end[:4] @ wanted[:4] < 0.0:  # q and -q are the same attitude
            wanted[:4] *= -1.0
        return float(np.abs(end - wanted).max())

    def broken_limit(self, helicopter: Helicopter, limits: Limits) -> BrokenLimit | None:
        """A limit that its states or inputs break, if there is one.

        Changes of the inputs count from the first trim's input and to the last one's.
        """
        whole = np.vstack([self.first.control, self.controls, self.last.control])
        return (
            broken_in_states(limits, self.states)
            or broken_in_controls(limits, helicopter, self.controls)
            or broken_in_changes(limits, helicopter, whole, self.dt)
        )


def replay(
    helicopter: Helicopter,
    first: Trim,
    last: Trim,
    controls: ArrayLike,
    *,
    number: int = 0,
    dt: float = DT,
) -> Manoeuvre:
    """The manoeuvre that inputs make from the state of a trim; `Manoeuvre.miss` judges its end.

    Args:
        helicopter: what flies.
        first: the trim in which it begins.
        last: the trim in which it is meant to end.
        controls: u_c [N], u_psi [N], gamma_p and gamma_r [rad], shape (n, 4), n >= 1.
        number: its place among the manoeuvres of a library.
        dt: time for which each input is held [s].

    Raises:
        ArgumentError: controls of another shape, or a number that is not finite.
    """
    controls = readonly("controls", controls, (None, 4), "(n, 4)")
    if not len(controls):
        raise ArgumentError("controls.shape", controls.shape, "(n, 4) with n >= 1")
    states = np.empty((len(controls) + 1, rigid_body.STATE))
    dt = positive("dt", dt)
    rigid_body.rollout(first.state(), controls, dt, helicopter.given, states)
    states.setflags(write=False)
    return Manoeuvre(number, first, last, controls, states, dt)
