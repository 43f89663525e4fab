"""Paths of equal time through a roadmap, without the corners that sampling gives them."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.frechet import frechet_distance
from ompl_risk.planners.improve import simplify
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.roadmap.building import sides_of
from ompl_risk.planners.roadmap.exploring import alternative_routes
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.planners.sides import Sides
from ompl_risk.trajectory import Trajectory

SPARE, LEAST = 3, 30
"""Alternatives looked for, in those wanted, and at least: some grow alike as they are smoothed."""

ROUNDS = 1
"""How often corners are cut: each time paths come nearer to those that pass the same summits."""

POINTS = 200
"""Points of a path when it is compared with another: 75 m apart over 15 km."""


def choice_in_words(chosen: int, tried: int, sides: int) -> str:
    """How many paths were chosen, of how many, on how many sides."""
    where = "on one side" if sides == 1 else f"on {sides} sides"
    return (
        f"{chosen} of {tried} alternatives in the roadmap chosen, {where} of the summits that are "
        "too high to cross"
    )


@dataclass(frozen=True, eq=False)
class EqualTimePaths:
    """Paths of nearly the same duration that differ pairwise.

    Attributes:
        positions: corners of each path [m], shapes (k, 3); the fastest first.
        separation: least Frechet distance between two of them [m], inf for fewer than two.
        sides: on how many sides of the summits that are too high to cross they pass.
        tried: how many of the roadmap's alternatives were smoothed and compared.
    """

    positions: tuple[FloatArray, ...]
    separation: float
    sides: int
    tried: int

    @property
    def summary(self) -> str:
        """How many there are, of how many, on how many sides."""
        return choice_in_words(len(self.positions), self.tried, self.sides)


@dataclass(frozen=True, eq=False)
class _Path:
    """A path with what is compared."""

    positions: FloatArray
    length: float
    curve: FloatArray
    word: Hashable

    @classmethod
    def of(cls, positions: FloatArray, sides: Sides | None) -> _Path:
        whole = Trajectory.at_constant_speed(positions, 1.0)
        curve = whole.resample(np.linspace(0.0, whole.duration, POINTS + 1)).positions
        word = None if sides is None else sides.word(positions)
        return cls(positions, whole.duration, curve, word)

    def gap(self, other: _Path) -> float:
        return frechet_distance(self.curve, other.curve)


def equal_time_paths(
    roadmap: Roadmap,
    problem: Problem,
    count: int,
    *,
    excess: float = 0.05,
    min_distance: float,
    on_path: Callable[[int], object] = lambda _chosen: None,
) -> EqualTimePaths:
    """Alternatives of a roadmap, smoothed at no cost in risk or time, and still different.

    Args:
        roadmap: of `roadmap_of`.
        problem: the same problem.
        count: how many at most.
        excess: relative excess of duration over the fastest that is allowed.
        min_distance: least Frechet distance between two paths on the same side of all summits [m].
        on_path: called with the number of paths so far.

    Raises:
        ArgumentError: a number out of range.
    """
    sides = sides_of(problem)
    routes = alternative_routes(
        roadmap, max(SPARE * count, LEAST), excess=excess, min_distance=min_distance, sides=sides
    )
    chosen: list[_Path] = []
    tried = 0
    for route in routes:
        if len(chosen) == count:
            break
        tried += 1
        path = _Path.of(_smoothed(route, roadmap, problem), sides)
        if all(path.word != one.word or path.gap(one) >= min_distance for one in chosen):
            chosen.append(path)
            chosen = _timely(chosen, excess)
        on_path(len(chosen))
    gaps = [one.gap(other) for one, other in combinations(chosen, 2)]
    return EqualTimePaths(
        positions=tuple(path.positions for path in chosen),
        separation=min(gaps, default=float("inf")),
        sides=len({path.word for path in chosen}),
        tried=tried,
    )


def _timely(paths: list[_Path], excess: float) -> list[_Path]:
    """The paths within the excess of the fastest, which comes first."""
    fastest = min(paths, key=lambda path: path.length)
    rest = [path for path in paths if path is not fastest]
    limit = (1.0 + excess) * fastest.length
    return [fastest, *(path for path in rest if path.length <= limit)]


def _smoothed(route: Route, roadmap: Roadmap, problem: Problem) -> FloatArray:
    return simplify(
        route.states[:, :3],
        clearance=problem.clearance,
        risk=roadmap.risk,
        obstacles=problem.obstacles,
        rounds=ROUNDS,
    ).positions
