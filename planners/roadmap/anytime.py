"""Grow a roadmap, search it, polish what is found; again and again until told to stop."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route

FIRST = 1000
"""Vertices sampled for the first roadmap: over terrain a first path is then found in some 30 ms."""

FIRST_SLOW = 200
"""The same where every distance is a call of Python."""

GROWTH = 0.5
"""States sampled after that, as a share of those there are."""

LIMIT, EDGES = 1_000_000, 50_000_000
"""Vertices or edges at which growing ends of itself, for the sake of memory: an edge takes 25 B,
and a vehicle has some 250 of them a vertex."""

MOST_SLOW = 1000
"""States sampled at a time at most where every distance is a call of Python."""

Stop = Callable[[], bool]
Polish = Callable[[FloatArray], FloatArray]
"""Improves the states of a path, shape (k, width), or returns them as they are."""


class Progress(NamedTuple):
    """A better path was found.

    Attributes:
        seconds: spent on planning until then [s].
        cost: of the path.
        vertices: of the roadmap.
        edges: of the roadmap.
        evaluated: edges whose exact risk was needed.
    """

    seconds: float
    cost: float
    vertices: int
    edges: int
    evaluated: int


def satisfied_by(objective: Any) -> Callable[[float], bool]:
    """Whether a cost is below the threshold of an objective of OMPL."""
    if objective is None:
        return lambda _cost: False
    threshold = objective.getCostThreshold().value()
    return lambda cost: cost < threshold


class Growing:
    """What a planner does until it is stopped, or nothing is left to gain.

    Args:
        roadmap: with starts and goals.
        polish: local improvement of a path; none if left out.
        enough: whether a cost satisfies, so that work may end.
        seconds: spent before, for the history.
        samples: states to sample at most; no limit if left out.
        history: where a row for each better path is added.

    Attributes:
        more_goals: further goal states may be put in here while the work goes on.
    """

    def __init__(
        self,
        roadmap: Roadmap,
        *,
        polish: Polish | None = None,
        enough: Callable[[float], bool] = lambda _cost: False,
        seconds: float = 0.0,
        samples: int | None = None,
        history: list[Progress] | None = None,
    ) -> None:
        self._roadmap, self._polish, self._enough = roadmap, polish, enough
        self._begin = time.monotonic() - seconds
        self._first = FIRST if roadmap.compiled else FIRST_SLOW
        self._most = LIMIT if roadmap.compiled else MOST_SLOW
        self._left = math.inf if samples is None else samples
        self._history = [] if history is None else history
        self.more_goals: deque[FloatArray] = deque()

    @property
    def seconds(self) -> float:
        """Spent so far [s]."""
        return time.monotonic() - self._begin

    def __call__(self, stop: Stop) -> None:
        """Work until ``stop()``, or until nothing is left to gain."""
        self._look(stop)
        while not stop() and not self._finished():
            self._add_goals()
            size = min(self._batch(), self._left)
            self._left -= size
            self._roadmap.grow(int(size), stop)
            self._look(stop)

    def _batch(self) -> int:
        """Places to sample next: as many vertices as asked for, and not too many edges."""
        roadmap, copies = self._roadmap, self._roadmap.region.copies
        wanted = min(max(self._first, int(GROWTH * roadmap.n)), self._most)
        room = LIMIT - roadmap.n
        if roadmap.edges.m:
            room = min(room, int((EDGES / roadmap.edges.m - 1.0) * roadmap.n))
        return max(min(wanted, room) // copies, 1)

    def _finished(self) -> bool:
        roadmap = self._roadmap
        if roadmap.best is not None and self._enough(roadmap.best.cost):
            return True
        if roadmap.n >= LIMIT or roadmap.edges.m >= EDGES:
            return True
        return roadmap.nothing_to_gain() or self._left <= 0

    def _add_goals(self) -> None:
        while self.more_goals:
            self._roadmap.add_goals(self.more_goals[0][None, :])
            self.more_goals.popleft()

    def _look(self, stop: Stop) -> None:
        """Search the roadmap; polish what is new, and let its corners be vertices."""
        if stop() or not self._take(self._roadmap.search(stop)):
            return
        best = self._roadmap.best
        if self._polish is None or best is None or stop():
            return
        states = self._polish(best.states)
        if not np.array_equal(states, best.states) and not stop():
            self._roadmap.insert_path(best, states)
            self._take(self._roadmap.search(stop))

    def _take(self, route: Route | None) -> bool:
        """Keep a route if it is the best so far."""
        roadmap = self._roadmap
        if route is None or not route.better(roadmap.best):
            return False
        roadmap.best = route
        counts = roadmap.n, roadmap.edges.m, roadmap.evaluated
        self._history.append(Progress(self.seconds, route.cost, *counts))
        return True
