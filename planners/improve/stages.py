"""From one path to a better one: resampled, descended, thinned, and each judged exactly."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.improve.chain import Chain, Surroundings
from ompl_risk.planners.improve.descent import STEPS, Descent, Limits
from ompl_risk.planners.improve.judge import Judge
from ompl_risk.planners.improve.measure import Measure
from ompl_risk.planners.improve.thinning import thinned

SPACING = 0.75
"""Distance between corners while refining, in units of d0."""

FEWEST, MOST = 33, 2001
"""Corners while refining."""

PIECE = 0.25
"""Longest piece between samples, in units of d0."""

FINEST = 0.02
"""Shortest such piece where obstacles are near, half the clearance there, in units of d0."""

SAMPLES = 50_000
"""Most samples, about; d0 is tiny against a path that would take more."""

SURROGATES = (8.0, 16.0, 32.0)
"""Exponents p whose L^p norms stand for the maximum norm, one after the other."""

THINNING = (0.16, 0.08, 0.04, 0.02, 0.01)
"""Tolerances that thinning tries, in units of d0."""

DESCENT = 0.7
"""Share of the time left that the descent may take; the rest is for thinning."""

POLISH = 12
"""Steps of the descent over the few corners that are left."""

SHARE = 0.02
"""Share of the gain, and of the cost, that may be given back for fewer corners."""

GAIN = 1e-4
"""Least relative gain of the norm's p-th power that is told from no gain."""


@dataclass(frozen=True, eq=False)
class Found:
    """A path that may be flown and keeps to all limits.

    Attributes:
        corners: shape (n, 3) [m].
        power: p-th power of its norm; the norm for p = inf.
        cost: power + weight duration.
    """

    corners: FloatArray
    power: float
    cost: float


class Refiner:
    """Looks for paths of lower cost near given ones.

    Args:
        judge: has the last word.
        surroundings: of the approximate cost.
        limits: what paths have to keep to.
        before: figures of the path that is to be improved.
        weight: cost of a second.
    """

    def __init__(
        self,
        judge: Judge,
        surroundings: Surroundings,
        limits: Limits,
        before: Measure,
        weight: float,
    ) -> None:
        self._judge, self._around, self._limits = judge, surroundings, limits
        self._before, self._weight = before, weight
        self._d0, self._p = judge.risk.avoidance.d0, judge.risk.exponent
        self._power = before.norm if math.isinf(self._p) else before.norm**self._p
        self._cost = self._power + weight * before.duration

    @property
    def deadline(self) -> float:
        """When time is up, by time.monotonic() [s]."""
        return self._limits.deadline

    @property
    def late(self) -> bool:
        """Whether time is up."""
        return time.monotonic() > self.deadline

    def search(self, start: FloatArray) -> Found | None:
        """The best path found from a start; None if none is admissible."""
        best = None
        if self._power == 0.0:
            return None
        corners = evenly(start, self._corner_count(start))
        now = time.monotonic()
        end = now + DESCENT * (self.deadline - now)
        for p in SURROGATES if math.isinf(self._p) else (self._p,):
            following = self._descend(corners, p, STEPS, end)
            if following is None:
                break
            corners = following
            best = cheaper(best, self.judged(corners))
        return None if best is None else self._with_fewer_corners(best)

    def _with_fewer_corners(self, fine: Found) -> Found:
        """Leave out corners and let the others make up for it, for little of the gain."""
        p = SURROGATES[-1] if math.isinf(self._p) else self._p
        enough = fine.cost + SHARE * min(max(self._cost - fine.cost, 0.0), fine.cost)
        for off in THINNING:
            few, polished = thinned(fine.corners, off * self._d0), None
            if len(few) > 2 and not self.late:
                polished = self._descend(few, p, POLISH, self.deadline)
            for corners in (polished, few):
                found = None if corners is None else self.judged(corners)
                if found is not None and found.cost <= enough:
                    return found
        return fine

    def _descend(
        self, corners: FloatArray, p: float, steps: int, deadline: float
    ) -> FloatArray | None:
        """Lower the approximate cost; f is scaled so that the given path costs 1 a second."""
        scale = self._before.norm
        if not math.isinf(self._p):
            scale /= self._before.duration ** (1.0 / p)
        chain = Chain(
            self._around,
            exponent=p,
            scale=scale,
            weight=self._weight / scale**p,
            counts=self._counts(corners),
            durations=self._judge.durations(corners[:-1], corners[1:]),
        )
        limits = self._limits._replace(deadline=deadline)
        return Descent(chain, limits, steps=steps).run(corners)

    def _counts(self, corners: FloatArray) -> NDArray[np.int64]:
        """Pieces of each leg: short where obstacles are near, since f changes quickly there."""
        d, _ = self._around.field(corners, self._d0)
        near = np.clip(0.5 * np.minimum(d[:-1], d[1:]), FINEST * self._d0, PIECE * self._d0)
        pieces = np.linalg.norm(np.diff(corners, axis=0), axis=1) / near
        pieces *= min(1.0, SAMPLES / pieces.sum())
        return np.maximum(np.ceil(pieces), 2).astype(np.int64)

    def _corner_count(self, path: FloatArray) -> int:
        length = self._judge.duration(path) * self._judge.risk.speed
        return min(max(math.ceil(length / (SPACING * self._d0)) + 1, FEWEST), MOST)

    def judged(self, corners: FloatArray) -> Found | None:
        """What a path exactly costs; None if it is not admissible, or no gain."""
        duration = self._judge.duration(corners)
        if duration > self._limits.longest:
            return None
        power = self._judge.power(corners)
        if not power <= self._power * (1.0 - GAIN):
            return None
        return Found(corners, power, power + self._weight * duration)

    def gains(self, found: Found) -> bool:
        """Whether a path costs less than the given one."""
        return found.cost < self._cost

    def unweighted(self) -> Refiner:
        """The same without a cost of time."""
        return Refiner(self._judge, self._around, self._limits, self._before, 0.0)


def evenly(path: FloatArray, count: int) -> FloatArray:
    """Points along a path, equally far apart along it, shape (count, 3)."""
    legs = np.linalg.norm(np.diff(path, axis=0), axis=1)
    reached = np.concatenate([[0.0], np.cumsum(legs)])
    along = np.linspace(0.0, reached[-1], count)
    return np.column_stack([np.interp(along, reached, path[:, k]) for k in range(3)])


def cheaper(one: Found | None, other: Found | None) -> Found | None:
    """The path of lower cost."""
    if one is None or (other is not None and other.cost < one.cost):
        return other
    return one
