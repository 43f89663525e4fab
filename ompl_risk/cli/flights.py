"""What the command `plan` writes of helicopter flights, besides what it writes of any paths."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ompl_risk.cli.finding import Found
from ompl_risk.cli.judging import Judgement
from ompl_risk.cli.progress import progress_bar
from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.cli.scene import Scene
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.helicopter.flight_file import write_flight
from ompl_risk.ranking.assessment import Assessment

if TYPE_CHECKING:
    from rich.console import Console

FRAMES = 120
"""Pictures of the film."""

WIDE, CLOSE = 60.0, 12.0
"""Seconds of flight in the film, and seconds that it takes."""


def write_flights(
    found: Found,
    judgement: Judgement,
    scene: Scene,
    settings: PlanSettings,
    folder: RunFolder,
    console: Console,
    title: str,
) -> None:
    """Write states and inputs at their full rate, views of all flights, and a film of one.

    The film shows the minute around the place where the safest flight by the last norm is nearest
    to the ground on its way, but for its first and last tenth: it begins and ends low.
    """
    from ompl_risk.report import animate_flight, flight_views

    ranking = judgement.ranking
    path = folder.made("flights")
    for assessment, k in zip(ranking.assessments, judgement.order, strict=True):
        write_flight(path / f"{assessment.name}.npz", found.flights[k])
    trajectories = [assessment.trajectory for assessment in ranking.assessments]
    flight_views(
        trajectories,
        scene.terrain,
        ranked_by="the L² norm of $P_c$",
        title=title,
        path=folder.path / "flights.png",
    )
    written = ["flights.png", "flights/"]
    if settings.animation is not None:
        name = ranking.orders[ranking.labels[-1]][0]
        index = [assessment.name for assessment in ranking.assessments].index(name)
        shown = ranking.assessments[index]
        first, last = float(shown.trajectory.t[0]), float(shown.trajectory.t[-1])
        begin = max(min(_nearest(shown) - 0.5 * WIDE, last - WIDE), first)
        film = folder.path / f"flight-{name}.{settings.animation}"
        with progress_bar(console) as progress:
            drawing = progress.add_task(f"filming flight {name}", total=None)
            animate_flight(
                shown.trajectory,
                scene.terrain,
                scene.clearance,
                film,
                avoidance=scene.avoidance,
                begin=begin,
                end=min(begin + WIDE, last),
                frames=FRAMES,
                seconds=CLOSE,
                index=index,
                progress=lambda done, total: progress.update(drawing, completed=done, total=total),
            )
        written.append(film.name)
    console.print(f"and {', '.join(written)}", markup=False, soft_wrap=True)


def _nearest(shown: Assessment) -> float:
    """When a flight is nearest to the ground on its way [s]."""
    t = shown.trajectory.t
    ends = 0.1 * (t[-1] - t[0])
    on_the_way = np.flatnonzero((t >= t[0] + ends) & (t <= t[-1] - ends))
    return float(t[on_the_way[shown.d[on_the_way].argmin()]])
