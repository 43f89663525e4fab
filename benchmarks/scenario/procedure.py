"""How the five flights are picked, fixed before any of them was judged.

1. The ground is Jacksboro, the vehicle a sphere of 5 m, d0 = r = 100 m.
2. Start and goal of pair k are drawn from ``default_rng([seed, k])``, uniformly within the map less
   a margin of 2 km, until they are 8 to 15 km apart and both clear: hover 60 m above the ground,
   in a box that leaves 15 % of the distance around them, below a ceiling 320 m above the
   higher one.
3. A roadmap of 3,000 places with seed k + 1 is searched by time alone: every flight that stays more
   than 20 m clear of the ground counts as free of risk, so that no norm has a say in what is
   chosen.
4. Of its alternatives within 5 % of the least duration, in the order of ``alternatives`` (fastest,
   one for each side of high summits, farthest from those before), the first five are taken, as
   they are. They differ pairwise by 2 % of the distance in the Frechet distance, or in a side.
5. They are flown, sampled every 0.1 s and judged. A pair with fewer than five is counted, and left
   out.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from benchmarks.blind_flights import BLIND, blind_flights
from ompl_risk import InverseDistance, Lp, Sobolev, TerrainClearance, terrains
from ompl_risk.cli.judging import Judgement, judge
from ompl_risk.cli.scene import Scene
from ompl_risk.errors import ArgumentError
from ompl_risk.planners import Problem, low_level_flight
from ompl_risk.trajectory import Trajectory

FLIGHTS = 5
NORMS = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))
RADIUS, FAR = 5.0, 100.0
MARGIN, NEAREST, FARTHEST = 2000.0, 8000.0, 15000.0
HEIGHT, LEAST = 60.0, 20.0
PLACES = 3000
EXCESS, SEPARATION = 0.05, 0.02
STEP = 0.1


class Pair(NamedTuple):
    """Where flights begin and end: x, y [m]."""

    start: tuple[float, float]
    goal: tuple[float, float]


@cache
def scene() -> Scene:
    """What flights are judged by."""
    clearance = TerrainClearance(terrains.load("jacksboro"), RADIUS, threads=1)
    return Scene(clearance, InverseDistance(FAR), NORMS, FAR, EXCESS)


def pair(seed: int, number: int) -> Pair:
    """The pair of that number."""
    random = np.random.default_rng([seed, number])
    xmin, xmax, ymin, ymax = scene().terrain.extent
    low, high = np.array([xmin, ymin]) + MARGIN, np.array([xmax, ymax]) - MARGIN
    while True:
        start, goal = (tuple(p.tolist()) for p in random.uniform(low, high, (2, 2)))
        if not NEAREST <= math.dist(start, goal) <= FARTHEST:
            continue
        try:
            problem(Pair(start, goal))
        except ArgumentError:  # too near to a slope
            continue
        return Pair(start, goal)


def problem(ends: Pair) -> Problem:
    """The planning problem of a pair, which heeds time alone."""
    return low_level_flight(
        scene().clearance,
        *ends,
        start_height=HEIGHT,
        goal_height=HEIGHT,
        min_clearance=LEAST,
        avoidance=BLIND,
    )


def flights(
    ends: Pair, seed: int, *, places: int = PLACES, threads: int | None = 1
) -> list[Trajectory]:
    """The flights of a pair, the fastest first; five, or fewer if there are no more.

    Args:
        ends: of the flights.
        seed: of the roadmap.
        places: of the roadmap; any other number than the default is another procedure.
        threads: of compiled code; None uses all processors.
    """
    found = blind_flights(
        problem(ends),
        FLIGHTS,
        places=places,
        seed=seed,
        excess=EXCESS,
        separation=SEPARATION,
        threads=threads,
    )
    return [one.trajectory(f"{k + 1}", step=STEP) for k, one in enumerate(found)]


def judged(trajectories: list[Trajectory]) -> Judgement:
    """The ranking: A, B, ... in the order of the L2 norm of the probability of collision."""
    return judge(trajectories, scene(), letters=True)
