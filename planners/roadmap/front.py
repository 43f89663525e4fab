"""What is left to choose from when neither duration nor risk alone decides."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, real_number
from ompl_risk.errors import ArgumentError, NoWayError
from ompl_risk.planners.roadmap.graph import Way


@dataclass(frozen=True, eq=False)
class ParetoSet(ReadOnlyArrays):
    """Ways of which none is both as fast and of as little risk as another.

    Iterates over its ways; empty, and false, if no way is within the limits.

    Attributes:
        ways: the fastest first, durations strictly rising and risks strictly falling.
        longest: greatest duration that was searched [s].
        riskiest: greatest risk that was searched.
        precision: for every path within these limits there is a way that is no slower and whose
            risk is at most (1 + precision) times as great.
    """

    ways: tuple[Way, ...]
    longest: float = math.inf
    riskiest: float = math.inf
    precision: float = 0.0

    def __len__(self) -> int:
        return len(self.ways)

    def __iter__(self) -> Iterator[Way]:
        return iter(self.ways)

    def __getitem__(self, place: int) -> Way:
        return self.ways[place]

    @cached_property
    def durations(self) -> FloatArray:
        """Durations of the ways [s], strictly rising, read-only."""
        return _column([way.duration for way in self.ways])

    @cached_property
    def risks(self) -> FloatArray:
        """Risks of the ways, strictly falling, in the unit of `Way.risk`, read-only."""
        return _column([way.risk for way in self.ways])

    def least_risk(self, within: float) -> Way:
        """The way of least risk among those that take at most ``within`` [s].

        Any other path that takes no longer has at least 1 / (1 + precision) times its risk.

        Raises:
            NoWayError: even the fastest way takes longer.
            ArgumentError: not a number, or above `longest`, where ways have not been searched.
        """
        within = self._limit("within", within, "longest", self.longest)
        place = int(np.searchsorted(self.durations, within, side="right")) - 1
        if place < 0:
            best = f"the fastest takes {self.ways[0].duration:.12g} s" if self.ways else ""
            raise NoWayError(f"takes at most {within:.12g} s", best or self._why_empty)
        return self.ways[place]

    def fastest(self, within_risk: float) -> Way:
        """The fastest way among those whose risk is at most ``within_risk``.

        No path whose risk is at most within_risk / (1 + precision) is faster.

        Args:
            within_risk: in the unit of `Way.risk`: the p-th power of the norm, or the maximum norm.

        Raises:
            NoWayError: even the safest way has a greater risk.
            ArgumentError: not a number, or above `riskiest`, where ways have not been searched.
        """
        within_risk = self._limit("within_risk", within_risk, "riskiest", self.riskiest)
        place = int(np.searchsorted(-self.risks, -within_risk, side="left"))
        if place == len(self):
            best = f"the safest has {self.ways[-1].risk:.12g}" if self.ways else ""
            wanted = f"within {self.longest:.12g} s has a risk of at most {within_risk:.12g}"
            raise NoWayError(wanted, best or self._why_empty)
        return self.ways[place]

    def _limit(self, argument: str, value: float, limit: str, searched: float) -> float:
        number = real_number(argument, value, "a number")
        if number > searched:
            allowed = f"at most {limit} = {searched:.12g}, beyond which ways were not searched"
            raise ArgumentError(argument, value, allowed)
        return number

    @property
    def _why_empty(self) -> str:
        return f"no path leads to a goal within {self.longest:.12g} s and risk {self.riskiest:.12g}"


def _column(values: list[float]) -> FloatArray:
    column = np.array(values, dtype=np.float64)
    column.setflags(write=False)
    return column
