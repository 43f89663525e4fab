"""A way between two vertices, as its user reads it: trims and manoeuvres in their order."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive
from ompl_risk.helicopter.library import PrimitiveLibrary
from ompl_risk.helicopter.planned_route import Leg, PlannedRoute, planned_route
from ompl_risk.helicopter.trims import Key, Trim


class PathSamples(NamedTuple):
    """States along a way.

    Attributes:
        times: from the beginning [s], increasing, shape (n,).
        states: position, quaternion (x, y, z, w), v and omega, shape (n, 13).
    """

    times: FloatArray
    states: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class PrimitivePath(ReadOnlyArrays):
    """The way that a steering found from one vertex to another, or that there is none.

    Args:
        library: what it is made of.
        start: the vertex where it begins, shape (5,).
        pieces: see ``ompl_risk._kernels.pieces``, read-only, shape (m, 10); m = 0 if there is
            no way or nothing to fly.
        duration: [s], inf if there is no way.
    """

    library: PrimitiveLibrary
    start: FloatArray
    pieces: FloatArray
    duration: float

    @property
    def exists(self) -> bool:
        """Whether there is a way."""
        return self.duration < math.inf

    @property
    def legs(self) -> tuple[Leg, ...]:
        """Trims and manoeuvres, when and where each begins; none if there is nothing to fly."""
        return self._route.legs if len(self.pieces) else ()

    def samples(self, step: float = 0.1) -> PathSamples:
        """States at equal time steps, and at the end; none if there is no way.

        Args:
            step: between states, the last one excepted [s].

        Raises:
            ArgumentError: a step that is not positive.
        """
        positive("step", step)
        if not self.exists:
            return PathSamples(np.empty(0), np.empty((0, 13)))
        if not len(self.pieces):
            trim = self.library.trim(float(self.library.speeds[int(self.start[4])]))
            return PathSamples(np.zeros(1), trim.state(self.start[:3], self.start[3])[None])
        count = max(math.ceil(self.duration / step - 1e-9), 1)
        times = np.append(step * np.arange(count), self.duration)
        return PathSamples(times, self._route.at(times))

    def __repr__(self) -> str:
        return f"PrimitivePath({len(self.pieces)} pieces, {self.duration:.6g} s)"

    def __str__(self) -> str:
        """A line for each trim and manoeuvre."""
        if not self.exists:
            return "no way"
        lines = [f"{self.duration:.2f} s"]
        for leg in self.legs:
            what = (
                f"hold {_named(leg.motion.key)}"
                if isinstance(leg.motion, Trim)
                else f"change to {_named(leg.motion.last.key)}"
            )
            lines.append(f"  {leg.begin:7.2f} s: {what} for {leg.duration:.2f} s")
        return "\n".join(lines)

    @cached_property
    def _route(self) -> PlannedRoute:
        return planned_route(self.library, self.start, self.pieces)


def _named(key: Key) -> str:
    words = ["hover" if key.speed == 0.0 else f"{key.speed:g} m/s"]
    if key.climb:
        words.append(f"climb {key.climb:g} m/s")
    if key.turn:
        words.append(f"turn {math.degrees(key.turn):.3g} deg/s")
    return ", ".join(words)
