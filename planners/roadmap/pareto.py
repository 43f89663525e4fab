"""All paths of a graph that no other path undercuts in both duration and risk."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import real_number
from ompl_risk._kernels import pareto as kernels
from ompl_risk._kernels.potentials import UNREACHED, least_to_goal, reduced_rows
from ompl_risk.errors import ArgumentError, LabelLimitError
from ompl_risk.planners.roadmap.front import ParetoSet
from ompl_risk.planners.roadmap.graph import Graph, Tree, Way
from ompl_risk.planners.roadmap.ticks import Ticks, in_ranks, in_ticks

MOST_LABELS = 10_000_000
"""Labels that a search may settle unless told otherwise: 320 MB, up to 480 MB as they grow."""

_LABELS = "a whole number from 1 to 2**31 - 1"


def pareto_set(
    graph: Graph,
    start: ArrayLike,
    goals: ArrayLike,
    *,
    longest: float = math.inf,
    riskiest: float = math.inf,
    precision: float = 0.0,
    most_labels: int = MOST_LABELS,
) -> ParetoSet:
    """The paths to a goal that are not undercut: none is faster and no riskier, nor the reverse.

    For every path P from a start to a goal within the limits, the set has a way W with

        duration(W) <= duration(P)  and  risk(W) <= (1 + precision) risk(P)

    and no two ways of the same duration or risk. Without precision these are all non-dominated
    pairs, one way for each. With it, if risks add, the set is a part of that exact one.

    Why the promise holds: follow P from its start. A label of the search that is no worse than P so
    far is extended along P, or dropped for one of two reasons. Either another one at the same
    vertex is no worse: go on with that. Or a way W found before has at most (1 + precision) times
    the least risk of any completion, hence at most (1 + precision) risk(P), and ways are found in
    the order of duration, so W is no slower than P. The factor enters once, whatever the number of
    edges. For a maximum norm risks are first rounded down to powers of (1 + precision), and the
    search is exact in these.

    Sums are compared in whole ticks, so that the order of summation does not matter and equal stays
    equal. A tick of duration is at most 2^-59 of the duration of a path of least risk, one of risk
    at most 2^-59 of the risk of a fastest path (or of the limits); every edge is rounded up to
    the next. All this holds up to that and to the rounding of the sums in `Way`. Greatest
    risks are not rounded.

    Memory: 32 bytes a label, and 52 bytes a half-edge of the graph.

    Args:
        graph: with risks that add, or of which the greatest counts.
        start: vertex or vertices to start from.
        goals: vertex or vertices to reach; paths end at the first.
        longest: greatest duration [s].
        riskiest: greatest risk, in the unit of the graph's: p-th power of the norm.
        precision: relative excess of risk that is allowed, 0 for the exact set.
        most_labels: greatest number of labels to settle, 32 bytes each.

    Raises:
        ArgumentError: vertices out of range, no vertex, a number out of range.
        LabelLimitError: most_labels do not suffice.

    Reference:
        Ulloa, Yeoh, Baier, Zhang, Suazo, Koenig: A simple and fast bi-objective search algorithm,
        ICAPS 2020. Sedeño-Noda, Colebrook: A biobjective Dijkstra algorithm, EJOR 276 (2019).
    """
    starts, ends = _vertices("start", start, graph.n), _vertices("goals", goals, graph.n)
    longest, riskiest = _at_least_0("longest", longest), _at_least_0("riskiest", riskiest)
    precision = _at_least_0("precision", precision)
    if math.isinf(precision):
        raise ArgumentError("precision", precision, "finite")
    most = real_number("most_labels", most_labels, _LABELS)
    if not (most.is_integer() and 1 <= most < 2**31):
        raise ArgumentError("most_labels", most_labels, _LABELS)
    problem = _problem(graph, starts, ends, longest, riskiest, precision)
    found = () if problem is None else _within(problem, longest, riskiest, precision, int(most))
    return ParetoSet(_undercut_removed(found), longest, riskiest, precision)


@dataclass(frozen=True, eq=False)
class _Problem:
    """The graph in whole numbers.

    Attributes:
        graph: as given.
        starts: those from which a goal can be reached.
        is_goal: shape (n,).
        duration: of the edges [tick], shape (m,).
        risk: of the edges [another tick, or rank], shape (m,).
        limits: greatest duration and risk of a path, likewise.
        to_goal: least duration and risk from the vertices to a goal, shape (n, 2).
        second: the tick of duration [s].
    """

    graph: Graph
    starts: NDArray[np.int32]
    is_goal: NDArray[np.bool_]
    duration: Ticks
    risk: Ticks
    limits: Ticks
    to_goal: Ticks
    second: float

    def solve(self, precision: float, most: int) -> tuple[tuple[Way, ...], Ticks]:
        """Ways, and their totals in ticks, shape (k, 2)."""
        g = self.graph
        weights = (self.duration, self.risk, self.to_goal, self.limits)
        out = reduced_rows(g.first, g.target, g.edge, *weights, False, g.maximum)
        r = g.reverse
        into = reduced_rows(r.first, r.target, r.edge, *weights, True, g.maximum)
        precision = 0.0 if g.maximum else precision  # there, ranks stand for rounded risks
        near = (self.to_goal[self.starts] <= self.limits).all(axis=1)
        labels, count, found, complete = kernels.pareto_labels(
            out, into, self.starts[near], self.is_goal, self.to_goal, self.limits,
            precision, g.maximum, most,
        )  # fmt: skip
        if not complete:
            reached = float(labels.least[count - 1, 0]) * self.second
            fastest = float(self.to_goal[self.starts, 0].min()) * self.second
            raise LabelLimitError(most, fastest, reached)
        ways = tuple(_way(g, *kernels.trace_back(labels.trace, label)) for label in found)
        return ways, labels.least[found]


def _problem(
    graph: Graph,
    starts: NDArray[np.int32],
    goals: NDArray[np.int32],
    longest: float,
    riskiest: float,
    precision: float,
) -> _Problem | None:
    """The search in whole numbers, or None if no path is within the limits."""
    flyable = np.isfinite(graph.duration) & (graph.risk <= min(riskiest, np.finfo(float).max))
    duration = np.where(flyable, graph.duration, math.inf)
    risk = np.where(flyable, graph.risk, math.inf)
    # No path that counts is slower than one of least risk, nor riskier than a fastest one.
    fastest = _edges(graph.reverse.tree(goals, duration), starts, graph)
    safest = _edges(graph.reverse.tree(goals, risk, maximum=graph.maximum), starts, graph)
    if fastest is None or safest is None:
        return None
    duration, slowest, second = in_ticks(duration, safest, longest)
    if graph.maximum:
        risk, most_risk = in_ranks(risk, fastest, precision)
    else:
        risk, most_risk, _ = in_ticks(risk, fastest, riskiest)
    r = graph.reverse
    rows = (r.first, r.target, r.edge)
    to_goal = np.column_stack(
        [
            least_to_goal(*rows, duration, goals, slowest, False),
            least_to_goal(*rows, risk, goals, most_risk, graph.maximum),
        ]
    )
    starts = starts[(to_goal[starts] < UNREACHED).all(axis=1)]
    if not len(starts):
        return None
    is_goal = np.zeros(graph.n, np.bool_)
    is_goal[goals] = True
    limits = np.array([slowest, most_risk])
    return _Problem(graph, starts, is_goal, duration, risk, limits, to_goal, second)


def _within(
    problem: _Problem, longest: float, riskiest: float, precision: float, most: int
) -> tuple[Way, ...]:
    """The ways of a problem, all within the limits.

    A sum may be within a limit in ticks, and beyond it in double precision. Others may be missing
    for the sake of such a way, so it is excluded and the search repeated. That also excludes ways
    that take no fewer ticks but are within the limit, so those that were found before are kept.
    """
    found: list[Way] = []
    while True:
        ways, totals = problem.solve(precision, most)
        beyond = np.array([(w.duration > longest, w.risk > riskiest) for w in ways]).reshape(-1, 2)
        found += [way for way, out in zip(ways, beyond.tolist(), strict=True) if not any(out)]
        if not beyond.any():
            return tuple(found)
        excluding = np.where(beyond, totals - 1, problem.limits).min(axis=0)
        problem = replace(problem, limits=excluding)


def _edges(tree: Tree, starts: NDArray[np.int32], graph: Graph) -> NDArray[np.int32] | None:
    """Edges of a best path from a start to a goal, None if there is none."""
    best = starts[np.argmin(tree.distance[starts])]
    if not math.isfinite(tree.distance[best]):
        return None
    return graph.reverse.edge[tree.half_edges(best)]


def _way(graph: Graph, vertices: NDArray[np.int32], edges: NDArray[np.int32]) -> Way:
    risk = graph.risk[edges]
    total = risk.max(initial=0.0) if graph.maximum else risk.sum()
    return Way(vertices, edges, float(graph.duration[edges].sum()), float(total))


def _undercut_removed(ways: tuple[Way, ...]) -> tuple[Way, ...]:
    """Those that the rounding of their sums leaves non-dominated."""
    kept: list[Way] = []
    for way in sorted(ways, key=lambda w: (w.duration, w.risk)):
        if not kept or way.risk < kept[-1].risk:
            kept.append(way)
    return tuple(kept)


def _vertices(argument: str, value: ArrayLike, n: int) -> NDArray[np.int32]:
    given = np.atleast_1d(np.asarray(value))
    if given.ndim != 1 or not len(given) or not np.issubdtype(given.dtype, np.integer):
        raise ArgumentError(argument, value, "a vertex, or at least one")
    outside = given[(given < 0) | (given >= n)]
    if len(outside):
        raise ArgumentError(argument, int(outside[0]), f"vertices from 0 to {n - 1}")
    return np.unique(given).astype(np.int32)


def _at_least_0(argument: str, value: float) -> float:
    number = real_number(argument, value, "0 or more")
    if number < 0.0:
        raise ArgumentError(argument, value, "0 or more")
    return number
