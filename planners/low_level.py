"""Low-level flight over terrain as a planning problem."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk.avoidance import Avoidance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.base import as_length
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.problem import Problem
from ompl_risk.terrains import Terrain

HEADROOM = 320.0
"""Height of the usual ceiling above the higher one of start and goal [m]."""


def low_level_flight(
    clearance: TerrainClearance,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    start_height: float = 60.0,
    goal_height: float = 60.0,
    ceiling: float | None = None,
    margin: float = 0.15,
    min_clearance: float = 20.0,
    speed: float = 30.0,
    avoidance: Avoidance | None = None,
) -> Problem:
    """A flight between two places that has to stay below a ceiling.

    Without a ceiling there is no dilemma: whoever climbs d0 above all summits flies without risk.

    Args:
        clearance: the terrain and the vehicle's sphere.
        start: x, y [m] of the start.
        goal: x, y [m] of the goal.
        start_height: height of the start above the ground [m].
        goal_height: height of the goal above the ground [m].
        ceiling: altitude [m] that no path exceeds; `HEADROOM` above the higher of start and goal,
            rounded up to a metre, if left out.
        margin: how far paths may leave the rectangle of start and goal, in distances between them.
        min_clearance: least distance to the ground, from the sphere [m].
        speed: constant speed [m/s].
        avoidance: the avoidance function; ``InverseDistance()`` if left out.

    Raises:
        ArgumentError: start or goal outside the terrain, below or too near to the ground, or above
            the ceiling (each with the height of the ground there), or another number out of range.
    """
    terrain = clearance.terrain
    if not 0.0 <= margin < math.inf:
        raise ArgumentError("margin", margin, "a finite number of at least 0")
    ends = {
        "start": _above_ground("start", terrain, start, start_height),
        "goal": _above_ground("goal", terrain, goal, goal_height),
    }
    top = max(end[2] for end in ends.values())
    ceiling = float(math.ceil(top + HEADROOM)) if ceiling is None else positive("ceiling", ceiling)
    as_length(min_clearance, "min_clearance")
    for name, end in ends.items():
        _check_end(name, end, clearance, ceiling, min_clearance)
    if (ends["start"][:2] == ends["goal"][:2]).all():  # the box would have no width
        raise ArgumentError("goal", ends["goal"][:2].tolist(), "another place than start")
    xmin, xmax, ymin, ymax = terrain.extent
    both = np.array(list(ends.values()))
    aside = margin * float(np.linalg.norm(both[1, :2] - both[0, :2]))
    low = np.maximum(both.min(axis=0) - aside, [xmin, ymin, -np.inf])
    high = np.minimum(both.max(axis=0) + aside, [xmax, ymax, np.inf])
    low[2], high[2] = terrain.heights.min(), ceiling
    return Problem(
        clearance,
        both[0],
        both[1],
        low,
        high,
        speed=speed,
        avoidance=avoidance,
        min_clearance=min_clearance,
    )


def _above_ground(argument: str, terrain: Terrain, place: ArrayLike, height: float) -> FloatArray:
    x, y = readonly(argument, place, (2,), "(2,): x, y").tolist()
    xmin, xmax, ymin, ymax = terrain.extent
    if not (xmin <= x <= xmax and ymin <= y <= ymax):
        within = f"within the terrain: x {xmin:.7g} to {xmax:.7g} m, y {ymin:.7g} to {ymax:.7g} m"
        raise ArgumentError(argument, (x, y), within)
    return np.array([x, y, terrain.height(x, y) + positive(f"{argument}_height", height)])


def _check_end(
    name: str, end: FloatArray, clearance: TerrainClearance, ceiling: float, least: float
) -> None:
    x, y, z = end.tolist()
    ground = clearance.terrain.height(x, y)
    place = f"the ground at ({x:g}, {y:g}) m is at {ground:.1f} m"
    if z > ceiling:
        allowed = f"at least {z:.1f} m, the altitude of the {name}; {place}"
        raise ArgumentError("ceiling", ceiling, allowed)
    d = float(clearance(end[None, :])[0])
    if d <= least:
        state = "in collision" if d <= 0.0 else "too near to the ground"
        raise ArgumentError(
            f"{name}_height",
            z - ground,
            f"greater: {place}, and at {z:.1f} m the clearance is {d:.1f} m, {state} "
            f"(more than min_clearance = {least:g} m is needed)",
        )
