"""A control planning problem of the helicopter, ready to solve."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from ompl import base as ob
from ompl import control as oc

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.avoidance import Avoidance
from ompl_risk.bridge import RiskObjective
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.clearance import Clearance, TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.envelope import Envelope
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.model import STATE, as_state
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT
from ompl_risk.helicopter.spaces import GENTLE, control_space, propagator, state_space
from ompl_risk.helicopter.validity import HelicopterValidityChecker
from ompl_risk.norms import Norm
from ompl_risk.terrains import Terrain, load

HEADROOM = 100.0
"""Of the box over the highest of ground, start and goal, where none is given [m]."""

BODY = 1.0
"""Radius of the helicopter's sphere where none is given [m]."""

HOLDS = (15, 60)
"""Steps for which an input drawn at random is held, at least and at most."""


def simple_setup(
    terrain: Terrain | Clearance | str,
    *,
    start: ArrayLike,
    goal: ArrayLike,
    radius: float = 5.0,
    tolerance: float = 2.0,
    body: float | None = None,
    low: ArrayLike | None = None,
    high: ArrayLike | None = None,
    helicopter: Helicopter | None = None,
    limits: Limits | None = None,
    authority: ArrayLike = GENTLE,
    step: float = DT,
    holds: tuple[int, int] = HOLDS,
    avoidance: Avoidance | None = None,
    norm: Norm | None = None,
) -> oc.SimpleSetup:
    """A problem with spaces, propagator, validity, start, goal and objective; it lacks a planner.

    The objective is a ``RiskObjective``. OMPL's own control planners (RRT, EST, KPIECE1) do not
    look at it and say so in a warning; for the least duration set
    ``ob.PathLengthOptimizationObjective``: that length of a control path is its duration.

    ``authority`` and ``holds`` are for planners that draw inputs at random. With their defaults
    OMPL's own solve short problems (60 to 100 m) some of the time, the more often the narrower
    box and limits are; what the helicopter really can do is ``authority=1.0``, which
    ``planners.SST`` makes use of. ``RiskRoadmap`` with a ``HelicopterSteering`` heeds neither.

    Args:
        terrain: a terrain, the name or file of one as ``terrains.load`` takes it, or a clearance.
        start: a state, shape (13,), or a position to hover at, shape (3,) [m].
        goal: likewise.
        radius: greatest distance from the goal's position [m].
        tolerance: greatest difference from the goal's velocity [m/s].
        body: radius of the helicopter's sphere [m], 1 m if left out; not with a clearance.
        low: least position [m], shape (3,); by default the terrain's edges and lowest post.
        high: greatest position [m]; by default the terrain's edges, and 100 m over the highest
            of ground, start and goal.
        helicopter: the vehicle.
        limits: what it may do.
        authority: see ``control_space``.
        step: between two states that are checked [s].
        holds: steps for which an input is held, at least and at most.
        avoidance: of the objective, see ``RiskObjective``.
        norm: likewise.

    Raises:
        ArgumentError: a start or goal that breaks a limit, lies outside the box, or below or too
            near to the ground, or another value out of range; the message has value and limit.
        FileError: an unknown terrain.

    Example:
        >>> from ompl import control as oc
        >>> flat = Terrain(np.zeros((21, 21)), spacing=(10.0, 10.0))
        >>> setup = simple_setup(flat, start=(50, 100, 20), goal=(150, 100, 20))
        >>> setup.setPlanner(oc.KPIECE1(setup.getSpaceInformation()))
    """
    machine = Helicopter() if helicopter is None else helicopter
    clearance = _clearance(terrain, body)
    first, last = as_state("start", start), as_state("goal", goal)
    envelope = Envelope(*_box(clearance, max(first[2], last[2]), low, high), limits)
    space = state_space(envelope.low, envelope.high, envelope.limits)
    controls = control_space(space, machine, envelope.limits, authority=authority)
    setup = oc.SimpleSetup(controls)
    si = setup.getSpaceInformation()
    checker = HelicopterValidityChecker(si, clearance, envelope)
    setup.setStateValidityChecker(checker)
    setup.setStatePropagator(propagator(space, controls, machine))
    si.setPropagationStepSize(positive("step", step))
    si.setMinMaxControlDuration(*_holds(holds))
    setup.setStartState(ompl_state(si, checker.check("start", first)))
    setup.setGoal(HelicopterGoal(si, last, radius=radius, tolerance=tolerance))
    speed = envelope.limits.speed
    setup.setOptimizationObjective(RiskObjective(si, clearance, avoidance, norm, speed=speed))
    return setup


def ompl_state(si: ob.SpaceInformation, state: ArrayLike) -> Any:
    """A new OMPL state with these numbers.

    Args:
        si: over a space from ``state_space``.
        state: shape (13,), or a position to hover at, shape (3,) [m].

    Raises:
        ArgumentError: it is no state.
    """
    buffer = Buffer(STATE)
    buffer.numbers[:] = as_state("state", state)
    space: Any = si.getStateSpace()
    made = si.allocState()  # the only allocation in OMPL 2.0.1 that does not leak
    space.deserialize(made, buffer.capsule)
    return made


def _clearance(terrain: Any, body: float | None) -> Any:
    """The clearance of a terrain; one that is given stays as it is."""
    found = load(terrain) if isinstance(terrain, str) else terrain
    if isinstance(found, Terrain):
        return TerrainClearance(found, BODY if body is None else body)
    if not callable(found):
        allowed = "a Terrain, the name of one, or a clearance"
        raise ArgumentError("terrain", terrain, allowed)
    if body is not None:
        raise ArgumentError("body", body, "left out: the clearance has a body of its own")
    return found


def _box(
    clearance: Any, highest: float, low: ArrayLike | None, high: ArrayLike | None
) -> tuple[ArrayLike, ArrayLike]:
    """Least and greatest position: what is given, the rest from the terrain."""
    terrain = getattr(clearance, "terrain", None)
    if low is not None and high is not None:
        return low, high
    if not isinstance(terrain, Terrain):
        name = "low" if low is None else "high"
        raise ArgumentError(name, None, "given: only a terrain has edges")
    xmin, xmax, ymin, ymax = terrain.extent
    ground: FloatArray = terrain.heights
    bottom, top = float(ground.min()), max(float(ground.max()), highest) + HEADROOM
    return (
        np.array([xmin, ymin, bottom]) if low is None else low,
        np.array([xmax, ymax, top]) if high is None else high,
    )


def _holds(holds: tuple[int, int]) -> tuple[int, int]:
    allowed = "(least, most), whole numbers of steps with 1 <= least <= most"
    try:
        least, most = holds
    except (TypeError, ValueError):
        raise ArgumentError("holds", holds, allowed) from None
    whole = all(isinstance(n, int | np.integer) and not isinstance(n, bool) for n in (least, most))
    if not whole or not 1 <= least <= most:
        raise ArgumentError("holds", holds, allowed)
    return int(least), int(most)
