"""A roadmap that grows, and the least risky way through it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.motion import MotionBatch, Risk
from ompl_risk.planners.roadmap.bounding import Bounding
from ompl_risk.planners.roadmap.edges import Edges
from ompl_risk.planners.roadmap.gate import Gate, OpenGate
from ompl_risk.planners.roadmap.graph import Graph, Integers
from ompl_risk.planners.roadmap.neighbours import new_pairs
from ompl_risk.planners.roadmap.portions import Portions
from ompl_risk.planners.roadmap.prospects import Prospects
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.roadmap.search import LazySearch, ReweighedSearch, Weigh, duration_within

THIN = 1.5
"""Growth of a roadmap after which its edges are thinned out."""

SPARSE = 3000
"""Vertices below which that is not worth while."""

Stop = Callable[[], bool]


def never() -> bool:
    """Never stop."""
    return False


@dataclass(frozen=True, eq=False)
class Route:
    """A path through a roadmap.

    Attributes:
        vertices: of the roadmap, from a start to a goal, shape (k,).
        states: all corners, shape (j, width), positions [m] first.
        duration: [s].
        risk: p-th power of its norm, or the maximum of f; without any weight of time.
        cost: what is minimised: for additive norms the risk plus the weight of time.
    """

    vertices: Integers
    states: FloatArray
    duration: float
    risk: float
    cost: float

    def better(self, other: Route | None) -> bool:
        """Whether it costs less than another; at the same cost the faster one is better."""
        return other is None or (self.cost, self.duration) < (other.cost, other.duration)


class Roadmap:
    """States sampled in a region, connected to their neighbours; edges are evaluated when needed.

    Args:
        region: where states are sampled.
        motions: the pure risk of motions: over a ``Risk`` whose ``duration_weight`` is 0.
        risk: how risk is counted, with the weight of time.
        gate: what is allowed besides what has a finite risk.
        undirected: whether motions can be flown both ways, at the same risk.
        threads: at most so many; ``None`` uses all processors.

    Attributes:
        states: of the vertices, shape (n, width).
        clearance: there [m], shape (n,).
        starts, goals: vertices where paths begin and end.
        edges: between the vertices.
        whole: starts and goals with all their numbers, by vertex.
        best: the best route so far.
        evaluated: number of edges whose exact risk was needed.
        reached: vertices that could be reached from a start when a search last was in vain.
    """

    def __init__(
        self,
        region: Region,
        motions: MotionBatch,
        risk: Risk,
        *,
        gate: Gate | None = None,
        undirected: bool = True,
        threads: int | None = None,
    ) -> None:
        self.region, self.motions, self.risk = region, motions, risk
        self.gate = OpenGate() if gate is None else gate
        self.states: FloatArray = np.empty((0, region.width))
        self.clearance: FloatArray = np.empty(0)
        self.starts: list[int] = []
        self.goals: list[int] = []
        self.edges = Edges(time_weight=self.time_weight, undirected=undirected)
        self.whole: dict[int, FloatArray] = {}
        self.best: Route | None = None
        self.evaluated = 0
        self.reached = 0
        self._threads = threads
        self._thinned = 0
        self._search = LazySearch(self.edges, maximum=self.maximum)
        self._portions = Portions()
        self._prospects = Prospects(self)
        self._unfinished: Bounding | None = None

    @property
    def maximum(self) -> bool:
        """Whether the risk of a path is the maximum of its edges', not their sum."""
        return math.isinf(self.risk.exponent)

    @property
    def compiled(self) -> bool:
        """Whether no Python runs for single states or motions."""
        return self.motions.compiled and self.gate.compiled

    @property
    def n(self) -> int:
        """Number of vertices."""
        return len(self.states)

    def add_starts(self, states: FloatArray) -> None:
        """Add states where paths may begin, those that are allowed; see ``add_goals``."""
        self.starts += self._add_ends(states)

    def add_goals(self, states: FloatArray) -> None:
        """Add states where paths may end, those that are allowed.

        Args:
            states: shape (k, width), or wider: what the roadmap does not plan is kept in ``whole``.
        """
        self.goals += self._add_ends(states)

    def _add_ends(self, states: FloatArray) -> list[int]:
        planned = np.ascontiguousarray(states[:, : self.region.width])
        allowed = self._allowed(planned)
        numbers = self.insert(planned[allowed]).tolist()
        self.whole.update(zip(numbers, states[allowed], strict=True))
        return numbers

    def grow(self, n: int, stop: Stop = never) -> int:
        """Sample n places and connect those that are allowed and could improve on ``best``.

        If ``stop`` said so before they were connected, the next call goes on with the same ones.

        Returns:
            How many states were added; fewer if ``stop`` says so.
        """
        if self._unfinished is not None:
            return len(self._connect(self._unfinished, stop))
        states = self.region.sample(n, within=self._prospects.box())
        parts = self._parts(len(states), stop)
        found = [states[part][self._useful(states[part])] for part in parts]
        added = len(self.insert(np.vstack([np.empty((0, self.region.width)), *found]), stop))
        if self.region.thins and self.n > max(THIN * self._thinned, SPARSE):
            self.thin_out()
            self._thinned = self.n
        return added

    def _allowed(self, states: FloatArray) -> NDArray[np.bool_]:
        allowed = self.motions.clearances(states) > 0.0
        allowed[allowed] = self.gate.allows_states(states[allowed])
        return allowed

    def _useful(self, states: FloatArray) -> NDArray[np.bool_]:
        useful = self._allowed(states)
        d = self.motions.clearances(states[useful])
        useful[useful] = self._prospects.promising(states[useful], d)
        return useful

    def nothing_to_gain(self) -> bool:
        """Whether no path can be better than the best, however much the roadmap grows."""
        return self._prospects.is_exhausted()

    def insert(self, states: FloatArray, stop: Stop = never) -> Integers:
        """Add states, which must be free, and connect them to their neighbours.

        Returns:
            Their numbers, shape (k,); none if ``stop`` said so before they were connected.
        """
        # A user's clearance may raise: nothing is changed before all has been answered.
        every = np.vstack([self.states, states])
        clearance = np.concatenate([self.clearance, self.motions.clearances(states)])
        tail, head = new_pairs(every, self.n, self.region, self._threads)
        if not self.edges.undirected:
            tail, head = np.concatenate([tail, head]), np.concatenate([head, tail])
        return self._connect(Bounding(self.motions, every, clearance, tail, head), stop)

    def _connect(self, work: Bounding, stop: Stop) -> Integers:
        """Take in the new vertices of ``work`` once it is done; their numbers, shape (k,)."""
        done = work.finished(stop)
        self._unfinished = None if done else work
        if not done:
            return np.empty(0, np.int32)
        start, found = self.n, work.result()
        self.states, self.clearance = work.states, work.clearance
        self.edges.add(self.n, found.tail, found.head, risk=found.risk, duration=found.duration)
        return np.arange(start, self.n, dtype=np.int32)

    def thin_out(self) -> None:
        """Connect all vertices anew to their nearest, and keep what else has been evaluated.

        Vertices that were neighbours in a sparser roadmap no longer are: a roadmap grown in many
        batches would hold twice the edges of one sampled at once, in memory and in every search.
        """
        old = self.edges
        kept = np.flatnonzero(old.known & np.isfinite(old.weight))
        tail, head = (column[kept] for column in old.ends())
        risk, duration = old.risk(kept), old.duration[kept]
        near, far = new_pairs(self.states, 0, self.region, self._threads)
        if not old.undirected:
            near, far = np.concatenate([near, far]), np.concatenate([far, near])
        new = ~np.isin(self._keys(near, far), self._keys(tail, head))
        work = Bounding(self.motions, self.states, self.clearance, near[new], far[new])
        work.finished(never)
        near, far, bound, least = work.result()
        self.edges = Edges(time_weight=self.time_weight, undirected=old.undirected)
        self.edges.add(self.n, tail, head, risk=risk, duration=duration)
        self.edges.evaluated(np.arange(len(kept), dtype=np.int32), risk, duration)
        self.edges.add(self.n, near, far, risk=bound, duration=least)
        self._search = LazySearch(self.edges, maximum=self.maximum)

    def _keys(self, tail: Integers, head: Integers) -> NDArray[np.int64]:
        """A number for each pair of vertices, the same both ways if edges are undirected."""
        if self.edges.undirected:
            tail, head = np.minimum(tail, head), np.maximum(tail, head)
        return tail.astype(np.int64) * self.n + head

    def insert_path(self, route: Route, states: FloatArray) -> None:
        """Add the corners of a path that leads from the start to the goal of a route.

        Args:
            route: with the same ends.
            states: corners of the path, shape (k, width).
        """
        chain = np.concatenate([route.vertices[:1], self.insert(states[1:-1]), route.vertices[-1:]])
        tail, head = chain[:-1].copy(), chain[1:].copy()
        numbers = np.arange(self.edges.m, self.edges.m + len(tail), dtype=np.int32)
        least = self.motions.least_durations(self.states[tail], self.states[head])
        self.edges.add(self.n, tail, head, risk=np.zeros(len(tail)), duration=least)
        self.evaluate(numbers, tail, head)

    def search(self, stop: Stop = never) -> Route | None:
        """The least costly path through the roadmap, the fastest of equals.

        Returns:
            The path; None if there is none, or ``stop`` said so first.
        """
        self._search.update(self.goals)
        best = self._path(self._search, stop)
        if best is None or not self.maximum:
            return best
        return self._path_by(duration_within(best.risk), stop) or best

    def fastest(self, stop: Stop = never) -> Route | None:
        """The fastest path through the roadmap, whatever its risk; None as in ``search``."""
        return self._path_by(duration_within(math.inf), stop)

    def safest(self, stop: Stop = never) -> Route | None:
        """The path of least risk, whatever its duration; None as in ``search``."""
        if self.maximum:
            return self.search(stop)
        tie_break = self._tie_break
        return self._path_by(lambda risk, duration: risk + tie_break * duration, stop)

    def _path_by(self, weigh: Weigh, stop: Stop) -> Route | None:
        search = ReweighedSearch(self.edges, weigh)
        search.update(self.goals)
        return self._path(search, stop)

    def _path(self, search: LazySearch, stop: Stop) -> Route | None:
        def evaluate(numbers: Integers, tail: Integers, head: Integers) -> None:
            self.evaluate(numbers, tail, head, stop)

        half = search.path(self.starts, evaluate, stop)
        if half is not None:
            return self._route(half)
        if not stop():
            self.reached = self._count_reached()
        return None

    def _count_reached(self) -> int:
        bounds = Graph(*self.edges.rows, self.edges.weight, self.edges.weight, self.maximum)
        return int(np.isfinite(bounds.tree(self.starts, self.edges.weight).distance).sum())

    def _route(self, half: NDArray[np.int64]) -> Route:
        source = int(np.searchsorted(self.edges.first, half[0], side="right")) - 1
        vertices = np.append(np.int32(source), self.edges.target[half])
        numbers = self.edges.edge[half]
        risk = self.risk.combine(self.edges.risk(numbers))
        return self.route(vertices, float(self.edges.duration[numbers].sum()), risk)

    def route(self, vertices: Integers, duration: float, risk: float) -> Route:
        """A path along vertices, as a route: with what steering puts between them."""
        corners = self.states[vertices]
        pieces = [piece[1:] for piece in self.motions.samples(corners[:-1], corners[1:])]
        states = np.vstack([corners[:1], *pieces])
        cost = risk if self.maximum else risk + self.risk.weight * duration
        return Route(vertices, states, duration, risk, cost)

    def evaluate(
        self, numbers: Integers, tail: Integers, head: Integers, stop: Stop = never
    ) -> None:
        """Find the exact risk of edges; of fewer if ``stop`` says so."""
        if self.edges.undirected:  # sampling makes a motion and its reverse differ in some digit
            tail, head = np.minimum(tail, head), np.maximum(tail, head)
        for part in self._parts(len(numbers), stop):
            a, b = self.states[tail[part]], self.states[head[part]]
            risk = np.full(len(a), math.inf)
            allowed = self.gate.allows_motions(a, b)
            risk[allowed] = self.motions.costs(a[allowed], b[allowed])
            self.edges.evaluated(numbers[part], risk, self.motions.durations(a, b))
            self.evaluated += len(a)

    def _parts(self, n: int, stop: Stop) -> Iterable[slice]:
        """Compiled work is quick enough to be done in one go."""
        return [slice(0, n)] if self.compiled else self._portions.of(n, stop)

    @property
    def time_weight(self) -> float:
        """The weight of time, or a tie-break among ways of equal risk that changes no digit."""
        if self.maximum:
            return 0.0
        return self.risk.weight or self._tie_break

    @property
    def _tie_break(self) -> float:
        return 1e-12 * self.risk.avoidance.typical**self.risk.exponent

    def graph(self) -> Graph:
        """The edges that have been evaluated."""
        return self.edges.graph(maximum=self.maximum)

    @property
    def nbytes(self) -> int:
        """Memory of vertices, edges and search tree."""
        return self.states.nbytes + self.clearance.nbytes + self.edges.nbytes + self._search.nbytes
