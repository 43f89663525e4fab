"""Which of many paths to keep so that all of them differ."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import alternatives as kernels
from ompl_risk._kernels.curves import Gates
from ompl_risk.planners.roadmap.detour import DetourTest
from ompl_risk.planners.roadmap.via import Pool

STEPS = 16
"""Steps of a curve, at least, on the least distance that two curves may have."""

COARSE, FINEST = 128, 16
"""Steps of a whole curve when only the order of choice is at stake, and times finer at most."""

ROOM = 20
"""Different paths that are gathered for each that is asked for, before the choice among them."""

GATES = 32
"""Planes across the way at which curves are compared first."""


@dataclass(frozen=True, eq=False)
class Sampling:
    """How finely paths are compared as curves.

    Two curves sampled at equal arc lengths, at most h apart, have a discrete Frechet distance of at
    most h above that of the curves themselves: so ``min_distance + h`` asks for enough.

    Attributes:
        coarse: every so many samples one for the order of choice.
        samples: of a curve.
        threshold: discrete Frechet distance from which curves count as different [m].
        step: greatest distance of neighbouring samples, h [m].
    """

    coarse: int
    samples: int
    threshold: float
    step: float

    @classmethod
    def of(cls, longest: float, min_distance: float) -> Sampling:
        """For paths up to some length [m]."""
        wanted = math.ceil(longest / min_distance * STEPS / COARSE)
        coarse = min(max(wanted, 1), FINEST)
        pieces = coarse * COARSE
        step = longest / pieces
        return cls(coarse, pieces + 1, min_distance + step, step)


def differing(
    pool: Pool,
    points: FloatArray,
    sides: Sequence[Hashable],
    is_detour: DetourTest,
    sampling: Sampling,
    count: int,
) -> list[int]:
    """Choose paths that differ from each other: in their side, or by their Frechet distance.

    First a net is laid: the fastest path, the safest and the fastest one of every side, then all
    others from the safest on, each kept if it differs from all kept before and makes no detour. So
    what is left out is like one of the fastest, or like something kept that is safer.

    Of the net are chosen the fastest, the safest, and then again and again a path of a side not
    chosen yet, or else any: the farthest from all chosen, to the accuracy of coarse samples.

    Args:
        pool: the paths, at least one.
        points: positions of the vertices [m], shape (n, k).
        sides: of the paths.
        is_detour: test for those not to keep.
        sampling: how to compare.
        count: how many to choose at most.

    Returns:
        Their numbers in the order of choice.

    Reference:
        Gonzalez, Clustering to minimize the maximum intercluster distance,
        Theoretical Computer Science 38, 1985.
    """
    side = _numbered(sides)
    room = 1 if count == 1 else min(ROOM * count, len(pool))
    kept = _empty(room + 1, sampling.samples, points.shape[1])  # and one being looked at
    net = _net(pool, points, side, kept, is_detour, sampling)
    first = np.array(list(dict.fromkeys([0, int(pool.risk[net].argmin())])))[:count]
    chosen = np.empty(min(count, len(net)), np.int64)
    curves = np.ascontiguousarray(kept.curves[: len(net), :: sampling.coarse])
    kernels.farthest_first(curves, kept.side[: len(net)], first, chosen)
    return [net[k] for k in chosen]


def _net(
    pool: Pool,
    points: FloatArray,
    side: NDArray[np.int32],
    kept: kernels.Kept,
    is_detour: DetourTest,
    sampling: Sampling,
) -> list[int]:
    """Paths that differ from each other; ``kept`` is filled with as many."""
    order = _order(pool, side)
    paths = kernels.Paths(pool.first, pool.vertices, side)
    gates = _gates(points, pool, sampling.threshold + sampling.step)
    bound = sampling.threshold**2
    net: list[int] = []
    place = 0
    while len(net) < len(kept.side) - 1:
        n = len(net)
        place = kernels.next_different(points, paths, order, place, kept, n, gates, bound)
        if place == len(order):
            break
        path, place = int(order[place]), place + 1
        if n == 0 or not is_detour(path):
            kernels.keep(n, side[path], kept, gates, bound)
            net.append(path)
    return net


def _numbered(sides: Sequence[Hashable]) -> NDArray[np.int32]:
    """A number for each side, in the order in which they appear."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(side, len(numbers)) for side in sides], dtype=np.int32)


def _order(pool: Pool, side: NDArray[np.int32]) -> NDArray[np.int64]:
    """The fastest, the safest and the fastest of each side, all the others from the safest on.

    The fastest of a side makes no detour, so no side is lost among the many paths of another one.
    """
    by_time, by_risk = (
        np.lexsort((pool.risk, pool.duration)),
        np.lexsort((pool.duration, pool.risk)),
    )
    leaders = [by_time[:1]]
    for order in (by_risk, by_time):
        _, first = np.unique(side[order], return_index=True)
        leaders.append(order[np.sort(first)])
    whole = np.concatenate([*leaders, by_risk])
    _, places = np.unique(whole, return_index=True)
    return whole[np.sort(places)]


def _empty(room: int, samples: int, k: int) -> kernels.Kept:
    low, high = np.empty((2, room, GATES, k))
    side, recent = np.empty((2, room), np.int32)
    return kernels.Kept(np.empty((room, samples, k)), low, high, side, recent)


def _gates(points: FloatArray, pool: Pool, depth: float) -> Gates:
    """Planes at right angles to the straight way from the start to the goal of the first path."""
    a, b = points[pool.vertices[0]], points[pool.vertices[pool.first[1] - 1]]
    length = float(np.linalg.norm(b - a))
    across = (b - a) / length if length > 0.0 else np.eye(len(a))[0]
    levels = float(a @ across) + length * (np.arange(GATES) + 0.5) / GATES
    return Gates(across, levels, depth)
