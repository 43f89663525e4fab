"""Compile what a roadmap needs, before time counts."""

from __future__ import annotations

from ompl_risk.motion.length import LengthBatch
from ompl_risk.planners.roadmap.roadmap import Roadmap


def warm_up(roadmap: Roadmap) -> None:
    """Compile the kernels that a roadmap calls, or load them from numba's cache."""
    region = roadmap.region
    states = region.low + (region.high - region.low) * [[0.1], [0.5], [0.9]]
    if region.posed:
        return
    for motions in (LengthBatch(), roadmap.motions):
        if not motions.compiled:
            continue
        small = Roadmap(region, motions, roadmap.risk, threads=1)
        small.add_starts(states[:1])
        small.add_goals(states[2:])
        small.insert(states[1:2])
        small.search()
    motions = roadmap.motions
    if motions.compiled:
        motions.are_free(states[:1], states[1:2])
        motions.costs(states[:1], states[1:2])
