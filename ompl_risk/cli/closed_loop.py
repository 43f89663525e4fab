"""Closed-loop probabilities of the commands: of every path, and within a risk budget."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table

from ompl_risk.cli.finding import Found, Way
from ompl_risk.cli.judging import Judgement
from ompl_risk.cli.progress import progress_bar
from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.cli.scene import Scene
from ompl_risk.cli.settings import JudgeSettings, PlanSettings
from ompl_risk.errors import ArgumentError, PlanningError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.flight_file import write_flight
from ompl_risk.simulation.budget import Budgeted, fastest_within
from ompl_risk.simulation.closed_loop import closed_loop_probability
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.estimate import CollisionEstimate
from ompl_risk.trajectory_files import write_csv

if TYPE_CHECKING:
    from rich.console import Console

LEAST_BUDGET = 1e-5
"""To show that a path keeps to a smaller one would take more than half a million rollouts."""

STEP = 0.1
"""Time between the samples of a flight that are written [s]."""


def check_disturbances(settings: JudgeSettings, *, flown: bool, by: str = "--rollouts") -> None:
    """Refuse a level of disturbances that has no say.

    Raises:
        ArgumentError: nothing is flown in them.
    """
    if not flown and settings.disturbances != JudgeSettings().disturbances:
        allowed = f"left out without {by}: nothing else is flown in disturbances"
        raise ArgumentError("disturbances", settings.disturbances, allowed)


def closed_loop(
    plans: Sequence[Any], scene: Scene, settings: JudgeSettings, console: Console, *, seed: int = 0
) -> Sequence[CollisionEstimate]:
    """Fly every path ``settings.rollouts`` times; none if that is left out.

    Args:
        plans: flights or trajectories.
        scene: what can be hit.
        settings: how often, and in which disturbances.
        console: where progress is shown.
        seed: of the disturbances.
    """
    if settings.rollouts is None:
        return ()
    disturbances = Disturbances.level(settings.disturbances)
    with progress_bar(console) as progress:
        flying = progress.add_task("flying in wind and errors", total=len(plans))
        return closed_loop_probability(
            plans,
            scene.clearance,
            disturbances,
            rollouts=settings.rollouts,
            seed=seed,
            on_plan=lambda _estimate: progress.advance(flying),
        )


def write_closed_loop(
    judgement: Judgement,
    scene: Scene,
    settings: JudgeSettings,
    folder: RunFolder,
    console: Console,
    title: str,
) -> None:
    """Write and draw what became of the rollouts of the ranked paths, if they were flown."""
    ranking = judgement.ranking
    flown = [
        replace(a.estimate, name=a.name)
        for a in ranking.assessments
        if isinstance(a.estimate, CollisionEstimate)
    ]
    if not flown:
        return
    disturbances = asdict(Disturbances.level(settings.disturbances))
    facts = {"level": settings.disturbances, "disturbances": disturbances}
    folder.write_json("closed_loop.json", {**facts, "paths": [one.to_dict() for one in flown]})
    from ompl_risk.report import closed_loop_figure

    paths = [assessment.trajectory for assessment in ranking.assessments]
    path = folder.path / "closed_loop.png"
    closed_loop_figure(paths, flown, scene.terrain, title=title, path=path)
    console.print("and closed_loop.png, closed_loop.json", markup=False)


def spend_budget(
    found: Found, scene: Scene, settings: PlanSettings, folder: RunFolder, console: Console
) -> None:
    """Find the fastest path whose probability of collision is within the budget, and write it.

    Raises:
        PlanningError: no path keeps to it; what was tried has been written.
    """
    budget = settings.max_collision_probability
    if budget is None:
        return
    made: dict[int, Any] = {}
    candidates = _candidates(found)

    def plan(place: int) -> Any:
        if place not in made:
            made[place] = candidates[place]()
        return made[place]

    disturbances = Disturbances.level(settings.disturbances)
    with progress_bar(console) as progress:
        trying = progress.add_task("flying the fastest paths in wind and errors", total=None)
        result = fastest_within(
            plan,
            len(candidates),
            scene.clearance,
            disturbances,
            budget,
            seed=settings.seed,
            threads=settings.workers,
            on_trial=lambda _place, _estimate: progress.advance(trying),
            on_rollouts=lambda place, flown: progress.update(
                trying, description=f"path {place + 1} of {len(candidates)}: {flown:,} rollouts"
            ),
        )
    durations = {place: float(made[place].duration) for place in result.tried}
    console.print(_table(result, durations))
    _write(result, durations, settings, folder)
    if result.chosen is None:
        outcome = (
            f"no path with a probability of collision of at most {budget:g} in "
            f"{settings.disturbances} disturbances: {len(result.tried)} of {len(candidates)} were "
            f"tried, of which the least upper bound is "
            f"{result.tried[result.nearest].upper_bound():.3g}"
        )
        raise PlanningError(outcome, "raise --ceiling, --min-clearance or --samples, or allow more")
    written = _write_path(made[result.chosen], folder)
    estimate = result.tried[result.chosen]
    console.print(
        f"Fastest path within {budget:g}: {durations[result.chosen]:.1f} s. {estimate.hits:,} of "
        f"{estimate.rollouts:,} rollouts collide, so its probability is at most "
        f"{estimate.upper_bound():.3g} ({100.0 * result.confidence:g} %, all trials counted: "
        f"{len(result.tried)} of {len(candidates)} paths). Written: budget.json, {written}",
        soft_wrap=True,
        markup=False,
        highlight=False,
    )


def _candidates(found: Found) -> Sequence[Callable[[], Any]]:
    """What makes each candidate, in order of duration.

    Alternatives have been smoothed, so they may be faster than the Pareto set of the roadmap.
    """
    flown = found.flights or found.trajectories
    ways = [*found.ways, *(Way(one.duration, lambda one=one: one) for one in flown)]
    return [way.made for way in sorted(ways, key=lambda way: way.duration)]


def _table(result: Budgeted, durations: dict[int, float]) -> Table:
    table = Table(
        title=f"Probability of a collision, {result.budget:g} allowed",
        title_justify="left",
        box=box.SIMPLE_HEAD,
    )
    for heading in ("path", "duration", "estimate", "at most", "rollouts", ""):
        table.add_column(heading, justify="right")
    words = {"below": "keeps to it", "above": "too risky", "open": "undecided"}
    for place in sorted(result.tried):
        estimate = result.tried[place]
        star, style = ("* ", "bold green") if place == result.chosen else ("", "")
        table.add_row(
            f"{star}{place + 1}",
            f"{durations[place]:.1f} s",
            f"{estimate.probability:.3g}" if estimate.hits else "none seen",
            f"{estimate.upper_bound():.3g}",
            f"{estimate.rollouts:,}",
            words[estimate.decided(result.budget)],
            style=style,
        )
    return table


def _write(
    result: Budgeted, durations: dict[int, float], settings: PlanSettings, folder: RunFolder
) -> None:
    disturbances = Disturbances.level(settings.disturbances)
    tried = [
        {"path": k + 1, "duration": durations[k], **result.tried[k].to_dict()}
        for k in sorted(result.tried)
    ]
    data = {
        "budget": result.budget,
        "confidence": result.confidence,
        "chosen": None if result.chosen is None else result.chosen + 1,
        "candidates": result.candidates,
        "level": settings.disturbances,
        "disturbances": asdict(disturbances),
        "tried": tried,
    }
    folder.write_json("budget.json", data)


def _write_path(chosen: Any, folder: RunFolder) -> str:
    """The chosen path in files; their names."""
    if not isinstance(chosen, Flight):
        write_csv(folder.path / "chosen.csv", chosen)
        return "chosen.csv"
    write_flight(folder.path / "chosen.npz", chosen)
    write_csv(folder.path / "chosen.csv", chosen.trajectory("chosen", step=STEP))
    return "chosen.csv, chosen.npz"
