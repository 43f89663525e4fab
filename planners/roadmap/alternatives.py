"""Paths of nearly the same duration that really differ."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray, as_floats, positive, readonly, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.roadmap.corridor import Corridor
from ompl_risk.planners.roadmap.detour import DetourTest
from ompl_risk.planners.roadmap.difference import Sampling, differing
from ompl_risk.planners.roadmap.graph import Graph, Way
from ompl_risk.planners.roadmap.mixes import ladder
from ompl_risk.planners.roadmap.via import Pool, via_paths
from ompl_risk.planners.sides import Sides


@dataclass(frozen=True, eq=False)
class Alternative:
    """One of several paths of nearly the same duration.

    Attributes:
        way: the path.
        side: on which side it passes each peak, see ``Sides``; () if sides are not told apart.
    """

    way: Way
    side: Hashable


def alternatives(
    graph: Graph,
    states: ArrayLike,
    start: int,
    goals: ArrayLike,
    *,
    count: int,
    excess: float = 0.05,
    min_distance: float,
    sides: Sides | None = None,
    mixes: ArrayLike | None = None,
    stretch: float = 0.25,
) -> tuple[Alternative, ...]:
    """Paths within ``(1 + excess)`` of the least duration in the graph, pairwise different.

    Candidates are the paths by way of every vertex: the best from the start to it and the best from
    there to a goal, "best" by duration alone, and by several mixes of duration and risk, so that
    safe paths of nearly the least duration are among them. Two paths differ if they pass on
    different sides, or if the Frechet distance of their curves is at least `min_distance`. Of paths
    that do not differ, the fastest of all or else the safest stands for the others. The fastest
    comes first, the safest second, then one for each other side, then the farthest from all before.

    Every path returned is within the limit, passes no vertex twice and no goal before its end,
    makes no detour (see `stretch`), and differs from all the others. Not every path with these
    properties is by way of a vertex, so there may be more than are found. Same arguments, same
    result.

    Args:
        graph: the graph.
        states: of its vertices, x, y and z first [m], shape (n, k); motions are straight.
        start: vertex.
        goals: vertex or vertices, any of which will do.
        count: how many paths at most, 1 or more.
        excess: relative excess of duration over the fastest that is allowed.
        min_distance: least Frechet distance between two paths of one side [m].
        sides: tells sides apart; None for none.
        mixes: weights of the risk to look for paths by [s per unit of risk], 0 is added; for a
            maximum norm the greatest risks that edges may have, inf is added. By default from the
            graph's own trade of duration for risk, see ``ladder``.
        stretch: how much worse than the best a stretch of 2 `min_distance` to either side of the
            vertex may be, relative; inf to allow any detour.

    Returns:
        The paths in the order of choice; none if there is no path to any goal.

    Raises:
        ArgumentError: an argument out of range.

    Reference:
        Abraham, Delling, Goldberg & Werneck, Alternative routes in road networks,
        ACM Journal of Experimental Algorithmics 18, 2013.

    Example:
        >>> ends = [(0, 1), (1, 3), (0, 2), (2, 3)]
        >>> square = Graph.of_edges(4, ends, risk=[0.1, 0.1, 0.2, 0.2], duration=[1.0] * 4)
        >>> corners = [(0, 0), (0, 9), (9, 0), (9, 9)]
        >>> [a.way.vertices.tolist() for a in alternatives(
        ...     square, corners, 0, 3, count=5, min_distance=5.0)]
        [[0, 1, 3], [0, 2, 3]]
    """
    points = readonly("states", states, (graph.n, None), f"({graph.n}, k), one for each vertex")
    points = np.ascontiguousarray(points[:, :3])
    begin = int(_vertices("start", start, graph.n)[0])
    ends = _vertices("goals", goals, graph.n)
    _check_numbers(count, excess, stretch)
    positive("min_distance", min_distance)
    given = None if mixes is None else _mixes(mixes, graph.maximum)
    corridor = Corridor.between(graph, begin, ends, excess)
    if corridor is None:
        return ()
    rungs = ladder(corridor) if given is None else given
    pool = via_paths(corridor, rungs)
    words = [()] * len(pool) if sides is None else sides.words(points[pool.vertices], pool.first)
    arc = _arc(points, pool)
    longest = float((arc[pool.first[1:] - 1] - arc[pool.first[:-1]]).max())
    sampling = Sampling.of(longest, min_distance)
    span = 2.0 * min_distance
    is_detour = DetourTest(corridor, pool, rungs, arc, span=span, stretch=stretch)
    chosen = differing(pool, points, words, is_detour, sampling, count)
    return tuple(Alternative(pool.way(graph, k), words[k]) for k in chosen)


def _arc(points: FloatArray, pool: Pool) -> FloatArray:
    """Length travelled at each of the pool's vertices, running on from path to path [m]."""
    steps = np.linalg.norm(np.diff(points[pool.vertices], axis=0), axis=1)
    return np.append(0.0, np.cumsum(steps))


def _vertices(argument: str, given: ArrayLike, n: int) -> NDArray[np.int32]:
    """Vertices in range, at least one."""
    allowed = f"vertices from 0 to {n - 1}, at least one"
    found = np.atleast_1d(np.asarray(given))
    whole = found.ndim == 1 and np.issubdtype(found.dtype, np.integer)
    if not (whole and len(found) and found.min() >= 0 and found.max() < n):
        raise ArgumentError(argument, given, allowed)
    return found.astype(np.int32)


def _check_numbers(count: int, excess: float, stretch: float) -> None:
    if not isinstance(count, int | np.integer) or isinstance(count, bool) or count < 1:
        raise ArgumentError("count", count, "a whole number of at least 1")
    if not 0.0 <= real_number("excess", excess, "0 or more, and finite") < math.inf:
        raise ArgumentError("excess", excess, "0 or more, and finite")
    if not real_number("stretch", stretch, "0 or more") >= 0.0:
        raise ArgumentError("stretch", stretch, "0 or more")


def _mixes(given: ArrayLike, maximum: bool) -> FloatArray:
    """The mixes given and the one that heeds duration alone, that one first, each once."""
    allowed = "0 or more, shape (k,)" if maximum else "0 or more and finite, shape (k,)"
    mixes = as_floats("mixes", given)
    fits = mixes.ndim == 1 and (mixes >= 0.0).all() and (maximum or np.isfinite(mixes).all())
    if not fits:
        raise ArgumentError("mixes", given, allowed)
    return (
        np.unique(np.append(mixes, np.inf))[::-1] if maximum else np.unique(np.append(mixes, 0.0))
    )
