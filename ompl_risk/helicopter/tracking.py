"""Tracking: inputs that keep the vehicle beside a planned flight, whatever is flown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_discrete_are

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import deviations, rigid_body, track
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.poses import moved
from ompl_risk.helicopter.primitives import Manoeuvre
from ompl_risk.helicopter.trims import Trim

DIFFERENCE = 1e-4
"""Half the central differences of the sensitivities."""

TOLERATED = np.repeat([0.5, 0.015, 0.3, 0.05], 3)
"""Deviations that are equally bad: in place [m], attitude [rad], velocity [m/s], rates [rad/s]."""

EFFORT = 0.03
"""Change of an input, as a part of half its range, that is as bad as one of these."""


@dataclass(frozen=True)
class Tracker:
    """Flies along a planned flight, from a state beside it: a linear quadratic regulator.

    ::

        u = planned u - K e,   minimising the integral of |e / tolerated|^2 + |du / effort|^2

    with the deviation e in the body's frame. The gains K follow from the sensitivities along the
    planned flight: one matrix for a trim, one for each step of a manoeuvre. Inputs and their rates
    stay within the limits; what that withholds is one more deviation.

    Args:
        helicopter: what flies.
        limits: what it may do.
        dt: time for which each input is held [s].
    """

    helicopter: Helicopter
    limits: Limits
    dt: float

    def track(
        self,
        motion: Trim | Manoeuvre,
        inputs: FloatArray,
        references: FloatArray,
        state: FloatArray,
        before: FloatArray,
    ) -> tuple[FloatArray, FloatArray]:
        """Controls (n, 4) and states (n + 1, 13) along the references.

        Args:
            motion: what is flown.
            inputs: controls as planned, shape (m, 4), m <= n; the last of them goes on.
            references: states as planned, shape (n + 1, 13).
            state: the vehicle's state, shape (13,).
            before: the control before the first, shape (4,).
        """
        steps = len(references) - 1
        controls, states = np.empty((steps, 4)), np.empty((steps + 1, rigid_body.STATE))
        low, high = self.limits.controls(self.helicopter)
        law = (inputs, _gains(self, motion), units(self.limits, self.helicopter) * EFFORT)
        limits = (low, high, self._change, self.dt, self.helicopter.given)
        track.track(state, before, references, *law, *limits, controls, states)
        return controls, states

    def eased(self, inputs: Sequence[FloatArray]) -> list[FloatArray]:
        """Inputs of manoeuvres flown without a trim between them, within the limits of their rates.

        Each of them may begin and end with the fastest change from and to its trim's input. Where
        one follows another, that makes twice as much.

        Args:
            inputs: of each, shapes (n, 4).
        """
        if not inputs:
            return []
        ends = np.cumsum([len(one) for one in inputs])[:-1]
        return np.split(track.eased(np.concatenate(inputs), self._change), ends)

    @property
    def _change(self) -> FloatArray:
        """Greatest change from one input to the next, shape (4,)."""
        return self.limits.control_rates(self.helicopter) * self.dt


def units(limits: Limits, helicopter: Helicopter) -> FloatArray:
    """Halves of the ranges of the controls, shape (4,)."""
    low, high = limits.controls(helicopter)
    return 0.5 * (high - low)


def trim_sensitivities(
    helicopter: Helicopter, trim: Trim, dt: float, spans: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """A (12, 12) and B (12, 4) of one step in a trim; controls in units of ``spans``."""
    end = moved(np.zeros(4), trim.displacement(dt))
    states = np.stack([trim.state(), trim.state(end[:3], end[3])])
    a, b = deviations.sensitivities(
        states, trim.control[None], dt, helicopter.given, spans, DIFFERENCE
    )
    return a[0], b[0]


class _Law(NamedTuple):
    gain: FloatArray
    cost: FloatArray


@lru_cache(maxsize=512)
def _law(tracker: Tracker, trim: Trim) -> _Law:
    """Gain (1, 4, 12) of a trim that goes on for ever, and its cost matrix (12, 12)."""
    spans = units(tracker.limits, tracker.helicopter) * EFFORT
    a, b = trim_sensitivities(tracker.helicopter, trim, tracker.dt, spans)
    cost = solve_discrete_are(a, b, np.diag(_weights()), np.eye(4))
    return _Law(np.linalg.solve(np.eye(4) + b.T @ cost @ b, b.T @ cost @ a)[None], cost)


@lru_cache(maxsize=512)
def _gains(tracker: Tracker, motion: Trim | Manoeuvre) -> FloatArray:
    if isinstance(motion, Trim):
        return _law(tracker, motion).gain
    spans = units(tracker.limits, tracker.helicopter) * EFFORT
    a, b = deviations.sensitivities(
        motion.states, motion.controls, tracker.dt, tracker.helicopter.given, spans, DIFFERENCE
    )
    return track.backward_gains(a, b, _weights(), _law(tracker, motion.last).cost)


def _weights() -> FloatArray:
    return TOLERATED**-2.0
