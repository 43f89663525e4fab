"""What a search in space-time finds: a way with its times, or none and why."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays
from ompl_risk.trajectory import Trajectory

NEAR = 1e-3
"""How exactly the least clearance of a route is found [m]."""


class Wait(NamedTuple):
    """A stay at a place.

    Attributes:
        place: where [m], (x, y, z).
        since: from when [s].
        until: to when [s].
    """

    place: tuple[float, float, float]
    since: float
    until: float


@dataclass(frozen=True, eq=False)
class TimedRoute(ReadOnlyArrays):
    """A way from a start to a goal, straight and at constant speed between its corners.

    Attributes:
        positions: corners [m], shape (k, 3), k >= 1; a stay is the same corner at two times.
        times: when the vehicle is there [s], shape (k,), strictly increasing.
    """

    positions: FloatArray
    times: FloatArray

    def __post_init__(self) -> None:
        for field in ("positions", "times"):
            array = np.array(getattr(self, field), dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, field, array)

    @property
    def depart(self) -> float:
        """When it begins [s]."""
        return float(self.times[0])

    @property
    def arrival(self) -> float:
        """When it ends [s]."""
        return float(self.times[-1])

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return self.arrival - self.depart

    @cached_property
    def waits(self) -> tuple[Wait, ...]:
        """The stays, in order."""
        still = np.flatnonzero(np.all(self.positions[1:] == self.positions[:-1], axis=1))
        return tuple(
            Wait(tuple(self.positions[k].tolist()), float(self.times[k]), float(self.times[k + 1]))
            for k in still
        )

    @property
    def waited(self) -> float:
        """How long it stays in all [s]."""
        return math.fsum(one.until - one.since for one in self.waits)

    def trajectory(self, name: str = "") -> Trajectory:
        """The same for ``rank`` and whatever else takes trajectories.

        Raises:
            ArgumentError: a route that ends where and when it begins.
        """
        return Trajectory(self.times, self.positions, name)

    def least_clearance(self, clearance: Any) -> float:
        """Least d(q, t) along the route [m], from the route itself.

        Args:
            clearance: a ``MovingClearance``.
        """
        a, b, ta, tb = self.positions[:-1], self.positions[1:], self.times[:-1], self.times[1:]
        if len(a) == 0:
            return float(clearance(self.positions, self.times)[0])
        return float(clearance.approach(a, ta, b, tb, tolerance=NEAR)[0].min())


@dataclass(frozen=True, eq=False)
class Arrival:
    """The outcome of a search for the earliest arrival.

    Attributes:
        route: the way that arrives first; None if none was found.
        reason: why there is none, in words; empty otherwise.
        stopped: whether the search was stopped before it knew.
        labels: places in spans of time that it reached.
        evaluated: flights along an edge at a given time that it looked at.
    """

    route: TimedRoute | None
    reason: str
    stopped: bool
    labels: int
    evaluated: int

    @property
    def found(self) -> bool:
        """Whether there is a route."""
        return self.route is not None
