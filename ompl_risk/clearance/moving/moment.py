"""Moving obstacles as they stand at one time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray
from ompl_risk.clearance.base import Clearance

if TYPE_CHECKING:
    from ompl_risk.clearance.moving.clearance import MovingClearance


class Moment(Clearance):
    """``MovingClearance`` at one time, an ordinary clearance: d(q) = d(q, t).

    Args:
        moving: the obstacles.
        time: t [s].
    """

    moves = False

    def __init__(self, moving: MovingClearance, time: float) -> None:
        self.moving, self.time, self.radius = moving, time, moving.radius

    def __repr__(self) -> str:
        return f"{self.moving!r}.at({self.time:g})"

    def __call__(self, points: ArrayLike) -> FloatArray:
        """Distances d [m] of points (n, 3), shape (n,)."""
        return self.moving(points, self.time)

    def of_point(self) -> Moment:
        """The same obstacles for a body that is a single point."""
        return Moment(self.moving.of_point(), self.time)

    def with_radius(self, radius: float) -> Moment:
        """The same obstacles for a sphere of another radius [m]."""
        return Moment(self.moving.with_radius(radius), self.time)
