"""What is asked of obstacles that move."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError

STILL = (
    "one that stands still. Among obstacles that move, RiskRoadmap plans the earliest arrival over "
    "ob.SpaceTimeStateSpace of R^3, with a ClearanceValidityChecker and without an objective; "
    "rank() tells the risk of trajectories among them"
)
"""Where no time is known, which clearance is allowed."""


class MovingObstacles(Protocol):
    """A clearance d(q, t), as ``MovingClearance``; what planning in space-time asks of it.

    Motions lead straight, at constant velocity, from a[k] at ta[k] to b[k] at tb[k].
    """

    def __call__(self, points: Any, times: Any, /) -> FloatArray:
        """Distances d(q, t) [m], shape (n,)."""
        ...

    def are_free(self, a: Any, ta: Any, b: Any, tb: Any) -> NDArray[Any]:
        """Which motions are free throughout, for certain; maybe not where d falls to 1 mm."""
        ...

    def approach(
        self, a: Any, ta: Any, b: Any, tb: Any, *, tolerance: float
    ) -> tuple[FloatArray, FloatArray]:
        """Least distances [m] on motions, too great by a tolerance at most; and when [s]."""
        ...

    def free_intervals(
        self, points: Any, t0: float, t1: float, *, resolution: float
    ) -> Sequence[Sequence[tuple[float, float]]]:
        """For each place when within [t0, t1] it is free for certain [s]; exact to a resolution."""
        ...


def moves(clearance: object) -> bool:
    """Whether a clearance depends on the time."""
    return bool(getattr(clearance, "moves", False))


def refuse_moving(clearance: object) -> None:
    """Refuse a clearance that needs a time where there is none.

    Raises:
        ArgumentError: it moves; says what to use instead.
    """
    if moves(clearance):
        raise ArgumentError("clearance", type(clearance).__name__, STILL)
