"""Settings turned into objects, with everything that can be wrong found before work starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ompl_risk import planners, terrains
from ompl_risk._arrays import positive
from ompl_risk.avoidance import Avoidance, GaussianTail
from ompl_risk.avoidance.naming import parse_avoidance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.base import as_length
from ompl_risk.cli.settings import PLACES, JudgeSettings, PlanSettings
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Norm, parse_norm
from ompl_risk.terrains.catalogue import PARAMETRIC

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain


@dataclass(frozen=True)
class Scene:
    """What trajectories are judged by.

    Args:
        clearance: the terrain and the vehicle's sphere.
        avoidance: the avoidance function.
        norms: the norms.
        uncertainty: radius of the ball of the probability of collision [m].
        duration_tolerance: relative spread of durations within which norms compare.
    """

    clearance: TerrainClearance
    avoidance: Avoidance
    norms: tuple[Norm, ...]
    uncertainty: float
    duration_tolerance: float

    @property
    def terrain(self) -> Terrain:
        """The ground."""
        return self.clearance.terrain


def scene_of(terrain: str, settings: JudgeSettings) -> Scene:
    """Check the settings and load the terrain.

    Args:
        terrain: a name of the catalogue, or a path.
        settings: how trajectories are judged.

    Raises:
        OmplRiskError: a setting is out of range, or the terrain cannot be loaded.
    """
    avoidance = parse_avoidance(settings.avoidance, settings.d0)
    if isinstance(avoidance, GaussianTail) and settings.d0 != JudgeSettings().d0:
        allowed = f"left out: {settings.avoidance} ends at {avoidance.d0:g} m"
        raise ArgumentError("d0", settings.d0, allowed)
    uncertainty = positive("uncertainty", settings.uncertainty)
    radius = as_length(settings.radius, "radius")
    tolerance = settings.duration_tolerance
    if not 0.0 <= tolerance < float("inf"):
        raise ArgumentError("duration_tolerance", tolerance, "a finite number of at least 0")
    if settings.rollouts is not None and settings.rollouts < 1:
        raise ArgumentError("rollouts", settings.rollouts, "a whole number of at least 1")
    norms = tuple(parse_norm(name, argument="norms") for name in settings.norms)
    labels = [norm.label for norm in norms]
    if not labels or len(set(labels)) < len(labels):
        raise ArgumentError("norms", list(settings.norms), "at least one, and each only once")
    clearance = TerrainClearance(load_terrain(terrain, settings), radius)
    return Scene(clearance, avoidance, norms, uncertainty, tolerance)


def load_terrain(name: str, settings: JudgeSettings) -> Terrain:
    """The terrain of that name, or in that file.

    Raises:
        OmplRiskError: it cannot be loaded.
    """
    given: dict[str, Any] = {"bounds": settings.bounds, "fill": settings.fill, "crs": settings.crs}
    if settings.terrain_seed is not None:
        if name not in PARAMETRIC:
            known = ", ".join(sorted(PARAMETRIC))
            allowed = f"left out for {name}; it is for {known}"
            raise ArgumentError("terrain_seed", settings.terrain_seed, allowed)
        given["seed"] = settings.terrain_seed
    return terrains.load(name, **given)


def problem_of(settings: PlanSettings, scene: Scene) -> planners.Problem:
    """The planning problem.

    Raises:
        ArgumentError: start, goal or another setting is out of range.
    """
    return planners.low_level_flight(
        scene.clearance,
        _place("start", settings.start, settings, scene),
        _place("goal", settings.goal, settings, scene),
        start_height=settings.start_height,
        goal_height=settings.goal_height,
        ceiling=settings.ceiling,
        margin=settings.margin,
        min_clearance=settings.min_clearance,
        speed=settings.speed,
        avoidance=scene.avoidance,
    )


def _place(
    name: str, given: tuple[float, float] | None, settings: PlanSettings, scene: Scene
) -> tuple[float, float]:
    """The place given, or the one that belongs to the terrain."""
    usual = PLACES.get(settings.terrain) if settings.bounds is None else None
    if given is not None:
        return given
    if usual is not None:
        return usual[name]
    xmin, xmax, ymin, ymax = scene.terrain.extent
    within = f"x {xmin:.7g} to {xmax:.7g} m, y {ymin:.7g} to {ymax:.7g} m"
    raise ArgumentError(name, None, f"given for this terrain, as x y: {within}")
