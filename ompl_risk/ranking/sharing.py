"""Shares trajectories out to threads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from ompl_risk.clearance import TerrainClearance
from ompl_risk.ranking.sampling import Clearance

Item = TypeVar("Item")
Result = TypeVar("Result")


def shared_out(clearance: Clearance, parts: Iterable[object], count: int) -> tuple[Clearance, int]:
    """The clearance to assess trajectories with, and how many of them at a time.

    A thread takes a whole trajectory, rather than a part of the points of one, which keeps it busy
    with what is not distances too. Only where nobody else's code runs, which need not bear several
    calls at a time, and where there are trajectories enough.

    Args:
        clearance: as the user gave it.
        parts: the avoidance function and the norms.
        count: number of trajectories.
    """
    ours = all(type(part).__module__.startswith("ompl_risk.") for part in parts)
    if not ours or not isinstance(clearance, TerrainClearance):
        return clearance, 1
    if type(clearance) is not TerrainClearance or count < 2 * clearance.threads:
        return clearance, 1
    single = clearance.with_radius(clearance.radius)
    single.threads = 1
    return single, clearance.threads


def each(work: Callable[[Item], Result], items: Sequence[Item], threads: int) -> tuple[Result, ...]:
    """The result of each item, in their order; the first error in that order, if any."""
    if threads == 1:
        return tuple(map(work, items))
    with ThreadPoolExecutor(threads) as pool:
        return tuple(pool.map(work, items))
