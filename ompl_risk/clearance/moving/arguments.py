"""Checks of what a moving clearance is given."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import real_number
from ompl_risk.clearance.base import as_length, as_queries
from ompl_risk.clearance.moving.obstacles import MovingObstacle
from ompl_risk.clearance.moving.search import TimedMotions
from ompl_risk.clearance.moving.static_part import radii
from ompl_risk.clearance.moving.tracks import as_times
from ompl_risk.errors import ArgumentError

TIMELESS = (
    "given: these obstacles move, so there is no distance without a time. rank() and "
    "collision_probability() take it from the trajectory; what stands still beside them is passed "
    "as static=, not in a UnionClearance; elsewhere pass clearance.at(t), the obstacles as they "
    "stand at t seconds"
)
"""What is allowed where no time is known."""


def as_obstacles(obstacles: Any) -> tuple[MovingObstacle, ...]:
    """One obstacle or several.

    Raises:
        ArgumentError: none, or something else.
    """
    given = (obstacles,) if isinstance(obstacles, MovingObstacle) else obstacles
    if not isinstance(given, Sequence) or not len(given):
        raise ArgumentError("obstacles", obstacles, "at least one MovingObstacle")
    for k, each in enumerate(given):
        if not isinstance(each, MovingObstacle):
            allowed = "a MovingSphere, MovingBox or MovingMesh"
            raise ArgumentError(f"obstacles[{k}]", each, allowed)
    return tuple(given)


def as_wait(t0: float, t1: float) -> tuple[float, float]:
    """When a wait begins and ends [s]; it may never end.

    Raises:
        ArgumentError: a beginning that is not finite, or an end that is not after it.
    """
    begin = real_number("t0", t0, "a finite time [s]")
    end = real_number("t1", t1, "a time after t0 [s]")
    if not math.isfinite(begin):
        raise ArgumentError("t0", t0, "a finite time [s]")
    if not end > begin:
        raise ArgumentError("t1", t1, f"after t0, {begin!s} s")
    return begin, end


def common_radius(static: Any, radius: float | None) -> float:
    """The radius [m] that what moves and what stands still are for.

    Raises:
        ArgumentError: they are for different ones.
    """
    known = set() if static is None else radii(static)
    if radius is None and len(known) <= 1:
        return next(iter(known), 0.0)
    chosen = 0.0 if radius is None else as_length(radius, "radius")
    if known - {chosen}:
        allowed = f"that of static: {', '.join(f'{each:g}' for each in sorted(known))} m"
        raise ArgumentError("radius", radius, allowed)
    return chosen


def as_motions(a: ArrayLike, ta: ArrayLike, b: ArrayLike, tb: ArrayLike) -> TimedMotions:
    """Motions that begin and end at given places and times.

    Raises:
        ArgumentError: a wrong shape, a number that is not finite, or a motion that takes no time.
    """
    begin, end = as_queries(a, 3, name="a"), as_queries(b, 3, name="b")
    if len(end) != len(begin):
        raise ArgumentError("b.shape", end.shape, f"{begin.shape}, as a")
    motions = TimedMotions(
        begin, as_times("ta", ta, len(begin)), end, as_times("tb", tb, len(begin))
    )
    moved = (begin != end).any(axis=1)
    wrong = np.flatnonzero((motions.tb < motions.ta) | (moved & (motions.tb == motions.ta)))
    if len(wrong):
        i = int(wrong[0])
        allowed = f"after ta[{i}], {motions.ta[i]!s} s: the motion takes time"
        raise ArgumentError(f"tb[{i}]", float(motions.tb[i]), allowed)
    return motions
