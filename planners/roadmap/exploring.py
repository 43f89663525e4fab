"""Not one path but all that matter: alternatives of equal time, and the Pareto set."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.roadmap.alternatives import alternatives
from ompl_risk.planners.roadmap.front import ParetoSet
from ompl_risk.planners.roadmap.graph import Graph, Way
from ompl_risk.planners.roadmap.pareto import pareto_set
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.planners.sides import Sides


def evaluate_within(roadmap: Roadmap, longest: float, riskiest: float = math.inf) -> Graph:
    """Evaluate all edges that a path from a start to a goal within the limits may use.

    An edge matters if the fastest way through it is not too long, and the least risky way through
    it not too risky, by what is known of the others so far.

    Args:
        roadmap: with starts and goals.
        longest: greatest duration of a path [s].
        riskiest: greatest risk of a path.

    Returns:
        The graph of the edges that have been evaluated.
    """
    edges, risk = roadmap.edges, roadmap.edges.risk()
    bounds = Graph(*edges.rows, risk, edges.duration, roadmap.maximum, edges.undirected)
    tail, head = edges.ends()
    ends = roadmap.starts, roadmap.goals
    matters = ~edges.known
    for weight, limit, maximum in (
        (bounds.flyable_duration, longest, False),
        (risk, riskiest, roadmap.maximum),
    ):
        if not math.isfinite(limit):
            continue
        there = bounds.tree(ends[0], weight, maximum=maximum).distance
        back = bounds.reverse.tree(ends[1], weight, maximum=maximum).distance
        through = _through(there[tail], weight, back[head], maximum)
        if edges.undirected:
            through = np.minimum(through, _through(there[head], weight, back[tail], maximum))
        matters &= through <= limit * (1.0 + 1e-12)
    numbers = np.flatnonzero(matters).astype(np.int32)
    roadmap.evaluate(numbers, tail[numbers], head[numbers])
    return roadmap.graph()


def _through(there: FloatArray, weight: FloatArray, back: FloatArray, maximum: bool) -> FloatArray:
    """Least weight of a path through each edge."""
    if maximum:
        return np.maximum(np.maximum(there, weight), back)
    return there + weight + back


def alternative_routes(
    roadmap: Roadmap,
    count: int,
    *,
    excess: float = 0.05,
    min_distance: float | None = None,
    sides: Sides | None = None,
) -> tuple[Route, ...]:
    """Routes within ``(1 + excess)`` of the least duration that really differ.

    Args:
        roadmap: with a start and goals; alternatives leave from its first start.
        count: how many at most.
        excess: relative excess of duration over the fastest that is allowed.
        min_distance: least Frechet distance between two routes on the same side [m]; a fiftieth of
            the distance from start to goal if left out.
        sides: tells apart on which side of a peak a route passes.

    Returns:
        The fastest first; none if there is no path.

    Raises:
        ArgumentError: a number out of range.
    """
    fastest = roadmap.fastest()
    if fastest is None:
        return ()
    if min_distance is None:
        ends = fastest.states[[0, -1], :3]
        min_distance = float(np.linalg.norm(ends[1] - ends[0])) / 50.0
    graph = evaluate_within(roadmap, (1.0 + excess) * fastest.duration)
    found = alternatives(
        graph,
        roadmap.states,
        int(fastest.vertices[0]),
        roadmap.goals,
        count=count,
        excess=excess,
        min_distance=min_distance,
        sides=sides,
    )
    return tuple(_route(roadmap, one.way) for one in found)


@dataclass(frozen=True, eq=False)
class Front:
    """The Pareto set of a roadmap, as routes.

    Attributes:
        ways: in the roadmap's graph.
        routes: the same as routes, the fastest first, risks strictly falling.
    """

    ways: ParetoSet
    routes: tuple[Route, ...]

    def least_risk(self, within: float) -> Route:
        """The route of least risk among those of at most so many seconds; see ``ParetoSet``."""
        return self.routes[self.ways.ways.index(self.ways.least_risk(within))]

    def fastest(self, within_risk: float) -> Route:
        """The fastest route among those of at most this risk; see ``ParetoSet``."""
        return self.routes[self.ways.ways.index(self.ways.fastest(within_risk))]


def pareto_routes(roadmap: Roadmap, *, longest: float = math.inf, precision: float = 0.0) -> Front:
    """All routes of a roadmap that no other undercuts in both duration and risk.

    Args:
        roadmap: with starts and goals.
        longest: greatest duration that is of interest [s].
        precision: relative excess of risk that is allowed, 0 for the exact set.

    Raises:
        ArgumentError: a number out of range.
        LabelLimitError: there are too many; see ``pareto_set``.
    """
    fastest, safest = roadmap.fastest(), roadmap.safest()
    if fastest is None or safest is None:
        return Front(ParetoSet(()), ())
    # Longer than a safest path, or riskier than a fastest one, no path of the set can be.
    graph = evaluate_within(roadmap, min(longest, safest.duration), fastest.risk)
    ways = pareto_set(graph, roadmap.starts, roadmap.goals, longest=longest, precision=precision)
    return Front(ways, tuple(_route(roadmap, way) for way in ways))


def _route(roadmap: Roadmap, way: Way) -> Route:
    return roadmap.route(way.vertices, way.duration, way.risk)
