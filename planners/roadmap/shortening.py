"""Leave out vertices of a route: sampling makes it turn more often than it has to."""

from __future__ import annotations

import math

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.pareto import pareto_set
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route

REACH = 12
"""Vertices that a single motion may replace, with the one that it ends at."""

PRECISION = 1e-3
"""Relative accuracy of the risk that is compared."""


def shortened(route: Route, roadmap: Roadmap) -> Route:
    """The fastest route over some of the vertices of a route, in their order, of no more risk.

    All motions between vertices up to ``REACH`` apart are evaluated: few, and the roadmap has only
    those between neighbours.

    Args:
        route: of the roadmap.
        roadmap: with any motions.

    Returns:
        A route that takes no longer and has no more risk; the same one if there is none better.
    """
    k = len(route.vertices)
    first, last = np.triu_indices(k, 1)
    near = last - first <= REACH
    first, last = first[near], last[near]
    states = roadmap.states[route.vertices]
    durations, risks = _evaluated(roadmap, states[first], states[last])
    there = np.isfinite(risks)
    ends = np.column_stack([first, last])[there]
    graph = Graph.of_edges(
        k, ends, risks[there], durations[there], maximum=roadmap.maximum, undirected=False
    )
    found = pareto_set(
        graph, 0, k - 1, longest=route.duration, riskiest=route.risk, precision=PRECISION
    )
    if not found:  # rounding: the route itself is one of these ways
        return route
    way = found.ways[0]
    return roadmap.route(route.vertices[way.vertices], way.duration, way.risk)


def _evaluated(roadmap: Roadmap, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Durations and risks of motions, inf where there is none that may be flown."""
    durations, risks = roadmap.motions.durations(a, b), np.full(len(a), math.inf)
    flyable = np.flatnonzero(np.isfinite(durations))
    flyable = flyable[roadmap.gate.allows_motions(a[flyable], b[flyable])]
    risks[flyable] = roadmap.motions.costs(a[flyable], b[flyable])
    return durations, risks
