"""The command `plan`: from a scenario to ranked paths."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ompl_risk import planners
from ompl_risk.cli.judging import Judgement, judge, report
from ompl_risk.cli.run_folder import RunFolder, settings_as_values
from ompl_risk.cli.scene import problem_of, scene_of
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.errors import ArgumentError, PlanningError
from ompl_risk.planners.menu import menu
from ompl_risk.trajectory_files import write_csv

if TYPE_CHECKING:
    from rich.console import Console

    from ompl_risk.cli.scene import Scene


def plan(settings: PlanSettings, console: Console) -> Judgement:
    """Plan candidates, choose among them, rank the chosen ones and write everything.

    Raises:
        OmplRiskError: a setting is wrong, or fewer than two candidates are left.
        KeyboardInterrupt: Ctrl-C; candidates found so far have been written.
    """
    scene = scene_of(settings.terrain, settings)
    problem = problem_of(settings, scene)
    settings = _resolved(settings, problem)
    tasks = _tasks(settings, problem)
    folder = RunFolder(settings.output)
    folder.write_config("plan", settings_as_values(settings.terrain, settings))
    found = _candidates(settings, problem, tasks, folder, console)
    selection = planners.select(
        found,
        settings.count,
        tolerance=settings.duration_tolerance,
        min_distance=settings.separation * problem.distance,
    )
    _check(selection, found)
    _warn(found, console)
    few = "" if len(selection.chosen) == settings.count else f" instead of {settings.count}"
    console.print(f"{selection.summary}{few}.", markup=False, highlight=False)
    judgement = judge([c.trajectory(settings.speed) for c in selection.chosen], scene, letters=True)
    report(
        judgement,
        scene,
        folder,
        console,
        title=_title(settings, scene, problem, len(selection.chosen)),
        facts=_facts(settings, judgement, selection, found),
        ceiling=float(problem.high[2]),
    )
    return judgement


def _resolved(settings: PlanSettings, problem: planners.Problem) -> PlanSettings:
    """The settings with what was left out filled in."""
    return replace(
        settings,
        start=(float(problem.start[0]), float(problem.start[1])),
        goal=(float(problem.goal[0]), float(problem.goal[1])),
        ceiling=float(problem.high[2]),
        workers=_processors() if settings.workers is None else settings.workers,
    )


def _tasks(settings: PlanSettings, problem: planners.Problem) -> list[planners.Task]:
    """The tasks, after a check of every setting that matters to them."""
    if settings.count < 2:
        raise ArgumentError("count", settings.count, "at least 2, or there is nothing to compare")
    if settings.workers is not None and settings.workers < 1:
        raise ArgumentError("workers", settings.workers, "a whole number of at least 1")
    if not 0.0 < settings.separation < float("inf"):
        raise ArgumentError("separation", settings.separation, "a positive finite number")
    tasks = menu(
        settings.searches,
        runs=settings.runs,
        seed=settings.seed,
        effort=settings.effort,
        time_limit=settings.time_limit,
    )
    for search, task in zip(settings.searches, tasks, strict=False):
        try:
            task.criterion.risk(problem)
        except ArgumentError as error:
            raise ArgumentError("searches", search, error.allowed) from None
    return tasks


def _candidates(
    settings: PlanSettings,
    problem: planners.Problem,
    tasks: Sequence[planners.Task],
    folder: RunFolder,
    console: Console,
) -> list[planners.Candidate]:
    from ompl_risk.cli.progress import progress_bar

    found: list[planners.Candidate] = []
    with progress_bar(console) as progress:
        compiling = progress.add_task("compiling kernels", total=None)
        planners.warm_up(problem)
        progress.remove_task(compiling)
        bar = progress.add_task("planning candidates", total=len(tasks))

        def on_done(candidate: planners.Candidate) -> None:
            found.append(candidate)
            progress.advance(bar)

        try:
            return planners.candidates(
                problem, tasks, workers=settings.workers or 1, on_done=on_done
            )
        except KeyboardInterrupt:
            _write_candidates(found, settings.speed, folder)
            raise


def _write_candidates(found: Sequence[planners.Candidate], speed: float, folder: RunFolder) -> None:
    """Write what there is when the user stops planning."""
    path = folder.path / "candidates"
    for candidate in found:
        if candidate.solved:
            path.mkdir(exist_ok=True)
            name = candidate.task.label.replace(" ", "-").replace("@", "-")
            write_csv(path / f"{name}.csv", candidate.trajectory(speed))


def _check(selection: planners.Selection, found: Sequence[planners.Candidate]) -> None:
    """Refuse to go on with fewer than two paths."""
    if len(selection.chosen) >= 2:
        return
    failed = [c for c in found if c.status is planners.Status.FAILED]
    if failed:
        remedy = f"first failure, {failed[0].task.label}: {failed[0].reason}"
    elif not selection.chosen:
        remedy = "raise --ceiling or --effort, or lower --min-clearance"
    else:
        remedy = "raise --runs or --duration-tolerance, or lower --separation"
    raise PlanningError(selection.summary, remedy)


def _warn(found: Sequence[planners.Candidate], console: Console) -> None:
    """Say which runs failed or were cut short: the selection counts them among the others."""
    for candidate in found:
        if candidate.status is planners.Status.FAILED:
            line = f"{candidate.task.label} failed: {candidate.reason}"
            console.print(line, markup=False, highlight=False, soft_wrap=True)
    late = sum(candidate.timed_out for candidate in found)
    if late:
        line = f"{late} of {len(found)} runs reached --time-limit: another run may differ."
        console.print(line, markup=False, highlight=False)


def _facts(
    settings: PlanSettings,
    judgement: Judgement,
    selection: planners.Selection,
    found: Sequence[planners.Candidate],
) -> dict[str, Any]:
    """Where each path comes from, and what became of every candidate."""
    names = [a.name for a in judgement.ranking.assessments]
    chosen = [selection.chosen[i] for i in judgement.order]
    return {
        "seed": settings.seed,
        "paths": {name: c.task.label for name, c in zip(names, chosen, strict=True)},
        "selection": selection.summary,
        "least_separation": selection.separation,
        "candidates": [
            {
                "task": c.task.label,
                "iterations": c.iterations,
                "status": c.status.value,
                "reason": c.reason,
                "length": c.length if c.solved else None,
                "seconds": round(c.seconds, 3),
                "timed_out": c.timed_out,
            }
            for c in found
        ],
    }


def _title(settings: PlanSettings, scene: Scene, problem: planners.Problem, count: int) -> str:
    name, kilometres = scene.terrain.name, problem.distance / 1000
    return (
        f"{name[:1].upper() + name[1:]}: {count} paths over {kilometres:.1f} km "
        f"at {settings.speed:g} m/s, "
        f"durations within {100 * settings.duration_tolerance:g} %"
    )


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
