"""How SST draws its branches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.sst import Draw
from ompl_risk.planners.sst.problem import Problem


@dataclass(frozen=True)
class Habits:
    """What branches are drawn, and how often; chosen by trial over a ridge.

    Attributes:
        to_goal: part of the acts that reach for something which reach for the goal.
        held: part of the acts that are inputs held.
        pushed: part of the acts that are accelerations held; the rest reach for what was sampled.
        shortest, longest: of an act [s]; inputs are held for a quarter as long at most.
        near_path: part of the samples that are near the best path, once there is one.
        near: how near, in radii of the pruning.
        shoot: part of the branches after which the goal is reached for.
    """

    to_goal: float = 0.3
    held: float = 0.1
    pushed: float = 0.6
    shortest: float = 0.1
    longest: float = 2.0
    near_path: float = 0.6
    near: float = 2.0
    shoot: float = 0.3

    def numbers(self, problem: Problem, radius: float) -> FloatArray:
        """The same as kernels take them, see ``_kernels.sst``.

        Args:
            problem: says for how long inputs are held.
            radius: of the pruning [m].
        """
        hold = problem.hold * problem.step
        least, most = (max(round(t / hold), 1) for t in (self.shortest, self.longest))
        held = min(max(most // 4, 1), problem.longest_hold // problem.hold)
        parts = (self.to_goal, self.held, self.pushed)
        near = self.near_path, self.near * radius
        return np.array([*parts, least, most, held, *near, self.shoot])

    def draw(
        self,
        problem: Problem,
        starts: Sequence[FloatArray],
        *,
        seed: int,
        authority: float,
        radius: float,
    ) -> Draw:
        """What kernels draw from.

        Args:
            problem: what is planned.
            starts: states to start from, shapes (13,).
            seed: of the random numbers.
            authority: part of the inputs' range about hover that held inputs are drawn from.
            radius: of the pruning [m].
        """
        vehicle, hover = problem.vehicle, problem.hover
        return Draw(
            seed=np.array([seed], dtype=np.uint64),
            habits=self.numbers(problem, radius),
            low=hover + authority * (vehicle.low - hover),
            high=hover + authority * (vehicle.high - hover),
            starts=np.array(starts),
        )
