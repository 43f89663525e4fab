"""Validity and the Sobolev objective over python-fcl, without anything of ours but the terrain.

Written as one would with OMPL, python-fcl and numpy at hand: a motion is sampled at a fixed step,
the ground below all samples is looked up in one call, python-fcl is asked once for each sample,
and the quadrature is a few lines of numpy.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob

from benchmarks.peers.fcl_ground import FclGround
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]


def squared_sobolev(f: Floats, step: float | Floats) -> float:
    """Integral of f^2 + f'^2 for samples of f at time steps [s], one or each; linear between."""
    first, second = f[:-1], f[1:]
    value = step * (first * first + first * second + second * second) / 3.0
    return float((value + (second - first) ** 2 / step).sum())


def inverse_distance(d: Floats, d0: float) -> Floats:
    """1/d - 1/d0 where d < d0, else 0; d > 0."""
    return np.maximum(1.0 / d - 1.0 / d0, 0.0)


class FclChecker(ob.StateValidityChecker):
    """Free above the ground and clear of it."""

    def __init__(self, si: ob.SpaceInformation, terrain: Terrain, ground: FclGround) -> None:
        super().__init__(si)
        self._height, self._ground = terrain.height, ground

    def isValid(self, state: ob.State) -> bool:
        """Whether the vehicle is free at a state."""
        x, y, z = state[0:3]  # pyright: ignore[reportIndexIssue]
        return bool(z > self._height(x, y)) and not self._ground.touches(np.array([x, y, z]))


class FclMotionValidator(ob.MotionValidator):
    """Free at samples of the motion: the ground below all of them first, then python-fcl.

    Several times quicker than OMPL's own validator, which calls the checker for each sample.

    Args:
        si: over R^3.
        terrain: for the ground below.
        ground: the collisions.
        step: between samples [m], at most.
    """

    def __init__(
        self, si: ob.SpaceInformation, terrain: Terrain, ground: FclGround, step: float
    ) -> None:
        super().__init__(si)
        self._height, self._ground, self._step = terrain.height, ground, step

    def checkMotion(self, s1: ob.State, s2: ob.State) -> bool:
        """Whether the vehicle is free at all samples."""
        points, _ = sampled(s1, s2, self._step)
        if (points[:, 2] <= self._height(points[:, 0], points[:, 1])).any():
            return False
        return not any(map(self._ground.touches, points))


def sampled(s1: Any, s2: Any, step: float) -> tuple[Floats, float]:
    """Equally spaced points of a motion, at most a step apart, and its length [m]."""
    a = np.array(s1[0:3])
    along = np.array(s2[0:3]) - a
    length = math.sqrt(along @ along)
    pieces = max(math.ceil(length / step), 1)
    return a + np.linspace(0.0, 1.0, pieces + 1)[:, None] * along, length


class FclObjective(ob.OptimizationObjective):
    """The squared H^1 norm of 1/d - 1/d0 along motions at constant speed.

    Args:
        si: over R^3.
        terrain: for the ground below, since a mesh's surface has no inside.
        ground: the distances.
        d0: of the avoidance function [m].
        speed: of the vehicle [m/s].
        step: between samples [m], at most.
        weight: of a second, as in ``RiskObjective``.
    """

    def __init__(
        self,
        si: ob.SpaceInformation,
        terrain: Terrain,
        ground: FclGround,
        *,
        d0: float,
        speed: float,
        step: float,
        weight: float,
    ) -> None:
        super().__init__(si)
        self._height, self._ground = terrain.height, ground
        self._d0, self._speed, self._step, self._weight = d0, speed, step, weight
        self.calls = itertools.count()

    def stateCost(self, state: ob.State) -> ob.Cost:  # noqa: ARG002
        """None: RRT* asks for motions only."""
        return ob.Cost(0.0)

    def motionCost(self, s1: ob.State, s2: ob.State) -> ob.Cost:
        """Cost of the straight motion, inf if a sample is in collision."""
        next(self.calls)
        points, length = sampled(s1, s2, self._step)
        if (points[:, 2] <= self._height(points[:, 0], points[:, 1])).any():
            return ob.Cost(math.inf)  # before anything is asked of python-fcl
        d = self._ground.distances(points)
        if d.min() <= 0.0:
            return ob.Cost(math.inf)
        duration = length / self._speed
        if duration == 0.0:
            return ob.Cost(0.0)
        risk = squared_sobolev(inverse_distance(d, self._d0), duration / (len(points) - 1))
        return ob.Cost(risk + self._weight * duration)

    def isSymmetric(self) -> bool:
        """A motion costs the same in both directions."""
        return True
