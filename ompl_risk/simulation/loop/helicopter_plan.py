"""The helicopter's plan: a flight, and the feedback that keeps the vehicle beside it."""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_discrete_are

from ompl_risk._arrays import FloatArray, ReadOnlyArrays
from ompl_risk._kernels import closed_loop, deviations, track
from ompl_risk._kernels.closed_loop import Loop
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.flight_limits import BrokenLimit, broken_in_changes, broken_in_controls
from ompl_risk.helicopter.parameters import Limits
from ompl_risk.helicopter.tracking import DIFFERENCE, units
from ompl_risk.simulation.loop.air import Air
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.plans import Plan

TOLERATED = np.repeat([1.0, 0.3, 2.0, 1.0], 3)
"""Deviations that are equally bad: in place [m], attitude [rad], velocity [m/s], rates [rad/s].

With ``EFFORT`` all modes of the loop lie between 1.3 and 10 rad/s and are damped by 0.7 or more,
from hover to turns at 30 m/s; at three times the effort the fastest is at 20 to 30 rad/s. Noise of
0.5 m in the position at 10 Hz moves the vehicle by 0.12 m. In Dryden gusts of 5 m/s 60 m above the
ground it stays within 5 m of the plan (root mean square), where the limits of the lift count for
more than the gains: 13 m in a turn that takes 1.6 weights of lift, out of 2."""

EFFORT = 0.3
"""Change of an input, as a part of half its range, that is as bad as one of these."""

LEAN = 0.5
"""By how much more or less than planned the vehicle leans in order to get back [rad]."""


class HelicopterPlan(ReadOnlyArrays, Plan):
    """A helicopter that tracks a flight by a time-varying linear quadratic regulator.

    ::

        u_k = planned u_k - K_k (e_k + navigation error)
        minimising the sum of |e / tolerated|^2 + |du / effort|^2

    e is the deviation from the flight's state, 12 numbers in the body's frame of the plan:
    displacement, rotation vector, R_r^T (v - v_r) of the velocities in the world, and rates. K
    follows from the sensitivities A_k, B_k along the flight by the Riccati recursion; after its
    end the cost is that of the last step, repeated for ever. Inputs and their rates stay within
    the limits. What displacement and velocity ask of the rotor's tilt is bounded by what a lean
    of ``LEAN`` asks, 0.6 of it for the displacement alone: a law that asks for more than the rotor
    can do would turn the vehicle over when a gust has carried it far.

    Args:
        flight: the planned states and inputs; what the helicopter would fly undisturbed.
        limits: on inputs and their rates; None: ``Limits()``.
        name: what tables call it.

    Raises:
        ArgumentError: a flight whose own inputs break the limits.

    Example:
        >>> from ompl_risk.helicopter import HelicopterSteering
        >>> steering = HelicopterSteering()
        >>> a = steering.vertex_at((0.0, 0.0, 100.0), 0.0, speed=20.0)
        >>> b = steering.vertex_at((400.0, 100.0, 120.0), 1.0, speed=20.0)
        >>> HelicopterPlan(steering.flight(np.stack([a, b]))).gains.shape[1:]
        (4, 12)

    Reference: Anderson & Moore, Optimal Control: Linear Quadratic Methods, 1990 (regulator over a
    finite horizon); Teel, Global stabilization and restricted tracking for multiple integrators
    with bounded controls, Systems & Control Letters 18, 1992 (nested bounds).
    """

    def __init__(self, flight: Flight, limits: Limits | None = None, name: str = "") -> None:
        limits = Limits() if limits is None else limits
        _check(flight, limits)
        self.flight, self.limits, self.name = flight, limits, name
        self.dt, self.times = flight.dt, flight.t
        self.positions = _closed(flight.states[:, :3])
        self.velocities = _closed(deviations.velocities_in_world(flight.states))
        self.drag = _closed(flight.helicopter.drag)
        self.gains = _closed(gains(flight, limits))
        low, high = limits.controls(flight.helicopter)
        change = limits.control_rates(flight.helicopter) * flight.dt
        self._loop = Loop(
            flight.states, self.velocities, flight.controls, self.gains, _closed(_most(self.gains)),
            _closed(low), _closed(high), _closed(change), flight.helicopter.given, float(flight.dt),
        )  # fmt: skip

    def __repr__(self) -> str:
        return f"HelicopterPlan({self.flight!r}, name={self.name!r})"

    def run(self, air: Air, first: int, last: int, outcomes: Outcomes) -> None:
        """Fly rollouts ``first`` to ``last - 1`` and write their rows; see ``Plan.run``."""
        closed_loop.roll_out(self._loop, air, first, last, outcomes.record)


def gains(flight: Flight, limits: Limits) -> FloatArray:
    """K_k of every step, in the units of the controls, shape (n, 4, 12)."""
    spans = units(limits, flight.helicopter) * EFFORT
    a, b = deviations.sensitivities(
        flight.states, flight.controls, flight.dt, flight.helicopter.given, spans, DIFFERENCE
    )
    turn = _levelling(flight.states)
    back = 2.0 * np.eye(deviations.DEVIATION) - turn  # its inverse
    a, b = turn[1:] @ a @ back[:-1], turn[1:] @ b
    weights = TOLERATED**-2.0
    last = solve_discrete_are(a[-1], b[-1], np.diag(weights), np.eye(4))
    return spans[:, None] * track.backward_gains(a, b, weights, last)


def _most(gains: FloatArray) -> FloatArray:
    """Bounds for what place and velocity ask of the controls, shape (n, 4)."""
    most = np.full(gains.shape[:2], np.inf)
    most[:, 2], most[:, 3] = LEAN * gains[:, 2, 4], LEAN * gains[:, 3, 3]
    return most


def _levelling(states: FloatArray) -> FloatArray:
    """Derivative by e of the deviation that the law sees, shape (n, 12, 12).

    It differs from e in the velocity, which is R_r^T (v - v_r) = de_v + e_r x v_r for small e.
    """
    v1, v2, v3 = states[:, 7:10].T
    turn = np.tile(np.eye(deviations.DEVIATION), (len(states), 1, 1))
    turn[:, 6, 4], turn[:, 6, 5] = v3, -v2
    turn[:, 7, 3], turn[:, 7, 5] = -v3, v1
    turn[:, 8, 3], turn[:, 8, 4] = v2, -v1
    return turn


def _check(flight: Flight, limits: Limits) -> None:
    """Make sure that the limits do not withhold what is planned."""
    broken: BrokenLimit | None = broken_in_controls(limits, flight.helicopter, flight.controls)
    if broken is None and len(flight) > 1:
        broken = broken_in_changes(limits, flight.helicopter, flight.controls, flight.dt)
    if broken is not None:
        allowed = f"{broken.range} ({broken.name}), or pass the limits that it was planned with"
        raise ArgumentError(f"flight.controls[{broken.step}]", broken.value, allowed)


def _closed(values: object) -> FloatArray:
    array = np.array(values, dtype=np.float64, order="C")
    array.setflags(write=False)
    return array
