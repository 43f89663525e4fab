"""Improving a path of a planning problem."""

from __future__ import annotations

from dataclasses import replace

from numpy.typing import ArrayLike

from ompl_risk.motion import Risk
from ompl_risk.norms import Norm, Sobolev
from ompl_risk.planners.improve.measure import Improvement
from ompl_risk.planners.improve.refine import SECONDS, refine
from ompl_risk.planners.improve.simplify import simplify
from ompl_risk.planners.problem import Problem


def improve_path(
    problem: Problem,
    positions: ArrayLike,
    *,
    norm: Norm | None = None,
    duration_weight: float | None = None,
    longest: float | None = None,
    seconds: float = SECONDS,
) -> Improvement:
    """`refine` a path of a problem, or `simplify` it if there is no risk to lower.

    Args:
        problem: has the clearance, f, the speed, the least clearance and the box.
        positions: corners of a path [m], shape (n, 3).
        norm: `Lp(p)` or `Sobolev(1)`, which is the default.
        duration_weight: cost of a second, see `Risk`.
        longest: greatest duration [s]; that of the given path if left out.
        seconds: computing time [s], about.

    Returns:
        The path and its figures before and after.

    Raises:
        ArgumentError: see `refine`.

    Example:
        >>> import numpy as np
        >>> from ompl_risk import TerrainClearance
        >>> from ompl_risk.planners import low_level_flight
        >>> from ompl_risk.terrains import Terrain
        >>> flat = TerrainClearance(Terrain(np.zeros((9, 9)), spacing=(100.0, 100.0)))
        >>> problem = low_level_flight(flat, (100.0, 400.0), (700.0, 400.0), speed=20.0)
        >>> path = [problem.start, [400.0, 480.0, 60.0], problem.goal]
        >>> improve_path(problem, path).improved
        True
    """
    risk = Risk(
        problem.avoidance,
        Sobolev(1) if norm is None else norm,
        speed=problem.speed,
        duration_weight=duration_weight,
    )
    refined = refine(
        positions,
        clearance=problem.clearance,
        risk=risk,
        obstacles=problem.obstacles,
        low=problem.low,
        high=problem.high,
        longest=longest,
        seconds=seconds,
    )
    if refined.improved:
        return refined
    simpler = simplify(
        positions, clearance=problem.clearance, risk=risk, obstacles=problem.obstacles
    )
    return replace(simpler, seconds=refined.seconds + simpler.seconds)
