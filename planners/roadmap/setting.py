"""What a roadmap needs to know of an OMPL problem."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from ompl import base as ob

from ompl_risk._arrays import FloatArray
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.bridge.states import StateReader, StateWriter
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.validity import HelicopterValidityChecker
from ompl_risk.motion import MotionBatch, Risk, motion_batch, steered_batch
from ompl_risk.motion.length import LengthBatch
from ompl_risk.motion.steering import Steering
from ompl_risk.norms import Lp
from ompl_risk.planners.improve import refine
from ompl_risk.planners.roadmap.anytime import Polish
from ompl_risk.planners.roadmap.gate import ClearanceGate, Flags, Gate, all_of
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.roadmap.translation import GeometricTranslation, Translation
from ompl_risk.planners.sides import Sides

LENGTH = Risk(norm=Lp(1), speed=1.0, duration_weight=1.0)
"""How the length of a path is counted: no risk, and a second for every metre."""

POLISH = 0.1
"""Seconds that the refinement of a path takes: most of what can be gained is gained by then."""

LONGER = 1.5
"""How much longer a refined path may be: in the objective time has its own weight."""

OBJECTIVES = (
    "a RiskObjective or ob.PathLengthOptimizationObjective as they are: RiskRoadmap evaluates "
    "motions in batches and cannot ask others"
)

CHECKERS = ClearanceValidityChecker, HelicopterValidityChecker
"""Validity checkers whose answer is that of their clearance, for whatever a steering flies."""

TURN = 0.5
"""What turning by a radian counts in metres at least: as in OMPL's own distance in SE(3)."""


@dataclass(frozen=True, eq=False)
class Setting:
    """The arguments of a ``Roadmap``, read from OMPL's space information and objective.

    Attributes:
        region: where states are sampled.
        motions: the pure risk of motions.
        risk: how risk is counted.
        gate: what is allowed besides what has a finite risk.
        clearance: of the objective; None if it minimises the length.
        obstacles: a clearance that paths keep positive; None if it takes more than one.
        straight: whether vertices are connected by straight motions.
        undirected: whether motions can be flown both ways.
        translation: between OMPL's states and the roadmap's.
    """

    region: Region
    motions: MotionBatch
    risk: Risk
    gate: Gate
    clearance: Any
    obstacles: Any
    straight: bool
    undirected: bool
    translation: Translation

    def polish(self, seconds: float = POLISH) -> Polish | None:
        """Local refinement of paths; None where it would be too slow, or bend what steering gives.

        Args:
            seconds: computing time for a path [s], about.
        """
        compiled = self.motions.compiled and self.gate.compiled
        known = self.clearance is not None and self.obstacles is not None
        if not (known and compiled and self.straight) or self.region.posed:
            return None

        def polish(states: FloatArray) -> FloatArray:
            return refine(
                states,
                clearance=self.clearance,
                risk=self.risk,
                obstacles=self.obstacles,
                low=self.region.low,
                high=self.region.high,
                longest=LONGER * float(self.motions.durations(states[:-1], states[1:]).sum()),
                seconds=min(seconds, 1e9),
            ).positions

        return polish

    def sides(self) -> Sides | None:
        """The peaks that no path can cross; None where the obstacles are not terrain."""
        if not isinstance(self.obstacles, TerrainClearance):
            return None
        low, high = self.region.low, self.region.high
        return Sides.of_terrain(self.obstacles.terrain, low, high, radius=self.obstacles.radius)


def read_setting(
    si: ob.SpaceInformation,
    objective: Any,
    *,
    seed: int,
    steering: Steering | None = None,
    threads: int | None = None,
) -> Setting:
    """Read a problem.

    Args:
        si: over R^3 or SE(3), with bounds.
        objective: a ``RiskObjective``, or one of path length; None is the latter.
        seed: of the samples.
        steering: how states are connected; straight if left out.
        threads: of compiled code, at most.

    Raises:
        ArgumentError: another space or objective, or a space without bounds.
    """
    space = si.getStateSpace()
    StateReader(space)  # says which spaces can be read
    clearance, risk = counted(objective)
    obstacles, foreign = obstacles_of(si, clearance)
    posed = any(getattr(c, "uses_orientation", False) for c in obstacles)
    posed = posed or (foreign and isinstance(space, ob.SE3StateSpace))
    reach = max([TURN, *(float(getattr(c, "reach", 0.0)) for c in obstacles)])
    region = _region(space, posed=posed, reach=reach, seed=seed)
    motions = _motions(clearance, risk, steering, region.width, threads)
    free = Risk(speed=risk.speed)
    gates: list[Gate] = [
        ClearanceGate(_motions(one, free, steering, region.width, threads))
        for one in distinct(obstacles, clearance)
    ]
    if foreign:
        gates = [CheckerGate(si, motions)]
    return Setting(
        region,
        motions,
        risk,
        all_of(gates),
        clearance,
        _widest(obstacles),
        straight=steering is None,
        undirected=steering is None or steering.symmetric,
        translation=GeometricTranslation(si),
    )


def _widest(obstacles: list[Any]) -> Any:
    """The clearance that implies all the others; None if none does."""
    if len(obstacles) == 1:
        return obstacles[0]
    terrains = {id(getattr(one, "terrain", one)) for one in obstacles}
    if len(terrains) != 1 or not all(type(one) is TerrainClearance for one in obstacles):
        return None
    return max(obstacles, key=lambda one: one.radius)


def _motions(
    clearance: Any, risk: Risk, steering: Steering | None, width: int, threads: int | None
) -> MotionBatch:
    """The pure risk of motions as the vehicle flies them."""
    if clearance is None:
        if steering is not None:
            allowed = "left out for path length; use a RiskObjective"
            raise ArgumentError("steering", steering, allowed)
        return LengthBatch(width, TURN)
    pure = replace(risk, duration_weight=0.0)
    if steering is None:
        return motion_batch(clearance, pure, width, threads=threads)
    return steered_batch(steering, clearance, pure, width, threads=threads)


class CheckerGate(Gate):
    """Allows what OMPL's state validity checker and motion validator allow, one at a time.

    Args:
        si: with both.
        motions: of the roadmap; says by which states they lead.
    """

    def __init__(self, si: ob.SpaceInformation, motions: MotionBatch) -> None:
        self._writer, self._samples = StateWriter(si), motions.samples
        self._is_valid, self._check = si.isValid, si.checkMotion

    def allows_states(self, states: FloatArray) -> Flags:
        """Which states are valid."""
        return np.array([self._is_valid(self._state(row)) for row in states], dtype=np.bool_)

    def allows_motions(self, a: FloatArray, b: FloatArray) -> Flags:
        """Which motions are valid."""
        ways = self._samples(a, b)
        return np.array([len(way) > 1 and self._is_flyable(way) for way in ways], np.bool_)

    def _is_flyable(self, way: FloatArray) -> bool:
        states = [self._state(row) for row in way]
        return all(self._check(p, q) for p, q in pairwise(states))

    def _state(self, numbers: FloatArray) -> Any:
        return self._writer.state(full_state(numbers, self._writer.width))


def full_state(numbers: FloatArray, width: int) -> FloatArray:
    """A position completed by the identity where OMPL's states have an orientation."""
    if len(numbers) == width:
        return numbers
    return np.concatenate([numbers, [0.0, 0.0, 0.0, 1.0]])


def counted(objective: Any) -> tuple[Any, Risk]:
    """Clearance and risk of an objective."""
    if isinstance(objective, RiskObjective):
        for name in ("stateCost", "motionCost", "motionCostHeuristic"):
            if not _is_ours(objective, name, RiskObjective):
                kind = f"{type(objective).__name__} with a {name} of its own"
                raise ArgumentError("objective", kind, OBJECTIVES)
        return objective.clearance, objective.risk
    if objective is None or type(objective) is ob.PathLengthOptimizationObjective:
        return None, LENGTH
    raise ArgumentError("objective", type(objective).__name__, OBJECTIVES)


def _is_ours(thing: Any, method: str, kind: type) -> bool:
    """Whether a method is the one of our class: compiled code must not bypass an override."""
    return isinstance(thing, kind) and getattr(type(thing), method) is getattr(kind, method)


def obstacles_of(si: ob.SpaceInformation, clearance: Any) -> tuple[list[Any], bool]:
    """The clearances that OMPL's checkers go by, and whether one of them is not ours."""
    checker: Any = si.getStateValidityChecker()
    validator: Any = si.getMotionValidator()
    ours: list[Any] = []
    foreign = False
    if _is_ours(validator, "checkMotion", ClearanceMotionValidator):
        ours.append(validator.obstacles)
    elif type(validator) is not ob.MotionValidator:  # OMPL's own asks the checker
        foreign = True
    if any(_is_ours(checker, "isValid", kind) for kind in CHECKERS):
        ours.append(checker.obstacles)
    elif checker is not None and type(checker) is not ob.AllValidStateValidityChecker:
        foreign = True
    if clearance is not None:
        ours.append(clearance)
    different: list[Any] = []
    for one in ours:
        if not any(_same(one, other) for other in different):
            different.append(one)
    return different, foreign


def _same(one: Any, other: Any) -> bool:
    """Whether two clearances keep off the same obstacles by as much."""
    if type(one) is TerrainClearance and type(other) is TerrainClearance:
        return one.terrain is other.terrain and one.radius == other.radius
    return one is other


def distinct(obstacles: list[Any], clearance: Any) -> list[Any]:
    """Those besides the clearance of the objective, whose risk is infinite in collision."""
    return [one for one in obstacles if clearance is None or not _same(one, clearance)]


def _region(space: Any, *, posed: bool, reach: float, seed: int) -> Region:
    if type(space) not in (ob.RealVectorStateSpace, ob.SE3StateSpace):
        allowed = "R^3 or SE(3), with straight motions; others with a KinodynamicSteering"
        raise ArgumentError("si.getStateSpace()", type(space).__name__, allowed)
    low, high = bounds_of(space)
    return Region(low, high, posed=posed, reach=reach, seed=seed)


def bounds_of(space: Any) -> tuple[list[float], list[float]]:
    """Least and greatest coordinates of R^3 or SE(3) [m].

    Raises:
        ArgumentError: bounds that are not set.
    """
    bounds = space.getBounds()
    low, high = ([float(side[k]) for k in range(3)] for side in (bounds.low, bounds.high))
    for a, b in zip(low, high, strict=True):
        if not (math.isfinite(a) and math.isfinite(b) and a < b):
            raise ArgumentError("space.getBounds()", [low, high], "finite, low below high")
    return low, high
