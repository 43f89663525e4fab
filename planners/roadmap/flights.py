"""Roadmaps of a vehicle with dynamics, without OMPL: flights of equal time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.motion import Risk
from ompl_risk.norms import Norm, Sobolev
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.roadmap.gate import BoxGate, ClearanceGate, all_of
from ompl_risk.planners.roadmap.region import VertexRegion
from ompl_risk.planners.roadmap.roadmap import Roadmap

BATCH = 500
"""Places sampled at a time."""

HEADINGS = 16
"""Headings in which the goal may be reached."""


def flight_roadmap(
    problem: Problem,
    steering: HelicopterSteering | None = None,
    *,
    places: int = 3000,
    norm: Norm | None = None,
    seed: int = 1,
    threads: int | None = None,
    on_batch: Callable[[int], object] = lambda _count: None,
) -> Roadmap:
    """Sample a roadmap of trajectory primitives all over a problem's box.

    The helicopter begins and ends in hover. It begins with its nose towards the goal, and may end
    with any heading.

    Args:
        problem: what is to be planned; its speed has no say, the steering flies its own.
        steering: of the helicopter; the default one if left out.
        places: to sample, each with a vertex for every cruise speed; those in the ground or too
            near to it are left out.
        norm: by which risk is counted, `Lp(p)` or `Sobolev(1)`, which is the default.
        seed: of the samples.
        threads: of compiled code; None uses all processors.
        on_batch: called with the number of places sampled so far.

    Raises:
        ArgumentError: a norm that does not add up along a path, or no places.
    """
    if places < 1:
        raise ArgumentError("places", places, "a whole number of at least 1")
    steering = HelicopterSteering() if steering is None else steering
    norm = Sobolev(1) if norm is None else norm
    risk = Risk(problem.avoidance, norm, speed=steering.speed)
    pure = replace(risk, duration_weight=0.0)
    motions = steering.batch(problem.clearance, pure, threads=threads)
    free = steering.batch(problem.obstacles, Risk(speed=steering.speed), threads=threads)
    region = VertexRegion(problem.low, problem.high, steering, seed=seed)
    gate = all_of([BoxGate(motions, region.low, region.high), ClearanceGate(free)])
    roadmap = Roadmap(region, motions, risk, gate=gate, undirected=False, threads=threads)
    forward = problem.goal - problem.start
    heading = math.atan2(forward[1], forward[0])
    roadmap.add_starts(_hovers(problem.start, np.array([heading])))
    headings = heading + np.linspace(-math.pi, math.pi, HEADINGS, endpoint=False)
    roadmap.add_goals(_hovers(problem.goal, headings))
    for done in range(0, places, BATCH):
        roadmap.grow(min(BATCH, places - done))
        on_batch(min(done + BATCH, places))
    return roadmap


def _hovers(position: FloatArray, headings: FloatArray) -> FloatArray:
    """Vertices that hover at a position, shape (n, 5)."""
    place = np.tile(position, (len(headings), 1))
    return np.column_stack([place, headings, np.zeros(len(headings))])
