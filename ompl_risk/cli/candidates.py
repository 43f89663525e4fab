"""Paths of the command `plan` from OMPL's planners in worker processes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ompl_risk import planners
from ompl_risk.cli.finding import Finder, Found
from ompl_risk.cli.progress import progress_bar
from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.errors import ArgumentError, PlanningError
from ompl_risk.planners.menu import menu
from ompl_risk.trajectory_files import write_csv

if TYPE_CHECKING:
    from rich.console import Console


class CandidateFinder(Finder):
    """Runs every search with several seeds, and chooses paths of equal time that differ.

    Args:
        settings: what is planned, checked.
        problem: the problem.
        planner: the one that runs all searches; None for that which each search names.

    Raises:
        ArgumentError: a search that cannot be run.
    """

    def __init__(
        self, settings: PlanSettings, problem: planners.Problem, planner: str | None
    ) -> None:
        self._settings, self._problem = settings, problem
        self._tasks = _tasks(settings, problem, planner)

    def find(self, folder: RunFolder, console: Console) -> Found:
        """Run the searches.

        Raises:
            PlanningError: fewer than two paths are left.
            KeyboardInterrupt: Ctrl-C; candidates found so far have been written.
        """
        settings = self._settings
        candidates = self._run(folder, console)
        selection = planners.select(
            candidates,
            settings.count,
            tolerance=settings.duration_tolerance,
            min_distance=settings.separation * self._problem.distance,
        )
        _check(selection, candidates)
        _warn(candidates, console)
        return Found(
            trajectories=[c.trajectory(settings.speed) for c in selection.chosen],
            labels=[c.task.label for c in selection.chosen],
            summary=selection.summary,
            separation=selection.separation,
            facts={"candidates": [_row(c) for c in candidates]},
        )

    def _run(self, folder: RunFolder, console: Console) -> list[planners.Candidate]:
        found: list[planners.Candidate] = []
        planners.warm_up(self._problem)  # which is no part of planning
        with progress_bar(console) as progress:
            bar = progress.add_task("planning candidates", total=len(self._tasks))

            def on_done(candidate: planners.Candidate) -> None:
                found.append(candidate)
                progress.advance(bar)

            try:
                return planners.candidates(
                    self._problem, self._tasks, workers=self._settings.workers, on_done=on_done
                )
            except KeyboardInterrupt:
                _write_candidates(found, self._settings.speed, folder)
                raise


def _tasks(
    settings: PlanSettings, problem: planners.Problem, planner: str | None
) -> list[planners.Task]:
    """The tasks, after a check of every setting that matters to them."""
    if settings.workers is not None and settings.workers < 1:
        raise ArgumentError("workers", settings.workers, "a whole number of at least 1")
    searches = list(settings.searches)
    if planner is not None:
        criteria = [search.rpartition(":")[2] for search in searches]
        searches = [f"{planner}:{criterion}" for criterion in dict.fromkeys(criteria)]
    tasks = menu(
        searches,
        runs=settings.runs,
        seed=settings.seed,
        effort=settings.effort,
        time_limit=settings.time_limit,
    )
    for search, task in zip(searches, tasks, strict=False):
        try:
            task.criterion.risk(problem)
        except ArgumentError as error:
            raise ArgumentError("searches", search, error.allowed) from None
    return tasks


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


def _row(candidate: planners.Candidate) -> dict[str, Any]:
    """What became of a candidate."""
    return {
        "task": candidate.task.label,
        "iterations": candidate.iterations,
        "status": candidate.status.value,
        "reason": candidate.reason,
        "length": candidate.length if candidate.solved else None,
        "seconds": round(candidate.seconds, 3),
        "timed_out": candidate.timed_out,
    }
