"""Fewer and blunter corners: never more risk, never more time."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import Any

from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk
from ompl_risk.planners.improve.corners import cut_corners, drop_corners, straightened
from ompl_risk.planners.improve.judge import Judge, Recollection, as_path
from ompl_risk.planners.improve.measure import Improvement, Measure, Outcome

ROUNDS = 4


def simplify(
    positions: ArrayLike,
    *,
    clearance: Any,
    risk: Risk,
    obstacles: Any = None,
    rounds: int = ROUNDS,
    threads: int | None = None,
) -> Improvement:
    """Take needless corners out of a path and cut the others, at several scales.

    Every change replaces a piece of the path by a straight motion that may be flown, and neither
    adds to the risk of that piece (by `risk.norm`, whatever it is, infinity included) nor takes
    longer, so neither the norm nor the duration rises (a maximum to 1e-4). Deterministic. The
    result stays within the convex hull of the corners, so within every box that holds them.

    Args:
        positions: corners of a path [m], shape (n, 3).
        clearance: d(q), callable with points (n, 3) [m].
        risk: the norm and the speed; `duration_weight` has no say, since both parts never rise.
        obstacles: a clearance that has to stay positive, such as `Problem.obstacles`; `clearance`
            if left out.
        rounds: how often all corners are cut; 0 only drops corners.
        threads: of compiled code, at most.

    Returns:
        The path and its figures before and after; unchanged if it may not be flown as it is.

    Raises:
        ArgumentError: not a path, not a clearance, or not a whole number of rounds.
    """
    begin = time.monotonic()
    path = as_path(positions)
    if isinstance(rounds, bool) or not isinstance(rounds, int) or rounds < 0:
        raise ArgumentError("rounds", rounds, "a whole number of at least 0")
    judge = Judge(clearance, risk, obstacles, threads=threads)
    before = replace(judge.measure(straightened(path)), vertices=len(path))
    fault = judge.first_fault(path)
    if fault is not None:
        return unchanged(path, before, f"motion {fault} of it is not free", begin, judge)
    return closed(path, simplified(path, judge, rounds), before, begin, judge)


def simplified(
    path: FloatArray, judge: Judge, rounds: int, *, deadline: float = math.inf
) -> FloatArray:
    """The corners that are left of a path that may be flown, or by `deadline` (time.monotonic)."""
    corners = straightened(path)
    if len(corners) < 3:
        return corners
    judge = Recollection(judge)
    corners = _dropped(corners, judge, deadline)
    for _ in range(rounds):
        if time.monotonic() > deadline:
            break
        blunter = cut_corners(corners, judge)
        if len(blunter) == len(corners):
            break
        corners = _dropped(blunter, judge, deadline)
    return corners


def _dropped(corners: FloatArray, judge: Judge, deadline: float) -> FloatArray:
    """Drop corners until nothing is left to drop."""
    while time.monotonic() <= deadline:
        fewer = drop_corners(corners, judge)
        if len(fewer) == len(corners):
            break
        corners = fewer
    return corners


def closed(
    path: FloatArray, corners: FloatArray, before: Measure, begin: float, judge: Judge
) -> Improvement:
    """The result, or the given path if the figures of the new one do not bear it out."""
    after = judge.measure(corners)
    rounding = 1.0 + 1e-12
    worse = after.norm > before.norm * rounding or after.duration > before.duration * rounding
    if worse or judge.first_fault(corners) is not None:
        return unchanged(path, before, "no change was an improvement", begin, judge)
    if len(corners) == len(path) and (corners == path).all():
        return unchanged(path, before, "no change was an improvement", begin, judge)
    corners.setflags(write=False)
    seconds = time.monotonic() - begin
    return Improvement(
        Outcome.IMPROVED, corners, before, after, seconds=seconds, compiled=judge.compiled
    )


def unchanged(
    path: FloatArray, before: Measure, reason: str, begin: float, judge: Judge
) -> Improvement:
    """The given path, and why."""
    seconds = time.monotonic() - begin
    return Improvement(
        Outcome.UNCHANGED, path, before, before, reason, seconds, compiled=judge.compiled
    )
