"""The command `plan`: from a scenario to ranked paths."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ompl_risk import planners
from ompl_risk.clearance.threads import thread_count
from ompl_risk.cli.candidates import CandidateFinder
from ompl_risk.cli.closed_loop import (
    LEAST_BUDGET,
    check_disturbances,
    closed_loop,
    spend_budget,
    write_closed_loop,
)
from ompl_risk.cli.finding import Finder, Found
from ompl_risk.cli.helicopter import PLACES, HelicopterFinder
from ompl_risk.cli.judging import Judgement, judge, report
from ompl_risk.cli.roadmap import SAMPLES, RoadmapFinder
from ompl_risk.cli.run_folder import RunFolder, settings_as_values
from ompl_risk.cli.scene import problem_of, scene_of
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.methods import METHODS

if TYPE_CHECKING:
    from rich.console import Console

    from ompl_risk.cli.scene import Scene

ROADMAP, PORTFOLIO = "roadmap", "portfolio"
OF_ROADMAP = "samples", "roadmap_norm", "pareto"
OF_SEARCHES = "searches", "runs", "effort", "time_limit"
OF_HELICOPTER = ("animation",)
"""Settings that only the roadmap, only planners of OMPL, or only the helicopter have a use for."""


def plan(settings: PlanSettings, console: Console) -> Judgement:
    """Find paths of equal time, rank them and write everything.

    Raises:
        OmplRiskError: a setting is wrong, or there are fewer than two paths.
        KeyboardInterrupt: Ctrl-C; candidates found so far have been written.
    """
    scene = scene_of(settings.terrain, settings)
    problem = problem_of(settings, scene)
    settings = _resolved(settings, problem)
    finder = _finder(settings, problem)
    folder = RunFolder(settings.output)
    folder.write_config("plan", settings_as_values(settings.terrain, settings))
    found = finder.find(folder, console)
    few = "" if len(found.trajectories) == settings.count else f" instead of {settings.count}"
    console.print(f"{found.summary}{few}.", markup=False, highlight=False)
    estimates = closed_loop(
        found.flights or found.trajectories, scene, settings, console, seed=settings.seed
    )
    judgement = judge(found.trajectories, scene, letters=True, estimates=estimates)
    title = _title(settings, scene, problem, len(found.trajectories))
    report(
        judgement,
        scene,
        folder,
        console,
        title=title,
        facts=_facts(settings, judgement, found),
        ceiling=float(problem.high[2]),
    )
    write_closed_loop(judgement, scene, settings, folder, console, title)
    if found.flights:
        from ompl_risk.cli.flights import write_flights

        write_flights(found, judgement, scene, settings, folder, console, title)
    spend_budget(found, scene, settings, folder, console)
    return judgement


def _resolved(settings: PlanSettings, problem: planners.Problem) -> PlanSettings:
    """The settings with what was left out filled in."""
    return replace(
        settings,
        samples=_samples(settings),
        start=(float(problem.start[0]), float(problem.start[1])),
        goal=(float(problem.goal[0]), float(problem.goal[1])),
        ceiling=float(problem.high[2]),
        workers=thread_count(None) if settings.workers is None else settings.workers,
    )


def _samples(settings: PlanSettings) -> int | None:
    """How many places a roadmap samples; None without a roadmap."""
    if settings.samples is not None or settings.planner.lower() != ROADMAP:
        return settings.samples
    return SAMPLES if settings.vehicle == "point" else PLACES


def _finder(settings: PlanSettings, problem: planners.Problem) -> Finder:
    """Who finds the paths, after a check of every setting that matters to that.

    Raises:
        ArgumentError: a setting is out of range.
    """
    if settings.count < 2:
        raise ArgumentError("count", settings.count, "at least 2, or there is nothing to compare")
    if not 0.0 < settings.separation < float("inf"):
        raise ArgumentError("separation", settings.separation, "a positive finite number")
    if settings.workers is not None and settings.workers < 1:
        raise ArgumentError("workers", settings.workers, "a whole number of at least 1")
    if settings.seed < 1:
        raise ArgumentError("seed", settings.seed, "a whole number of at least 1")
    budget = settings.max_collision_probability
    if budget is not None and not LEAST_BUDGET <= budget < 1.0:
        allowed = f"between 0 and 1, and {LEAST_BUDGET:g} at least: less takes too many rollouts"
        raise ArgumentError("max_collision_probability", budget, allowed)
    check_disturbances(
        settings,
        flown=settings.rollouts is not None or budget is not None,
        by="--rollouts or --max-collision-probability",
    )
    kind = settings.planner.lower()
    idle = OF_SEARCHES if kind == ROADMAP else OF_ROADMAP
    _refuse_idle(settings, idle, f"--planner {settings.planner}")
    if settings.vehicle == "helicopter":
        return _helicopter_finder(settings, problem, kind)
    _refuse_idle(settings, OF_HELICOPTER, "--vehicle point")
    if kind == ROADMAP:
        return RoadmapFinder(settings, problem)
    if kind == PORTFOLIO:
        return CandidateFinder(settings, problem, None)
    names = {name.lower(): name for name in METHODS}
    if kind not in names:
        allowed = ", ".join([ROADMAP, PORTFOLIO, *names])
        raise ArgumentError("planner", settings.planner, f"one of {allowed}")
    return CandidateFinder(settings, problem, names[kind])


def _helicopter_finder(settings: PlanSettings, problem: planners.Problem, kind: str) -> Finder:
    if kind != ROADMAP:
        allowed = "roadmap: others do not plan trajectory primitives"
        raise ArgumentError("planner", settings.planner, allowed)
    if settings.speed != PlanSettings().speed:
        allowed = "left out with --vehicle helicopter: its primitives have speeds of their own"
        raise ArgumentError("speed", settings.speed, allowed)
    if settings.animation is not None:
        from ompl_risk.report.film_files import check_film_path

        check_film_path(Path(f"flight.{settings.animation}"))
    return HelicopterFinder(settings, problem)


def _refuse_idle(settings: PlanSettings, names: tuple[str, ...], choice: str) -> None:
    """Refuse settings that were changed but have no say with a planner or vehicle."""
    for name in names:
        value = getattr(settings, name)
        if value != getattr(PlanSettings(), name):
            allowed = f"left out with {choice}, which has no use for it"
            raise ArgumentError(name, value, allowed)


def _facts(settings: PlanSettings, judgement: Judgement, found: Found) -> dict[str, Any]:
    """Where each path comes from, and how it was chosen."""
    names = [a.name for a in judgement.ranking.assessments]
    labels = [found.labels[i] for i in judgement.order]
    return {
        "seed": settings.seed,
        "planner": settings.planner,
        "paths": dict(zip(names, labels, strict=True)),
        "selection": found.summary,
        "least_separation": found.separation,
        **found.facts,
    }


def _title(settings: PlanSettings, scene: Scene, problem: planners.Problem, count: int) -> str:
    name, kilometres = scene.terrain.name, problem.distance / 1000
    flown = "by helicopter" if settings.vehicle == "helicopter" else f"at {settings.speed:g} m/s"
    return (
        f"{name[:1].upper() + name[1:]}: {count} paths over {kilometres:.1f} km "
        f"{flown}, "
        f"durations within {100 * settings.duration_tolerance:g} %"
    )
