"""A plan: what a vehicle means to fly, and how it flies it."""

from __future__ import annotations

from abc import ABC, abstractmethod

from ompl_risk._arrays import FloatArray
from ompl_risk.simulation.loop.air import Air
from ompl_risk.simulation.loop.outcomes import Outcomes


class Plan(ABC):
    """A planned motion with the vehicle and the control law that follow it.

    Duties of an implementer:

    1. Without disturbances a rollout is the planned motion to rounding.
    2. A rollout depends on its own seed and amplitudes only, and draws as many random numbers at
       each step whatever is planned: candidates share their random numbers.
    3. ``run`` releases the GIL and writes no rows but those it was asked for.
    4. Collisions are found by ``_kernels.watch``, so that they mean the same for every vehicle.

    Attributes:
        name: what tables call it.
        dt: the step [s].
        times: [s], shape (n + 1,).
        positions: planned [m], shape (n + 1, 3).
        velocities: planned, in the world [m/s], shape (n + 1, 3).
        drag: of the vehicle along the axes in which gusts push it [kg/s], shape (3,).
    """

    name: str
    dt: float
    times: FloatArray
    positions: FloatArray
    velocities: FloatArray
    drag: FloatArray

    @abstractmethod
    def run(self, air: Air, first: int, last: int, outcomes: Outcomes) -> None:
        """Fly rollouts ``first`` to ``last - 1`` and write their rows.

        Args:
            air: what they meet.
            first: number of the first.
            last: one more than the number of the last.
            outcomes: from ``Outcomes.room``.
        """
