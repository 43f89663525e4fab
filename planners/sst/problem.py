"""What SST needs to know of an OMPL problem."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import control as oc

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import rigid_body
from ompl_risk._kernels.branch import DT, HOLD, SETTINGS, Vehicle
from ompl_risk._kernels.flight_checks import HIGH, LOW
from ompl_risk.avoidance.compiled import compiled_form, is_compiled
from ompl_risk.bridge import RiskObjective
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.model import CONTROL, STATE, world_velocity
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.validity import HelicopterValidityChecker
from ompl_risk.motion import Risk

OBJECTIVES = (
    "a RiskObjective with Lp(p), p < inf, or Sobolev(1), an avoidance function of this library and "
    "the clearance of the validity checker; or none, or ob.PathLengthOptimizationObjective, for "
    "the least duration: that is what OMPL calls the length of a PathControl"
)

CHECKERS = "a HelicopterValidityChecker over a TerrainClearance: compiled code cannot ask others"

SAME = 1e-9
"""Difference of two steps that is rounding, relative."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A problem as kernels take it.

    Attributes:
        vehicle: dynamics, limits, goal and cost.
        clearance: of the vehicle.
        risk: how risk is counted; None for the duration alone.
        hover: the input nearest to hover that is allowed, shape (4,).
        longest_hold: steps for which an input may be held.
    """

    vehicle: Vehicle
    clearance: TerrainClearance
    risk: Risk | None
    hover: FloatArray
    longest_hold: int

    @property
    def handle(self) -> NDArray[np.int64]:
        """Of the height field."""
        return self.clearance.handle

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """Least and greatest position [m], shapes (3,)."""
        allowed = self.vehicle.allowed
        return allowed[LOW : LOW + 3], allowed[HIGH : HIGH + 3]

    @property
    def step(self) -> float:
        """Time step [s]."""
        return float(self.vehicle.settings[DT])

    @property
    def hold(self) -> int:
        """Steps for which an input is held at least."""
        return int(self.vehicle.settings[HOLD])

    def cost(self, states: FloatArray) -> float:
        """Cost of a flight from its states alone.

        Args:
            states: at every time step, shape (n, 13).
        """
        t = self.step * np.arange(len(states))
        if self.risk is None or len(t) < 2:
            return float(t[-1]) * (1.0 if self.risk is None else self.risk.weight)
        f = self.risk.avoidance(self.clearance(states[:, :3], bound=2.0 * self.risk.avoidance.d0))
        return self.risk.norm.power(t, f) + self.risk.weight * float(t[-1])


def read_problem(si: Any, goal: HelicopterGoal, objective: Any, helicopter: Helicopter) -> Problem:
    """Read a problem.

    Args:
        si: an ``oc.SpaceInformation``, as from ``simple_setup``.
        goal: where to get to.
        objective: a ``RiskObjective`` or None.
        helicopter: the vehicle.

    Raises:
        ArgumentError: another kind of space, checker or objective, or a vehicle that does not move
            as the propagator says.
    """
    checker: Any = si.getStateValidityChecker()
    if type(checker) is not HelicopterValidityChecker or not _is_plain(checker.obstacles):
        raise ArgumentError("state validity checker", type(checker).__name__, CHECKERS)
    envelope, clearance = checker.envelope, checker.obstacles
    risk = _counted(objective, clearance)
    dt, hold = float(si.getPropagationStepSize()), int(si.getMinControlDuration())
    low, high = _range(si)
    hover = np.clip([helicopter.weight, 0.0, 0.0, 0.0], low, high)
    vehicle = Vehicle(
        given=helicopter.given,
        allowed=envelope.given(clearance.radius),
        low=low,
        high=high,
        loop=_loop(hold * dt, envelope.limits, helicopter, high - hover),
        goal=_goal(goal, clearance),
        settings=_settings(dt, hold, risk),
    )
    _check_motion(si, helicopter, vehicle, hover)
    longest = max(int(si.getMaxControlDuration()) // hold, 1) * hold
    return Problem(vehicle, clearance, risk, hover, longest)


def check_space(si: Any) -> None:
    """Whether a space information is that of a helicopter.

    Raises:
        ArgumentError: it is not.
    """
    allowed = "an oc.SpaceInformation over state_space and control_space of the helicopter"
    if not isinstance(si, oc.SpaceInformation):
        raise ArgumentError("si", type(si).__name__, allowed)
    state: Any = si.getStateSpace()
    control: Any = si.getControlSpace()
    sizes = (state.getSerializationLength() // 8, control.getSerializationLength() // 8)
    if sizes != (STATE, CONTROL):
        raise ArgumentError("si", f"states of {sizes[0]} and controls of {sizes[1]}", allowed)


def _is_plain(clearance: Any) -> bool:
    """Whether compiled code computes what the clearance does."""
    return type(clearance) is TerrainClearance


def _counted(objective: Any, clearance: TerrainClearance) -> Risk | None:
    """How an objective counts risk."""
    if objective is None or type(objective) is ob.PathLengthOptimizationObjective:
        return None
    plain = isinstance(objective, RiskObjective) and all(
        getattr(type(objective), name) is getattr(RiskObjective, name)
        for name in ("stateCost", "motionCost")
    )
    if not plain:
        raise ArgumentError("objective", type(objective).__name__, OBJECTIVES)
    risk, counted = objective.risk, objective.clearance
    if math.isinf(risk.exponent):
        raise ArgumentError("objective", f"a RiskObjective with {risk.norm.label}", OBJECTIVES)
    if not is_compiled(risk.avoidance):
        kind = type(risk.avoidance).__name__
        raise ArgumentError("objective", f"a RiskObjective with {kind}", OBJECTIVES)
    if not (
        _is_plain(counted)
        and counted.terrain is clearance.terrain
        and counted.radius == clearance.radius
    ):
        raise ArgumentError("objective", f"a RiskObjective with {counted!r}", OBJECTIVES)
    return risk


def _range(si: Any) -> tuple[FloatArray, FloatArray]:
    """Bounds of the inputs."""
    bounds = si.getControlSpace().getBounds()
    low, high = (
        np.array([float(side[k]) for k in range(CONTROL)]) for side in (bounds.low, bounds.high)
    )
    if not (np.isfinite(low) & np.isfinite(high) & (low < high)).all() or not high[0] > 0.0:
        allowed = "finite, low below high, as from control_space"
        raise ArgumentError("bounds of the control space", [low.tolist(), high.tolist()], allowed)
    return low, high


def _loop(hold: float, limits: Any, helicopter: Helicopter, spare: FloatArray) -> FloatArray:
    """Settings of the inner loop: as quick as inputs held for so long [s] allow."""
    rate = min(15.0, 0.8 / hold)
    attitude = min(5.0, rate / 2.5)
    torque = helicopter.hub * helicopter.weight * math.sin(min(spare[2:]))
    brake = 0.5 * torque / max(helicopter.inertia[:2])
    steepest = math.tan(min(0.9 * limits.attitude, 1.4))
    return np.array(
        [
            rate,
            attitude,
            min(1.5, attitude / 2.5),
            0.95 * limits.speed,
            0.9 * limits.rate,
            steepest,
            brake,
        ]
    )


def _goal(goal: HelicopterGoal, clearance: TerrainClearance) -> FloatArray:
    """A goal as kernels take it."""
    place, room = goal.state[:3], clearance(goal.state[None, :3])
    velocity = world_velocity(goal.state)
    return np.array([*place, *velocity, goal.radius, goal.tolerance, *room])


def _settings(dt: float, hold: int, risk: Risk | None) -> FloatArray:
    counted = [1.0, 0.0, 1.0] if risk is None else [risk.exponent, risk.time_scale, risk.weight]
    form = None if risk is None else compiled_form(risk.avoidance)
    nothing = np.zeros(SETTINGS - 2 - len(counted))
    return np.array([*(nothing if form is None else form), dt, hold, *counted])


def _check_motion(si: Any, helicopter: Helicopter, vehicle: Vehicle, hover: FloatArray) -> None:
    """Whether the propagator moves states as the compiled code does."""
    state, control, after = Buffer(STATE), Buffer(CONTROL), Buffer(STATE)
    space, controls = si.getStateSpace(), si.getControlSpace()
    begin, end, held = si.allocState(), si.allocState(), si.allocControl()
    tilted = [0.1, -0.2, 0.05]
    low, high = vehicle.allowed[LOW : LOW + 3], vehicle.allowed[HIGH : HIGH + 3]
    turn = [*tilted, math.sqrt(1.0 - sum(x * x for x in tilted))]
    state.numbers[:] = [*(0.5 * (low + high)), *turn, 3.0, -1.0, 0.5, 0.2, -0.3, 0.1]
    control.numbers[:] = hover + 0.3 * (vehicle.high - hover)
    space.deserialize(begin, state.capsule)
    controls.deserialize(held, control.capsule)
    si.propagate(begin, held, 3, end)
    space.serialize(after.capsule, end)
    wanted = np.empty(STATE)
    rigid_body.hold(
        state.numbers, control.numbers, vehicle.settings[DT], 3, helicopter.given, wanted
    )
    if not np.allclose(after.numbers, wanted, rtol=SAME, atol=SAME):
        allowed = "the one of the propagator: after three steps the states differ"
        raise ArgumentError("helicopter", helicopter, allowed)
