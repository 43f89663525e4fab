"""What a roadmap needs to know of an OMPL problem whose vehicle has dynamics."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import control as oc

from ompl_risk.avoidance import InverseDistance
from ompl_risk.bridge.controls import ControlBuffers
from ompl_risk.bridge.states import StateReader
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.validity import HelicopterValidityChecker
from ompl_risk.motion import Risk
from ompl_risk.motion.kinodynamic import KinodynamicSteering
from ompl_risk.motion.steering import Steering
from ompl_risk.norms import Lp
from ompl_risk.planners.problem import narrowed
from ompl_risk.planners.roadmap.gate import BoxGate, ClearanceGate, Gate, all_of
from ompl_risk.planners.roadmap.region import VertexRegion
from ompl_risk.planners.roadmap.setting import (
    Setting,
    bounds_of,
    counted,
    distinct,
    obstacles_of,
    read_setting,
)
from ompl_risk.planners.roadmap.translation import VertexTranslation

SAME = 1e-7
"""How far, in any number of a state, a manoeuvre may end from where the library says."""

FREE = InverseDistance(2e-3)
"""Finds hardly anything risky but collisions: for plans that heed time alone."""


def setting_of(
    si: ob.SpaceInformation,
    objective: Any,
    *,
    seed: int,
    steering: Steering | KinodynamicSteering | None,
    threads: int | None = None,
) -> Setting:
    """Read a problem, of a vehicle with dynamics if the steering is of one.

    Args:
        si: see ``read_setting`` and ``read_vehicle_setting``.
        objective: likewise.
        seed: of the samples.
        steering: how states are connected; straight if left out.
        threads: of compiled code, at most.

    Raises:
        ArgumentError: what cannot be planned.
    """
    if isinstance(steering, KinodynamicSteering):
        return read_vehicle_setting(si, objective, seed=seed, steering=steering, threads=threads)
    return read_setting(si, objective, seed=seed, steering=steering, threads=threads)


def read_vehicle_setting(
    si: ob.SpaceInformation,
    objective: Any,
    *,
    seed: int,
    steering: KinodynamicSteering,
    threads: int | None = None,
) -> Setting:
    """Read a problem of a vehicle with dynamics.

    Args:
        si: an ``oc.SpaceInformation`` over the states of the vehicle, with bounds.
        objective: a ``RiskObjective``, its speed replaced by the vehicle's; None for duration.
        seed: of the samples.
        steering: of the vehicle.
        threads: of compiled code, at most.

    Raises:
        ArgumentError: another space or objective, one without bounds, or checkers that are not
            this library's: they cannot be asked about a flight as a whole; a vehicle, a propagation
            step or limits that the steering was not made for.
    """
    if not isinstance(si, oc.SpaceInformation):
        allowed = "an oc.SpaceInformation, as of helicopter.simple_setup(...)"
        raise ArgumentError("si", type(si).__name__, allowed)
    width = StateReader(si.getStateSpace()).width
    if width != steering.state_width:
        allowed = f"one of {steering.state_width} numbers, as the steering's vehicle"
        raise ArgumentError("si.getStateSpace()", f"one of {width} numbers", allowed)
    clearance, risk = _counted(objective, steering.speed)
    obstacles, foreign = obstacles_of(si, clearance)
    if foreign or not obstacles:
        checker = type(si.getStateValidityChecker()).__name__
        allowed = "a ClearanceValidityChecker, or the helicopter's own"
        raise ArgumentError("si.getStateValidityChecker()", checker, allowed)
    _check_vehicle(si, steering)
    space: Any = si.getStateSpace()
    low, high = bounds_of(space.getSubspace(0))
    region = VertexRegion(low, high, steering, seed=seed)
    seen = obstacles[0] if clearance is None else clearance
    motions = steering.batch(seen, replace(risk, duration_weight=0.0), threads=threads)
    free = Risk(speed=steering.speed)
    gates: list[Gate] = [BoxGate(motions, region.low, region.high, margin=steering.slack)]
    gates += [
        ClearanceGate(steering.batch(narrowed(one, steering.slack), free, threads=threads))
        for one in [seen, *distinct(obstacles, seen)]
    ]
    return Setting(
        region,
        motions,
        risk,
        all_of(gates),
        clearance,
        obstacles[0] if len(obstacles) == 1 else None,
        straight=False,
        undirected=False,
        translation=VertexTranslation(si, steering),
    )


def _check_vehicle(si: Any, steering: KinodynamicSteering) -> None:
    """Whether what ``si`` propagates flies as the steering says, within the checker's limits."""
    remedy = "make a library for this vehicle: python -m ompl_risk.helicopter.optimal_control"
    checker = si.getStateValidityChecker()
    if isinstance(checker, HelicopterValidityChecker):
        broken = steering.broken_limit(checker.envelope.limits)
        if broken is not None:
            raise ArgumentError("steering", broken, f"within the limits of the problem; {remedy}")
    specimen = steering.specimen
    if specimen is None:
        return
    step = si.getPropagationStepSize()
    if abs(step - specimen.dt) > 1e-12:
        allowed = f"{specimen.dt:g} s, for which the steering's inputs are held"
        raise ArgumentError("si.getPropagationStepSize()", step, allowed)
    buffers = ControlBuffers(si)
    state = buffers.write_state(specimen.states[0])
    for control in specimen.controls:
        si.propagate(state, buffers.write_control(control), 1, state)
    miss = float(np.abs(buffers.read_state(state) - specimen.states[-1]).max())
    if not miss <= SAME:
        allowed = f"the steering of the vehicle that si propagates: a manoeuvre misses; {remedy}"
        raise ArgumentError("steering", f"ends {miss:.3g} beside", allowed)


def _counted(objective: Any, speed: float) -> tuple[Any, Risk]:
    """Clearance and risk; time alone without a ``RiskObjective``."""
    if objective is None or type(objective) is ob.PathLengthOptimizationObjective:
        return None, Risk(FREE, Lp(1), speed=speed, duration_weight=1.0)
    clearance, risk = counted(objective)
    return clearance, replace(risk, speed=speed)
