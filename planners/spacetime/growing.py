"""A network of places that grows, and the earliest arrival through it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.motion.moving import MovingObstacles
from ompl_risk.planners.roadmap.neighbours import new_pairs
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.spacetime.earliest import arrive_first, never
from ompl_risk.planners.spacetime.network import Network
from ompl_risk.planners.spacetime.route import Arrival, TimedRoute
from ompl_risk.planners.spacetime.search import Stop
from ompl_risk.planners.spacetime.stays import Stays

FIRST = 250
"""Places sampled for the first network; after that as many as there are."""

LIMIT = 4000
"""Places in a network at which the next one begins anew, with the best route and fresh samples: a
larger one would take so long to set up that it could not be stopped within a tenth of a second."""

ON_ROUTE, BESIDE = 16, 24
"""Places on the best route, and beside its corners, that are tried to improve it."""

SPREAD = 0.1
"""How far beside it they are at first, as a share of its length; it then shrinks."""

GAIN = 1e-3
"""Share of the duration below which a gain is not worth trying the same once more."""

NOTHING = 1e-9
"""Share of the duration that is nothing: an arrival as early as straight flight's is the best."""


class TimedRoadmap:
    """Places sampled in a box, their neighbours, and the route that arrives first so far.

    Sampled are places that are free of what stands still, and through which a vehicle could arrive
    before the best route does. Starts and goals are connected with each other too.

    Args:
        region: where places are sampled.
        clearance: d(q, t), as a ``MovingClearance``.
        starts: positions [m], shape (k, 3), k >= 1.
        departures: when the vehicle is there [s], shape (k,).
        goals: positions [m], shape (j, 3), j >= 1.
        speed: along edges [m/s].
        latest: time at which it must have arrived [s].
        stays: makes what says whether the vehicle may wait, for the search of a number from 0 on.
        seed: of the places tried near the best route.
        threads: at most so many; None uses all processors.

    Attributes:
        places: positions [m], shape (n, 3): starts, goals, and what has been sampled.
        best: the route that arrives first; None before there is one.
        outcome: of the last search.
        sampled: places drawn, free or not.
        edges: of the last network.
        evaluated: flights that were looked at.
    """

    def __init__(
        self,
        region: Region,
        clearance: MovingObstacles,
        starts: FloatArray,
        departures: FloatArray,
        goals: FloatArray,
        *,
        speed: float,
        latest: float,
        stays: Callable[[int], Stays],
        seed: int = 1,
        threads: int | None = None,
    ) -> None:
        self._region, self._clearance, self._stays = region, clearance, stays
        self._speed, self._latest, self._threads = speed, latest, threads
        self._departures = departures
        self._random = np.random.default_rng(seed)
        self._k, self._j = len(starts), len(goals)
        self.places: FloatArray = np.vstack([starts, goals])
        static: Any = getattr(clearance, "static", None)
        self._static = None if static is None else motion_batch(static, Risk(speed=1.0))
        self.best: TimedRoute | None = None
        self.outcome: Arrival | None = None
        self.sampled = self.edges = self.evaluated = self._searches = 0

    @property
    def n(self) -> int:
        """Number of places."""
        return len(self.places)

    @property
    def earliest(self) -> float:
        """No route arrives before this, as the crow flies [s]."""
        return float(self._through(self.places[: self._k]).min())

    def nothing_to_gain(self) -> bool:
        """Whether no route can arrive earlier than the best."""
        if self.best is None:
            return False
        gain = self.best.arrival - self.earliest
        return gain <= NOTHING * (self.best.arrival - self.best.depart)

    def grow(self, n: int) -> None:
        """Draw n places and keep those that matter, instead of the old ones if these are many."""
        if self.n >= LIMIT:
            self.places = self.places[: self._k + self._j]
        if self.best is not None:
            self.places = np.vstack([self.places, self.best.positions[1:-1]])
        drawn = self._region.sample(n, within=self._box())
        self.sampled += n
        promising = drawn[self._through(drawn) < self._before()]
        if self._static is not None:
            promising = promising[self._static.clearances(promising) > 0.0]
        self.places = np.vstack([self.places, promising])

    def search(self, stop: Stop = never) -> bool:
        """Look for an earlier arrival; whether there is one."""
        tail, head = new_pairs(self.places, 0, self._region, self._threads)
        ends = np.array(list(combinations(range(self._k + self._j), 2)))
        network = Network(self.places, np.vstack([ends, np.column_stack([tail, head])]))
        self.edges = len(network.target) // 2
        starts = list(zip(range(self._k), self._departures.tolist(), strict=True))
        goals = range(self._k, self._k + self._j)
        self.outcome = self._arrive(network, starts, goals, self._before(), self._searches, stop)
        self._searches += 1
        before = self.best
        if self.outcome.route is not None and self._is_earlier(self.outcome.route):
            self.best = self.outcome.route
        return self.best is not before

    def _arrive(
        self,
        network: Network,
        starts: Sequence[tuple[int, float]],
        goals: Sequence[int],
        latest: float,
        search: int,
        stop: Stop,
    ) -> Arrival:
        found = arrive_first(
            network,
            self._clearance,
            starts,
            goals,
            speed=self._speed,
            latest=latest,
            stays=self._stays(search),
            stop=stop,
        )
        self.evaluated += found.evaluated
        return found

    def improve(self, stop: Stop = never) -> bool:
        """Look for an earlier arrival near the best route: straighter, or past other corners."""
        spread, first = SPREAD, self.best
        while self.best is not None and spread > SPREAD / 100.0 and not stop():
            before = self.best
            network = self._around(before.positions, spread * self._speed * before.duration)
            start, goal = [(0, before.depart)], [len(before.positions) - 1]
            found = self._arrive(network, start, goal, before.arrival, 0, stop).route
            gain = before.arrival - found.arrival if found is not None else 0.0
            if found is not None and gain > 0.0:
                self.best = found
            if gain <= GAIN * before.duration:
                spread /= 3.0
        return self.best is not first

    def _around(self, corners: FloatArray, spread: float) -> Network:
        """Corners of a route, places on it and places beside it, all connected with each other.

        Args:
            corners: positions [m], shape (k, 3); they keep their numbers.
            spread: of the places beside it [m].
        """
        on_it = _along(corners, ON_ROUTE)
        beside = np.repeat(corners[1:-1], -(-BESIDE // max(len(corners) - 2, 1)), axis=0)
        beside = beside + spread * self._random.normal(size=beside.shape)
        beside = np.clip(beside, self._region.low, self._region.high)
        places = np.vstack([corners, on_it, beside])
        return Network(places, np.column_stack(np.triu_indices(len(places), 1)))

    def _is_earlier(self, route: TimedRoute) -> bool:
        return self.best is None or route.arrival < self.best.arrival

    def _before(self) -> float:
        """Arrivals after this are of no interest [s]."""
        return self._latest if self.best is None else self.best.arrival

    def _through(self, places: FloatArray) -> FloatArray:
        """Earliest conceivable arrivals by way of places [s]."""
        starts, goals = self.places[: self._k], self.places[self._k : self._k + self._j]
        there = np.linalg.norm(places[:, None] - starts, axis=2) / self._speed + self._departures
        on = np.linalg.norm(places[:, None] - goals, axis=2) / self._speed
        return there.min(axis=1) + on.min(axis=1)

    def _box(self) -> tuple[FloatArray, FloatArray]:
        """Corners of a box that holds all places that may matter.

        The way by a place that is a distance r beside the straight line from start to goal, of
        length L, is at least ``sqrt(L^2 + 4 r^2)`` long; so is that by one as far beyond an end.
        """
        longest = self._speed * (self._before() - float(self._departures.min()))
        ends = self.places[: self._k + self._j]
        low, high = ends.min(axis=0) - 0.5 * longest, ends.max(axis=0) + 0.5 * longest
        if self._k == self._j == 1:
            straight = float(np.linalg.norm(ends[1] - ends[0]))
            beside = 0.5 * math.sqrt(max(longest**2 - straight**2, 0.0))
            low, high = ends.min(axis=0) - beside, ends.max(axis=0) + beside
        low, high = np.maximum(low, self._region.low), np.minimum(high, self._region.high)
        return low, np.maximum(high, low)


def _along(corners: FloatArray, count: int) -> FloatArray:
    """So many places on a path at equal steps, shape (count, 3)."""
    steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    gone = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, gone[-1], count + 2)[1:-1]
    return np.column_stack([np.interp(at, gone, corners[:, k]) for k in range(3)])
