"""Where the campaign plans: three terrains, a forest of meshes, circles lifted to 3-D."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from benchmarks.campaign.obstacles import Columns, Forest, scattered
from ompl_risk import BallSampling, InverseDistance, TerrainClearance, terrains
from ompl_risk.planners import Problem, low_level_flight
from ompl_risk.terrains import Terrain

MARGIN = 0.1
"""Least clearance that a path may have, as a part of d0. Without it the shortest paths would graze
obstacles, and lose to any norm by any factor."""


@dataclass(frozen=True)
class Scene:
    """A problem, and how the paths through it are judged.

    Attributes:
        name: short name, without spaces.
        about: one line for tables.
        problem: what is planned.
        recipe: what the scene was made from; a part of every run's configuration.
        error: radius r of the ball of possible positions, for probabilities of collision [m].
        sampling: estimator of the probability that a constant error makes the flight collide.
    """

    name: str
    about: str
    problem: Problem
    recipe: Mapping[str, Any]
    error: float
    sampling: BallSampling

    @property
    def is_terrain(self) -> bool:
        """Whether the obstacles are a terrain, for which everything is compiled."""
        return isinstance(self.problem.clearance, TerrainClearance)


def jacksboro(
    start: tuple[float, float] = (10000.0, 16000.0),
    goal: tuple[float, float] = (22000.0, 25000.0),
    height: float = 110.0,
    ceiling: float = 840.0,
) -> Scene:
    """15 km across the Jacksboro fault; the way over its ridges is 55 m high at best."""
    about = "15 km across the Jacksboro fault under a ceiling"
    return _flight("jacksboro", about, terrains.load("jacksboro"), start, goal, height, ceiling)


def canyon(
    floor: float = 60.0, wall: float = 240.0, height: float = 90.0, ceiling: float = 130.0
) -> Scene:
    """Along a winding canyon, too deep to leave and nowhere d0 wide: short ways cut its bends."""
    terrain = terrains.load("canyon", floor=floor, wall=wall)
    x, y = terrain.axes
    ends = [
        (x.start + x.step * k, y.start + y.step * _middle(terrain.heights[:, k]))
        for k in (20, terrain.shape[1] - 20)
    ]
    about = "11 km along a winding canyon that nothing leaves"
    return _flight("canyon", about, terrain, ends[0], ends[1], height, ceiling)


def ridge_valley(
    start: tuple[float, float] = (1500.0, 1500.0),
    goal: tuple[float, float] = (10500.0, 7500.0),
    height: float = 110.0,
    ceiling: float = 320.0,
) -> Scene:
    """Across parallel ridges; only their passes are low enough."""
    about = "11 km across parallel ridges with passes under a ceiling"
    terrain = terrains.load("ridge_valley")
    return _flight("ridge_valley", about, terrain, start, goal, height, ceiling)


def forest(
    trees: int = 36, size: float = 60.0, seed: int = 5, height: float = 12.0, sections: int = 8
) -> Scene:
    """Among trees: cylinders as triangle meshes, through python-fcl."""
    ends = np.array([[4.0, 4.0, 5.0], [size - 4.0, size - 4.0, 5.0]])
    trunks = scattered(trees, size, (0.4, 1.2), seed, gap=2.0, clear=ends[:, :2], clear_radius=5.0)
    clearance = Forest(trunks, height, sections, radius=0.5)
    about = f"{trees} trees as meshes on {size:g} m x {size:g} m"
    return _columns("forest", about, clearance, ends, size, speed=5.0, d0=5.0, samples=1000)


def circles(count: int = 40, size: float = 100.0, seed: int = 3) -> Scene:
    """OMPL's circles in the plane, overlapping, lifted to upright columns."""
    ends = np.array([[4.0, 4.0, 5.0], [size - 4.0, size - 4.0, 5.0]])
    drawn = scattered(count, size, (2.0, 7.0), seed, gap=-3.0, clear=ends[:, :2], clear_radius=8.0)
    about = f"{count} circles on {size:g} m x {size:g} m, lifted to columns"
    clearance = Columns(drawn, radius=0.5)
    return _columns("circles", about, clearance, ends, size, speed=5.0, d0=8.0, samples=2000)


SCENES: Mapping[str, Callable[..., Scene]] = MappingProxyType(
    {make.__name__: make for make in (jacksboro, canyon, ridge_valley, forest, circles)}
)


def recipe(name: str) -> dict[str, Any]:
    """What a scene is made from, without making it: the defaults of its function."""
    parameters = inspect.signature(SCENES[name]).parameters.values()
    return {parameter.name: parameter.default for parameter in parameters}


def _middle(profile: np.ndarray) -> float:
    """Row in the middle of the lowest ground of a section."""
    return float(np.flatnonzero(profile <= profile.min() + 1.0).mean())


def _flight(
    name: str,
    about: str,
    terrain: Terrain,
    start: tuple[float, float],
    goal: tuple[float, float],
    height: float,
    ceiling: float,
    d0: float = 100.0,
) -> Scene:
    problem = low_level_flight(
        TerrainClearance(terrain, 5.0, threads=1),
        start,
        goal,
        start_height=height,
        goal_height=height,
        ceiling=ceiling,
        min_clearance=MARGIN * d0,
        speed=30.0,
        avoidance=InverseDistance(d0),
    )
    return Scene(name, about, problem, recipe(name), d0, BallSampling(1000, offsets="shared"))


def _columns(
    name: str,
    about: str,
    clearance: Any,
    ends: np.ndarray,
    size: float,
    *,
    speed: float,
    d0: float,
    samples: int,
) -> Scene:
    """A square among columns that reach above its ceiling, so that nothing leads over them."""
    problem = Problem(
        clearance,
        ends[0],
        ends[1],
        (0.0, 0.0, 2.0),
        (size, size, 8.0),
        speed=speed,
        avoidance=InverseDistance(d0),
        min_clearance=MARGIN * d0,
    )
    sampling = BallSampling(samples, offsets="shared")
    return Scene(name, about, problem, recipe(name), 0.5 * d0, sampling)
