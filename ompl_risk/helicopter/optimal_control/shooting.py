"""Multiple shooting: the manoeuvre between two trims as a nonlinear program for IPOPT."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.helicopter.optimal_control import dynamics
from ompl_risk.helicopter.optimal_control.constraints import Constraints
from ompl_risk.helicopter.optimal_control.course import Course
from ompl_risk.helicopter.optimal_control.needs import casadi
from ompl_risk.helicopter.optimal_control.task import RATES, SPEEDS, STATE, Task, Z
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle

MARGIN = 1e-6
"""Share of every limit that is left for the last corrections."""

SMOOTHING = 1e-6
"""Price of a squared change of the inputs, in full ranges, against a second of duration."""

LEAST_STEP, MOST_STEP = 1e-4, 0.2  # of a step whose length is sought [s]: longer ones are not exact
IPOPT = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-9,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.max_iter": 500,
}

INTERRUPTED = "NonIpopt_Exception_Thrown"
"""What CasADi makes of Ctrl-C; these expressions throw nothing else."""


class Attempt(NamedTuple):
    """What the solver has found.

    Args:
        course: the flight.
        solved: whether it is feasible and a minimum, to the tolerance of the solver.
        status: how the solver puts it.
        iterations: how many it took.
    """

    course: Course
    solved: bool
    status: str
    iterations: int


class Shooting:
    """The flight from one trim into another in so many steps, as a nonlinear program.

    ::

        minimise    n h + SMOOTHING s          (h sought)    or    s    (h given)
        with        s = sum_k |(u_{k+1} - u_k) / range|^2
        subject to  x_{k+1} = step(x_k, u_k, h),  x_0 in the first trim,  x_n in the last one
                    inputs, their rates, attitude, speed and angular velocity within
                    the limits less the reserve

    The rates of the inputs count from the first trim's input, and to the last one's.

    Args:
        task: the two trims.
        vehicle: what flies.
        steps: number of steps n.
        step: duration h of one [s]; None: sought.

    Raises:
        ExtraError: CasADi is not installed.

    Reference:
        Bock & Plitt, A multiple shooting algorithm for direct solution of optimal control
        problems, IFAC World Congress, 1984.
    """

    def __init__(self, task: Task, vehicle: Vehicle, steps: int, step: float | None = None) -> None:
        self._task, self._vehicle, self._steps = task, vehicle, steps
        self._motion = task.motion
        self._range = self._of_controls(vehicle.ranges)
        self._step = (LEAST_STEP, MOST_STEP) if step is None else (step, step)
        self._solver, self._constraints = self._program(sought=step is None)

    def solve(self, start: Course) -> Attempt:
        """Improve on a first guess of as many steps."""
        states = start.states[1:, self._motion.states]
        controls = start.controls[:, self._motion.controls] / self._range
        least, most = self._bounds()
        found = self._solver(
            x0=np.concatenate([[start.step], controls.ravel(), states.ravel()]),
            lbx=least,
            ubx=most,
            lbg=self._constraints.low,
            ubg=self._constraints.high,
        )
        stats = self._solver.stats()
        if stats["return_status"] == INTERRUPTED:
            raise KeyboardInterrupt
        course = self._course(np.array(found["x"]).ravel())
        return Attempt(course, stats["success"], stats["return_status"], stats["iter_count"])

    def _program(self, *, sought: bool) -> tuple[Any, Constraints]:
        """The solver, and the bounds of its constraints."""
        ca = casadi()
        nx, nu, n = len(self._motion.states), len(self._motion.controls), self._steps
        h, X, U = ca.MX.sym("h"), ca.MX.sym("X", nx, n), ca.MX.sym("U", nu, n)
        start = self._task.first.state()[list(self._motion.states)]
        before = ca.horzcat(start, X[:, : n - 1])
        step, inside, end = self._functions()
        changes = self._changes(U)
        within = h * ca.repmat(ca.DM(self._fastest_changes()), 1, n + 1)
        constraints = Constraints()
        constraints.add(step.map(n)(before, U, ca.repmat(h, 1, n)) - X, 0.0, 0.0)
        constraints.add(end(X[:, n - 1]), 0.0, 0.0)
        constraints.add(changes - within, -math.inf, 0.0)
        constraints.add(changes + within, 0.0, math.inf)
        constraints.add(inside.map(n)(X), -math.inf, 0.0)
        smooth = ca.sumsqr(changes)
        cost = n * h + SMOOTHING * smooth if sought else smooth
        unknowns = ca.vertcat(h, ca.vec(U), ca.vec(X))
        program = {"x": unknowns, "f": cost, "g": constraints.g}
        return ca.nlpsol("manoeuvre", "ipopt", program, IPOPT), constraints

    def _functions(self) -> tuple[Any, Any, Any]:
        """A step, what must not be above 0 in a state, and what must be 0 in the last one."""
        ca = casadi()
        x = ca.SX.sym("x", len(self._motion.states))
        u, h = ca.SX.sym("u", len(self._motion.controls)), ca.SX.sym("h")
        state = ca.vertcat(*self._motion.whole_state(x))
        control = ca.vertcat(*self._motion.whole_control(u * ca.DM(self._range)))
        after = dynamics.step(state, control, h, self._vehicle.helicopter)
        kept = ca.vertcat(*(after[i] for i in self._motion.states))
        return (
            ca.Function("step", [x, u, h], [kept]),
            ca.Function("inside", [x], [self._excess(state)]),
            ca.Function("end", [x], [ca.vertcat(*self._missing(state))]),
        )

    def _changes(self, U: Any) -> Any:
        """Changes of the inputs from each step to the next, trims included, in ranges."""
        ca = casadi()
        first = self._of_controls(self._task.first.control) / self._range
        last = self._of_controls(self._task.last.control) / self._range
        return ca.horzcat(U, last) - ca.horzcat(first, U)

    def _fastest_changes(self) -> FloatArray:
        """Greatest rates of the inputs, in ranges [1/s]."""
        rates = self._vehicle.kept.control_rates(self._vehicle.helicopter)
        return self._of_controls(rates) / self._range * (1.0 - MARGIN)

    def _excess(self, state: Any) -> Any:
        """At most 0 where attitude and speed are within the limits; of the order of 1."""
        ca, limits = casadi(), self._vehicle.kept
        upward = dynamics.rotation(state)[2, 2]
        fast = ca.sumsqr(state[SPEEDS:RATES]) / limits.speed**2
        return ca.vertcat(math.cos(limits.attitude) + MARGIN - upward, fast - (1.0 - MARGIN))

    def _missing(self, state: Any) -> list[Any]:
        """What separates a state from the last trim, but for the place and a free heading.

        q q_trim^-1 turns about the vertical where the heading is free, and not at all elsewhere.
        """
        end = self._task.last.state()
        inverse = [-end[3], -end[4], -end[5], end[6]]
        turned = dynamics.product([state[i] for i in range(3, SPEEDS)], inverse)
        attitude = turned[:2] if self._task.turning else [turned[1]]
        rest = [state[i] - float(end[i]) for i in self._motion.states if i >= SPEEDS]
        return [*attitude, *rest, *([state[Z]] if self._task.level else [])]

    def _bounds(self) -> tuple[FloatArray, FloatArray]:
        """Least and greatest values of the unknowns."""
        n, limits = self._steps, self._vehicle.kept
        low, high = map(self._of_controls, limits.controls(self._vehicle.helicopter))
        margin = MARGIN * (high - low)
        bound = np.full(STATE, math.inf)
        bound[RATES:] = limits.rate * (1.0 - MARGIN)
        if self._task.level:
            bound[Z] = self._vehicle.height
        states = np.tile(bound[list(self._motion.states)], n)
        return (
            np.concatenate([[self._step[0]], np.tile((low + margin) / self._range, n), -states]),
            np.concatenate([[self._step[1]], np.tile((high - margin) / self._range, n), states]),
        )

    def _of_controls(self, values: FloatArray) -> FloatArray:
        return values[list(self._motion.controls)]

    def _course(self, unknowns: FloatArray) -> Course:
        n, split = self._steps, 1 + self._steps * len(self._motion.controls)
        controls, states = np.zeros((n, 4)), np.zeros((n + 1, STATE))
        states[0] = self._task.first.state()
        controls[:, self._motion.controls] = unknowns[1:split].reshape(n, -1) * self._range
        states[1:, self._motion.states] = unknowns[split:].reshape(n, -1)
        return Course(float(unknowns[0]), controls, states)
