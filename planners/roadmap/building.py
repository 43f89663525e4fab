"""A roadmap for a planning problem, without OMPL."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ompl_risk.motion import Risk, motion_batch
from ompl_risk.norms import Norm, Sobolev
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.roadmap.gate import ClearanceGate
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.roadmap.roadmap import Roadmap
from ompl_risk.planners.sides import Sides

BATCH = 2000
"""States sampled at a time."""


def roadmap_of(
    problem: Problem,
    *,
    samples: int,
    norm: Norm | None = None,
    seed: int = 1,
    threads: int | None = None,
    on_batch: Callable[[int], object] = lambda _count: None,
) -> Roadmap:
    """Sample a roadmap all over a problem's box, to look for many paths in.

    Args:
        problem: what is to be planned.
        samples: states to sample; those in the ground or too near to it are left out.
        norm: by which risk is counted, `Lp(p)` or `Sobolev(1)`, which is the default.
        seed: of the samples.
        threads: of compiled code; None uses all processors.
        on_batch: called with the number of states sampled so far.

    Raises:
        ArgumentError: a norm that does not add up along a path.
    """
    risk = Risk(problem.avoidance, Sobolev(1) if norm is None else norm, speed=problem.speed)
    pure = motion_batch(problem.clearance, replace(risk, duration_weight=0.0), threads=threads)
    free = motion_batch(problem.obstacles, Risk(speed=1.0), threads=threads)
    region = Region(problem.low, problem.high, seed=seed)
    roadmap = Roadmap(region, pure, risk, gate=ClearanceGate(free), threads=threads)
    roadmap.add_starts(np.array([problem.start]))
    roadmap.add_goals(np.array([problem.goal]))
    for done in range(0, samples, BATCH):
        roadmap.grow(min(BATCH, samples - done))
        on_batch(min(done + BATCH, samples))
    return roadmap


def sides_of(problem: Problem) -> Sides | None:
    """The peaks that no path of a problem over terrain can cross; None without terrain."""
    terrain = getattr(problem.clearance, "terrain", None)
    if terrain is None:
        return None
    return Sides.of_terrain(
        terrain,
        problem.low,
        problem.high,
        radius=problem.clearance.radius,
        min_clearance=problem.min_clearance,
    )
