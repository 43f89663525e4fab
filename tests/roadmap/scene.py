"""A small hilly terrain that tests of the roadmap share."""

import math

import numpy as np

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.norms import Sobolev
from ompl_risk.planners.roadmap.region import Region
from ompl_risk.planners.roadmap.roadmap import Roadmap
from ompl_risk.terrains import Terrain

D0, SPEED, CEILING = 40.0, 20.0, 60.0


def hills(seed=0, n=41, spacing=25.0, relief=22.0):
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:n, 0:n] / (n - 1)
    waves = [(rng.normal(), k, m, rng.uniform(0, 6)) for k in range(1, 5) for m in range(1, 5)]
    h = sum(a * np.sin(2 * math.pi * (k * x + m * y) + p) / (k + m) for a, k, m, p in waves)
    return Terrain(relief * h, spacing=(spacing, spacing))


def ends(terrain, above=15.0):
    xmin, xmax, ymin, ymax = terrain.extent
    places = np.array([(xmin + 60.0, ymin + 60.0), (xmax - 60.0, ymax - 60.0)])
    return np.column_stack([places, terrain.height(*places.T) + above])


def counted(norm=None, weight=None, **options):
    return Risk(
        InverseDistance(D0), norm or Sobolev(1), speed=SPEED, duration_weight=weight, **options
    )


def box(terrain):
    xmin, xmax, ymin, ymax = terrain.extent
    return [xmin, ymin, float(terrain.heights.min())], [xmax, ymax, CEILING]


def pure(risk):
    return Risk(risk.avoidance, risk.norm, speed=risk.speed, duration_weight=0.0)


def roadmap(risk=None, *, clearance=None, seed=0, gate=None, terrain=None, threads=1):
    terrain = hills() if terrain is None else terrain
    risk = counted() if risk is None else risk
    clearance = TerrainClearance(terrain, 2.0) if clearance is None else clearance
    motions = motion_batch(clearance, pure(risk))
    made = Roadmap(Region(*box(terrain), seed=seed), motions, risk, gate=gate, threads=threads)
    start, goal = ends(terrain)
    made.add_starts(start[None])
    made.add_goals(goal[None])
    return made
