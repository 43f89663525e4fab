"""A flight: inputs at a fixed rate, the states that they lead through, and what was planned."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly
from ompl_risk._kernels import deviations, rigid_body
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight_limits import (
    broken_in_changes,
    broken_in_controls,
    broken_in_states,
)
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.trajectory import Trajectory


@dataclass(frozen=True)
class Deviation:
    """How far two flights are apart.

    Args:
        distance: [m].
        angle: of the rotation from one attitude to the other [rad].
    """

    distance: float
    angle: float

    @property
    def degrees(self) -> float:
        """The angle in degrees."""
        return math.degrees(self.angle)


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Flight(ReadOnlyArrays):
    """Inputs, each held for ``dt``, and the states that they lead through; arrays are read-only.

    ``planned`` are the states of the ideal route where the flight is meant to be at that moment.
    Planned times are not whole steps: each trim of the route is stretched or shortened to the steps
    that it is flown in, so a manoeuvre is compared with the planned one step by step, also if it
    begins a moment earlier or later. ``delay`` says how much later.

    Args:
        dt: time for which each input is held [s].
        states: at the times 0, dt, ..., n dt, shape (n + 1, 13), see ``rigid_body``.
        controls: u_c, u_psi [N], gamma_p, gamma_r [rad], shape (n, 4).
        planned: the states as planned, shape (n + 1, 13).
        planned_times: when they were planned [s], shape (n + 1,); the times if left out.
        goal: the state in which the planned route ends, shape (13,).
        helicopter: what flew.

    Raises:
        ArgumentError: a wrong shape, no control at all, or a number that is not finite.
    """

    dt: float
    states: FloatArray
    controls: FloatArray
    planned: FloatArray
    planned_times: FloatArray
    goal: FloatArray
    helicopter: Helicopter

    def __init__(
        self,
        dt: float,
        states: ArrayLike,
        controls: ArrayLike,
        planned: ArrayLike,
        *,
        planned_times: ArrayLike | None = None,
        goal: ArrayLike | None = None,
        helicopter: Helicopter | None = None,
    ) -> None:
        controls = readonly("controls", controls, (None, 4), "(n, 4), n >= 1")
        n = len(controls)
        if n == 0:
            raise ArgumentError("controls.shape", controls.shape, "(n, 4), n >= 1")
        times = np.arange(n + 1) * positive("dt", dt) if planned_times is None else planned_times
        planned = readonly("planned", planned, (n + 1, 13), f"({n + 1}, 13)")
        fields = {
            "dt": positive("dt", dt),
            "states": readonly("states", states, (n + 1, 13), f"({n + 1}, 13)"),
            "controls": controls,
            "planned": planned,
            "planned_times": readonly("planned_times", times, (n + 1,), f"({n + 1},)"),
            "goal": readonly("goal", planned[-1] if goal is None else goal, (13,), "(13,)"),
            "helicopter": Helicopter() if helicopter is None else helicopter,
        }
        for field, value in fields.items():
            object.__setattr__(self, field, value)

    def __repr__(self) -> str:
        return f"Flight({len(self)} steps, {self.duration:.6g} s, {self.length:.6g} m)"

    def __len__(self) -> int:
        """Steps."""
        return len(self.controls)

    @cached_property
    def t(self) -> FloatArray:
        """Times of the states [s], shape (n + 1,)."""
        t = np.arange(len(self) + 1, dtype=np.float64) * self.dt
        t.setflags(write=False)
        return t

    @property
    def duration(self) -> float:
        """[s]."""
        return len(self) * self.dt

    @cached_property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(np.linalg.norm(np.diff(self.states[:, :3], axis=0), axis=1).sum())

    @cached_property
    def deviations(self) -> FloatArray:
        """Distance [m] and angle [rad] between flown and planned at every step, (n + 1, 2)."""
        found = deviations.separation(self.states, self.planned)
        found.setflags(write=False)
        return found

    @property
    def deviation(self) -> Deviation:
        """Greatest distance and greatest angle between flown and planned."""
        return Deviation(*self.deviations.max(axis=0).tolist())

    @property
    def delay(self) -> float:
        """By how much the flight is late [s], at worst; negative if it is early."""
        late = self.t - self.planned_times
        return float(late[np.argmax(np.abs(late))])

    @property
    def at_goal(self) -> Deviation:
        """What remains between the last state and the goal, whenever the plan is there."""
        return Deviation(*deviations.separation(self.states[-1:], self.goal[None])[0].tolist())

    def replay(self, helicopter: Helicopter | None = None) -> FloatArray:
        """States under the same inputs from the same start, shape (n + 1, 13).

        Args:
            helicopter: what flies; the one that flew if left out, which leads through the same
                states to the last bit.
        """
        given = (self.helicopter if helicopter is None else helicopter).given
        states = np.empty_like(self.states)
        rigid_body.rollout(self.states[0], self.controls, self.dt, given, states)
        return states

    def check_limits(self, limits: Limits) -> None:
        """Make sure that the whole flight is within the limits.

        Args:
            limits: on inputs, their rates, speed, angular velocity and attitude.

        Raises:
            ArgumentError: names a control or state that is not, and the limit.
        """
        checks = {
            "controls": broken_in_controls(limits, self.helicopter, self.controls),
            "changes of controls": broken_in_changes(
                limits, self.helicopter, self.controls, self.dt
            ),
            "states": broken_in_states(limits, self.states),
        }
        for name, broken in checks.items():
            if broken is not None:
                allowed = f"within {broken.low:g} and {broken.high:g} {broken.unit} ({broken.name})"
                raise ArgumentError(f"{name}[{broken.step}]", broken.value, allowed)

    def trajectory(self, name: str = "", *, step: float | None = None) -> Trajectory:
        """The flown states with attitudes, velocities in the world and controls.

        Args:
            name: what tables and figures call it.
            step: time between samples [s], a multiple of ``dt``, which is the default; the last
                interval may be shorter. Controls are held over the intervals at ``dt``, and the
                samples at their beginnings otherwise.

        Raises:
            ArgumentError: a step that is no multiple.
        """
        every = 1 if step is None else round(positive("step", step) / self.dt)
        if step is not None and (every < 1 or abs(every * self.dt - step) > 1e-9 * step):
            raise ArgumentError("step", step, f"a multiple of dt = {self.dt:g} s")
        kept = np.append(np.arange(0, len(self), every), len(self))
        states = self.states[kept]
        held = self.controls if every == 1 else self.controls[np.minimum(kept, len(self) - 1)]
        return Trajectory(
            self.t[kept],
            states[:, :3],
            name,
            orientations=states[:, 3:7],
            velocities=deviations.velocities_in_world(states),
            controls=held,
        )
