"""Paths of the command `plan` flown by a helicopter."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ompl_risk import planners
from ompl_risk.cli.finding import Finder, Found
from ompl_risk.cli.pareto import write_pareto
from ompl_risk.cli.progress import progress_bar
from ompl_risk.cli.roadmap import check_found, counts_of, has_use_for_front, norm_of, ways_of
from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.library import SHIPPED
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.planners.roadmap.equal_time_flights import equal_time_flights
from ompl_risk.planners.roadmap.exploring import Front, pareto_routes
from ompl_risk.planners.roadmap.flights import flight_roadmap
from ompl_risk.planners.roadmap.roadmap import Roadmap, Route
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from rich.console import Console

PLACES = 3000
"""Sampled where the number is left out."""

STEP = 0.1
"""Time between the samples that are ranked and written [s]."""

PARETO_STEP = 0.5
"""The same for the paths of the Pareto set, of which there may be hundreds [s]."""


class HelicopterFinder(Finder):
    """Grows a roadmap of trajectory primitives, and flies alternatives in it.

    Args:
        settings: what is planned, checked.
        problem: the problem.

    Raises:
        ArgumentError: a setting of the roadmap is out of range.
    """

    def __init__(self, settings: PlanSettings, problem: planners.Problem) -> None:
        self._places = PLACES if settings.samples is None else settings.samples
        if self._places < 1:
            raise ArgumentError("samples", settings.samples, "a whole number of at least 1")
        self._norm = norm_of(settings, problem)
        self._settings, self._problem = settings, problem

    def find(self, folder: RunFolder, console: Console) -> Found:
        """Grow the roadmap, choose alternatives and fly them.

        Raises:
            PlanningError: the roadmap has fewer than two such paths.
        """
        settings = self._settings
        steering = HelicopterSteering()
        with progress_bar(console) as progress:
            growing = progress.add_task("growing a roadmap of primitives", total=self._places)
            roadmap = flight_roadmap(
                self._problem,
                steering,
                places=self._places,
                norm=self._norm,
                seed=settings.seed,
                threads=settings.workers,
                on_batch=lambda done: progress.update(growing, completed=done),
            )
            choosing = progress.add_task("choosing and flying alternatives", total=settings.count)
            found = equal_time_flights(
                roadmap,
                self._problem,
                steering,
                settings.count,
                excess=settings.duration_tolerance,
                min_distance=settings.separation * self._problem.distance,
                on_path=lambda chosen: progress.update(choosing, completed=chosen),
            )
        check_found(roadmap, len(found.flights))
        front = pareto_routes(roadmap) if has_use_for_front(settings) else None
        if settings.pareto and front is not None:
            self._write_pareto(front, roadmap, steering, folder, console)
        return Found(
            trajectories=[
                flight.trajectory(f"alternative {k + 1}", step=STEP)
                for k, flight in enumerate(found.flights)
            ],
            labels=[f"roadmap alternative {k + 1}" for k in range(len(found.flights))],
            summary=found.summary,
            separation=found.separation,
            flights=found.flights,
            ways=ways_of(front, lambda route: steering.flight(roadmap.states[route.vertices])),
            facts={
                "roadmap": counts_of(roadmap),
                "primitives": {"file": SHIPPED.name, "sha256": _digest(SHIPPED)},
                "flights": [
                    {"alternative": k + 1, **_in_numbers(flight)}
                    for k, flight in enumerate(found.flights)
                ],
            },
        )

    def _write_pareto(
        self,
        front: Front,
        roadmap: Roadmap,
        steering: HelicopterSteering,
        folder: RunFolder,
        console: Console,
    ) -> None:
        def planned(route: Route, name: str) -> Trajectory:
            way = steering.planned(roadmap.states[route.vertices])
            return way.trajectory(name, step=PARETO_STEP)

        unit = self._problem.avoidance.unit
        write_pareto(front, self._norm, unit, planned, folder, console)


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _in_numbers(flight: Flight) -> dict[str, Any]:
    """What the provenance tells of a flight."""
    return {
        "seconds": flight.duration,
        "metres": flight.length,
        "greatest deviation from the plan": {
            "metres": flight.deviation.distance,
            "degrees": flight.deviation.degrees,
        },
    }
