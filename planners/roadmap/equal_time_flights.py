"""Flights of equal time through a roadmap of trajectory primitives."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.frechet import frechet_distance
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.roadmap.building import sides_of
from ompl_risk.planners.roadmap.equal_time import choice_in_words
from ompl_risk.planners.roadmap.exploring import alternative_routes
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.planners.roadmap.shortening import shortened
from ompl_risk.planners.sides import Sides

SPARE, LEAST = 3, 30
"""Alternatives looked for, in those wanted, and at least: some grow alike as they are shortened."""

STEP = 50.0
"""Distance of the points at which paths are compared [m]."""


@dataclass(frozen=True, eq=False)
class EqualTimeFlights:
    """Flights of nearly the same duration that differ pairwise.

    Attributes:
        flights: the fastest first.
        routes: that they follow.
        separation: least Frechet distance between two of them [m], inf for fewer than two.
        sides: on how many sides of the summits that are too high to cross they pass.
        tried: how many of the roadmap's alternatives were shortened and compared.
    """

    flights: tuple[Flight, ...]
    routes: tuple[Route, ...]
    separation: float
    sides: int
    tried: int

    @property
    def summary(self) -> str:
        """How many there are, of how many, on how many sides."""
        return choice_in_words(len(self.flights), self.tried, self.sides)


@dataclass(frozen=True, eq=False)
class _Candidate:
    route: Route
    curve: FloatArray
    word: Hashable

    @classmethod
    def of(cls, route: Route, sides: Sides | None) -> _Candidate:
        positions = np.ascontiguousarray(route.states[:, :3])
        word = None if sides is None else sides.word(positions)
        return cls(route, _thinned(positions), word)

    def differs(self, other: _Candidate, min_distance: float) -> bool:
        if self.word != other.word:
            return True
        return frechet_distance(self.curve, other.curve) >= min_distance


def equal_time_flights(
    roadmap: Roadmap,
    problem: Problem,
    steering: HelicopterSteering,
    count: int,
    *,
    excess: float = 0.05,
    min_distance: float,
    tidy: Callable[[Route, Roadmap], Route] = shortened,
    on_path: Callable[[int], object] = lambda _chosen: None,
) -> EqualTimeFlights:
    """Alternatives of a roadmap, tidied up, and flown if they still differ.

    A flight deviates by up to 0.4 m from its plan. By so much it may fall short of the problem's
    ``min_clearance``; one that collides is left out.

    Args:
        roadmap: of `flight_roadmap`.
        problem: the same problem.
        steering: the same steering.
        count: how many at most.
        excess: relative excess of duration over the fastest that is allowed.
        min_distance: least Frechet distance between two paths on the same side of all summits [m].
        tidy: what is done to each alternative before it is compared with those chosen; `shortened`
            leaves out vertices where that costs neither time nor risk.
        on_path: called with the number of paths so far.

    Raises:
        ArgumentError: a number out of range.
    """
    sides = sides_of(problem)
    routes = alternative_routes(
        roadmap, max(SPARE * count, LEAST), excess=excess, min_distance=min_distance, sides=sides
    )
    chosen: list[_Candidate] = []
    flights: dict[_Candidate, Flight] = {}
    tried = 0
    for route in routes:
        if len(chosen) == count:
            break
        tried += 1
        candidate = _Candidate.of(tidy(route, roadmap), sides)
        if all(candidate.differs(one, min_distance) for one in chosen):
            flight = steering.flight(roadmap.states[candidate.route.vertices])
            if _is_free(flight, problem):
                flights[candidate] = flight
                chosen = _timely([*chosen, candidate], excess)
        on_path(len(chosen))
    return _together(chosen, [flights[one] for one in chosen], tried)


def _together(
    chosen: Sequence[_Candidate], flights: Sequence[Flight], tried: int
) -> EqualTimeFlights:
    """The flights of the candidates, and how they differ."""
    gaps = [frechet_distance(a.curve, b.curve) for a, b in combinations(chosen, 2)]
    return EqualTimeFlights(
        flights=tuple(flights),
        routes=tuple(one.route for one in chosen),
        separation=min(gaps, default=float("inf")),
        sides=len({one.word for one in chosen}),
        tried=tried,
    )


def _is_free(flight: Flight, problem: Problem) -> bool:
    """Whether all flown states are clear of obstacles."""
    return bool(np.all(problem.clearance(np.ascontiguousarray(flight.states[:, :3])) > 0.0))


def _timely(candidates: list[_Candidate], excess: float) -> list[_Candidate]:
    """Those within the excess of the fastest, which comes first."""
    fastest = min(candidates, key=lambda one: one.route.duration)
    limit = (1.0 + excess) * fastest.route.duration
    rest = [one for one in candidates if one is not fastest and one.route.duration <= limit]
    return [fastest, *rest]


def _thinned(positions: FloatArray) -> FloatArray:
    """Points of a path some ``STEP`` apart, with both ends."""
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    gone = np.append(0.0, np.cumsum(steps))
    at = np.linspace(0.0, gone[-1], max(int(gone[-1] / STEP), 1) + 1)
    return np.column_stack([np.interp(at, gone, column) for column in positions.T])
