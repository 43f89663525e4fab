"""What is to be planned: from where to where, at what speed, within which box, past what."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly
from ompl_risk.avoidance import Avoidance, InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.base import as_length
from ompl_risk.errors import ArgumentError


@dataclass(frozen=True, eq=False)
class Problem(ReadOnlyArrays):
    """A flight in R^3 at constant speed; picklable, so that worker processes can plan it.

    Args:
        clearance: d(q); anything picklable that maps points (n, 3) [m] to distances (n,).
        start: first position [m], shape (3,).
        goal: last position [m], shape (3,).
        low: least coordinates that paths may have [m], shape (3,).
        high: greatest coordinates that paths may have [m], shape (3,).
        speed: constant speed [m/s].
        avoidance: the avoidance function f(d); ``InverseDistance()`` if left out.
        min_clearance: least d that a path may have [m]; 0 asks for freedom of collision alone.

    Raises:
        ArgumentError: a number out of range, start or goal outside the box or nearer to an
            obstacle than `min_clearance`, start and goal at one place, or no avoidance function.
    """

    clearance: Any
    start: FloatArray
    goal: FloatArray
    low: FloatArray
    high: FloatArray
    _: KW_ONLY
    speed: float
    avoidance: Avoidance
    min_clearance: float = 0.0

    def __init__(
        self,
        clearance: Any,
        start: ArrayLike,
        goal: ArrayLike,
        low: ArrayLike,
        high: ArrayLike,
        *,
        speed: float,
        avoidance: Avoidance | None = None,
        min_clearance: float = 0.0,
    ) -> None:
        points = {"start": start, "goal": goal, "low": low, "high": high}
        fields: dict[str, Any] = {k: readonly(k, v, (3,), "(3,)") for k, v in points.items()}
        fields["clearance"] = clearance
        fields["speed"] = positive("speed", speed)
        fields["avoidance"] = InverseDistance() if avoidance is None else avoidance
        if not isinstance(fields["avoidance"], Avoidance):
            raise ArgumentError("avoidance", avoidance, "an Avoidance, as InverseDistance()")
        fields["min_clearance"] = as_length(min_clearance, "min_clearance")
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        if not (self.low < self.high).all():
            raise ArgumentError("high", self.high.tolist(), f"above low = {self.low.tolist()}")
        self._check_end("start")
        self._check_end("goal")
        if (self.start == self.goal).all():
            raise ArgumentError("goal", self.goal.tolist(), "another place than start")

    @property
    def distance(self) -> float:
        """Straight distance from start to goal [m]."""
        return float(np.linalg.norm(self.goal - self.start))

    @property
    def obstacles(self) -> Any:
        """The clearance less `min_clearance`: positive where a path may be."""
        return narrowed(self.clearance, self.min_clearance)

    def _check_end(self, argument: str) -> None:
        point = getattr(self, argument)
        if ((point < self.low) | (point > self.high)).any():
            box = f"between {self.low.tolist()} and {self.high.tolist()}"
            raise ArgumentError(argument, point.tolist(), box)
        d = float(np.asarray(self.clearance(point[None, :]))[0])
        if not d > self.min_clearance:
            allowed = (
                f"more than {self.min_clearance:g} m from obstacles; its clearance is {d:.4g} m"
            )
            raise ArgumentError(argument, point.tolist(), allowed)


def narrowed(clearance: Any, margin: float) -> Any:
    """A clearance less a margin [m]: of a larger body."""
    if margin == 0.0:
        return clearance
    if isinstance(clearance, TerrainClearance):
        return clearance.with_radius(clearance.radius + margin)
    return _Margin(clearance, margin)


class _Margin:
    """A clearance less a margin [m]."""

    def __init__(self, clearance: Any, margin: float) -> None:
        self._clearance, self._margin = clearance, margin

    def __call__(self, points: FloatArray) -> FloatArray:
        return np.asarray(self._clearance(points)) - self._margin
