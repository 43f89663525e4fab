"""Compile what a roadmap needs, before time counts."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.motion.kinodynamic import KinodynamicSteering
from ompl_risk.norms import Lp, Norm
from ompl_risk.planners.improve import refine
from ompl_risk.planners.roadmap.gate import ClearanceGate
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.roadmap.roadmap import Roadmap
from ompl_risk.terrains import Terrain

PLACES = 8
"""Places between which a vehicle is flown."""

FIELD = np.zeros(3), np.array([3000.0, 3000.0, 60.0])
"""Least and greatest coordinates of these: far enough apart for any turn [m]."""


@cache
def warm_up(norm: Norm | None = None) -> None:
    """Compile the kernels that planning by a norm calls, or load them from numba's cache.

    A small roadmap over a ridge is grown, searched, and its path refined: seconds where nothing has
    been compiled before, else some milliseconds.
    """
    ridge = np.zeros((9, 9))
    ridge[4] = 20.0
    clearance = TerrainClearance(Terrain(ridge, spacing=(10.0, 10.0)), threads=1)
    risk = Risk(InverseDistance(30.0), Lp(1) if norm is None else norm, speed=10.0)
    motions = motion_batch(clearance, replace(risk, duration_weight=0.0), threads=1)
    gate = ClearanceGate(motion_batch(clearance.with_radius(1.0), Risk(speed=1.0), threads=1))
    low, high = [0.0, 0.0, 0.0], [80.0, 80.0, 60.0]
    roadmap = Roadmap(Region(low, high), motions, risk, gate=gate, threads=1)
    roadmap.add_starts(np.array([[10.0, 10.0, 15.0]]))
    roadmap.add_goals(np.array([[70.0, 70.0, 15.0]]))
    roadmap.grow(100)
    roadmap.best = roadmap.search()
    if roadmap.best is not None:
        path = np.insert(roadmap.best.states, 1, roadmap.best.states[0] + [1.0, 2.0, 3.0], axis=0)
        refine(path, clearance=clearance, risk=risk, low=low, high=high, seconds=0.5)
    roadmap.fastest()


def warm_up_vehicle(roadmap: Roadmap, steering: KinodynamicSteering) -> None:
    """The same for a vehicle with dynamics: what is asked about connections, and flights.

    Args:
        roadmap: still empty; a few motions in its box are evaluated.
        steering: of the vehicle.
    """
    unit = np.random.default_rng(0).random((PLACES, steering.dimensions))
    vertices = steering.vertices(unit, roadmap.region.low, roadmap.region.high)
    a, b = vertices[:-1].copy(), vertices[1:].copy()
    d = roadmap.motions.clearances(vertices)
    roadmap.motions.edge_bounds(a, b, d[:-1], d[1:])
    roadmap.motions.costs(a, b)
    roadmap.gate.allows_motions(a, b)
    vertices = steering.vertices(unit, *FIELD)
    pure = Risk(speed=steering.speed)
    ground = TerrainClearance(Terrain(np.zeros((2, 2)), spacing=(3000.0, 3000.0)), threads=1)
    durations = steering.batch(ground, pure).durations(vertices[:-1], vertices[1:])
    for k in np.flatnonzero(np.isfinite(durations)):
        steering.flight(vertices[k : k + 2])
