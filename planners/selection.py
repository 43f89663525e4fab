"""Choose candidates of equal time that differ from each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.errors import ArgumentError
from ompl_risk.frechet import frechet_distance
from ompl_risk.planners.task import Candidate

SAMPLES = 200
"""Points of a path when it is compared with another: 75 m apart over 15 km."""


@dataclass(frozen=True, eq=False)
class Selection:
    """The candidates chosen, and what became of the others.

    Args:
        chosen: the candidates, the fastest first, then each the one farthest from those before it.
        separation: least Frechet distance between two of those chosen [m]; inf for fewer than two.
        pathless: candidates without a path.
        slow: those whose path is longer than the fastest's by more than the tolerance.
        alike: those too near to a chosen one.
        surplus: those that were not needed.
    """

    chosen: tuple[Candidate, ...]
    separation: float
    pathless: tuple[Candidate, ...]
    slow: tuple[Candidate, ...]
    alike: tuple[Candidate, ...]
    surplus: tuple[Candidate, ...]

    @property
    def summary(self) -> str:
        """How many were chosen of how many, and why the others were not."""
        total = sum(len(group) for group in (self.chosen, *self._others.values()))
        reasons = [f"{len(group)} {why}" for why, group in self._others.items() if group]
        return f"{len(self.chosen)} of {total} candidates chosen" + (
            f" ({', '.join(reasons)})" if reasons else ""
        )

    @property
    def _others(self) -> dict[str, tuple[Candidate, ...]]:
        return {
            "without a path": self.pathless,
            "too slow": self.slow,
            "too like a chosen one": self.alike,
            "not needed": self.surplus,
        }


def select(
    candidates: Sequence[Candidate],
    count: int = 5,
    *,
    tolerance: float = 0.05,
    min_distance: float,
) -> Selection:
    """Choose candidates within a tolerance of the fastest, as different as possible.

    Greedy: the fastest first, then again and again the one whose discrete Frechet distance to the
    nearest of those chosen is greatest, as long as it is at least `min_distance`. That gets within
    a factor of two of the best least distance (Gonzalez, 1985). Ties go to the first given.

    Args:
        candidates: from `candidates`; speeds are equal, so lengths compare durations.
        count: how many to choose at most.
        tolerance: relative excess of duration over the fastest that is allowed.
        min_distance: least Frechet distance between two chosen paths [m], positive.

    Raises:
        ArgumentError: a number out of range.
    """
    if count < 1:
        raise ArgumentError("count", count, "a whole number of at least 1")
    if not (tolerance >= 0.0 and math.isfinite(tolerance)):
        raise ArgumentError("tolerance", tolerance, "0 or more")
    positive("min_distance", min_distance)
    solved = [c for c in candidates if c.solved]
    longest = (1.0 + tolerance) * min((c.length for c in solved), default=0.0)
    timely = [c for c in solved if c.length <= longest]
    order, gaps = _farthest_first(timely)
    different = [i for i, gap in zip(order, gaps, strict=True) if gap >= min_distance]
    chosen = different[:count]
    alike = [i for i in order if i not in different]
    return Selection(
        chosen=tuple(timely[i] for i in chosen),
        separation=min((gaps[order.index(i)] for i in chosen), default=math.inf),
        pathless=tuple(c for c in candidates if not c.solved),
        slow=tuple(c for c in solved if c.length > longest),
        alike=tuple(timely[i] for i in alike),
        surplus=tuple(timely[i] for i in different[count:]),
    )


def _farthest_first(candidates: Sequence[Candidate]) -> tuple[list[int], list[float]]:
    """All candidates, the shortest first, then the farthest from those before; and how far."""
    curves = [_curve(c) for c in candidates]
    left = list(range(len(curves)))
    order: list[int] = []
    gaps: list[float] = []
    nearest = np.full(len(curves), math.inf)
    while left:
        if order:
            chosen = max(left, key=lambda i: (nearest[i], -i))
        else:
            chosen = min(left, key=lambda i: (candidates[i].length, i))
        order.append(chosen)
        gaps.append(float(nearest[chosen]))
        left.remove(chosen)
        for i in left:
            nearest[i] = min(nearest[i], frechet_distance(curves[i], curves[chosen]))
    return order, gaps


def _curve(candidate: Candidate) -> FloatArray:
    """Points at equal steps along the path."""
    path = candidate.trajectory(1.0)
    return path.resample(np.linspace(0.0, path.duration, SAMPLES + 1)).positions
