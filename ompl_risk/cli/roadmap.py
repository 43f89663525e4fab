"""Paths of the command `plan` from a roadmap."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from ompl_risk import planners
from ompl_risk.cli.finding import Finder, Found, Way
from ompl_risk.cli.pareto import write_pareto
from ompl_risk.cli.progress import progress_bar
from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.errors import ArgumentError, PlanningError
from ompl_risk.motion import Risk
from ompl_risk.norms import Norm, parse_norm
from ompl_risk.planners.roadmap.building import roadmap_of
from ompl_risk.planners.roadmap.equal_time import equal_time_paths
from ompl_risk.planners.roadmap.exploring import Front, pareto_routes
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from rich.console import Console

SAMPLES = 30_000
"""Sampled where the number is left out."""


class RoadmapFinder(Finder):
    """Grows a roadmap and looks for alternatives in it, the same ones for the same seed.

    Args:
        settings: what is planned, checked.
        problem: the problem.

    Raises:
        ArgumentError: a setting of the roadmap is out of range.
    """

    def __init__(self, settings: PlanSettings, problem: planners.Problem) -> None:
        self._samples = SAMPLES if settings.samples is None else settings.samples
        if self._samples < 1:
            raise ArgumentError("samples", settings.samples, "a whole number of at least 1")
        self._norm = norm_of(settings, problem)
        self._settings, self._problem = settings, problem

    def find(self, folder: RunFolder, console: Console) -> Found:
        """Grow the roadmap, take alternatives from it, and with `--pareto` its Pareto set.

        Raises:
            PlanningError: the roadmap has fewer than two such paths.
        """
        settings = self._settings
        with progress_bar(console) as progress:
            growing = progress.add_task("growing a roadmap", total=self._samples)
            roadmap = roadmap_of(
                self._problem,
                samples=self._samples,
                norm=self._norm,
                seed=settings.seed,
                threads=settings.workers,
                on_batch=lambda done: progress.update(growing, completed=done),
            )
            choosing = progress.add_task("choosing alternatives", total=settings.count)
            paths = equal_time_paths(
                roadmap,
                self._problem,
                settings.count,
                excess=settings.duration_tolerance,
                min_distance=settings.separation * self._problem.distance,
                on_path=lambda chosen: progress.update(choosing, completed=chosen),
            )
        check_found(roadmap, len(paths.positions))
        front = pareto_routes(roadmap) if has_use_for_front(settings) else None
        if settings.pareto and front is not None:
            unit = self._problem.avoidance.unit
            write_pareto(front, self._norm, unit, self._trajectory, folder, console)
        return Found(
            trajectories=[
                Trajectory.at_constant_speed(p, settings.speed, f"alternative {k + 1}")
                for k, p in enumerate(paths.positions)
            ],
            labels=[f"roadmap alternative {k + 1}" for k in range(len(paths.positions))],
            summary=paths.summary,
            separation=paths.separation,
            facts={"roadmap": counts_of(roadmap)},
            ways=ways_of(front, lambda route: self._trajectory(route, "chosen")),
        )

    def _trajectory(self, route: Route, name: str) -> Trajectory:
        return Trajectory.at_constant_speed(route.states, self._settings.speed, name)


def has_use_for_front(settings: PlanSettings) -> bool:
    """Whether the Pareto set is asked for, or for a risk budget to choose from."""
    return settings.pareto or settings.max_collision_probability is not None


def ways_of(front: Front | None, made: Callable[[Route], Any]) -> Sequence[Way]:
    """The paths of a Pareto set, the fastest first.

    Args:
        front: the set; none if there is no use for it.
        made: a route as a trajectory or flight.
    """
    if front is None:
        return []
    return [Way(route.duration, partial(made, route)) for route in front.routes]


def norm_of(settings: PlanSettings, problem: planners.Problem) -> Norm:
    """The norm that the roadmap counts risk by.

    Raises:
        ArgumentError: no norm, or one that does not add up along a path.
    """
    norm = parse_norm(settings.roadmap_norm, argument="roadmap_norm")
    try:
        Risk(problem.avoidance, norm, speed=problem.speed)
    except ArgumentError as error:
        raise ArgumentError("roadmap_norm", settings.roadmap_norm, error.allowed) from None
    return norm


def counts_of(roadmap: Roadmap) -> dict[str, int]:
    """How large a roadmap has grown, for the provenance."""
    return {"vertices": roadmap.n, "edges": roadmap.edges.m, "evaluated": roadmap.evaluated}


def check_found(roadmap: Roadmap, count: int) -> None:
    """Refuse to go on with fewer than two paths.

    Raises:
        PlanningError: says what there is, and what to try.
    """
    if count >= 2:
        return
    if count == 0:
        outcome = (
            f"no path in a roadmap of {roadmap.n} vertices, of which {roadmap.reached} can be "
            "reached from the start"
        )
        remedy = "raise --ceiling or --samples, or lower --min-clearance"
    else:
        outcome = "a single path, and no other of equal time that differs from it"
        remedy = "raise --samples or --duration-tolerance, or lower --separation"
    raise PlanningError(outcome, remedy)
