"""Many planners, seeds and criteria at once, and a ranking of all that they find."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Norm
from ompl_risk.planners.candidate_ranking import CandidateRanking, rank_candidates
from ompl_risk.planners.engine_choice import engine_of
from ompl_risk.planners.engines import Engine
from ompl_risk.planners.generation import OnDone, candidates
from ompl_risk.planners.menu import parse_task
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.task import Candidate, Task
from ompl_risk.planners.warming import warm_up
from ompl_risk.ranking import DEFAULT_NORMS


class Portfolio:
    """Planners, seeds and criteria that work on a problem side by side.

    No planner is best on every problem, and what they find differs: a portfolio runs them all and
    leaves the choice to the norms. Runs count iterations and are seeded, so the same portfolio
    finds the same paths for the same problem, on any engine, as long as no time limit ends a run.

    Args:
        members: tasks, or texts as `menu` reads them: criteria ("H1@20", "length") by BITstar,
            planners ("RRTConnect"), or both ("RRTstar:H1@20"). Planners that minimise nothing, RRT,
            RRTConnect and the KPIECE family, give feasible paths that only the simplifier
            improves; FMT and BFMT minimise length alone.
        seeds: each text is run once with each of them; a task has its own.
        effort: factor on the usual iterations of texts.
        time_limit: most seconds for a run of a text [s].
        workers: number of processes; all processors if left out, 1 plans in this process.
        engine: where they run: "loky", "dask", "ray" or another backend of joblib, see `engine_of`.
        options: of the engine, such as `scheduler="tcp://host:8786"` for Dask.

    Raises:
        ArgumentError: no member, one that is there twice, an unknown name, a planner that would
            hang or crash with its criterion, or a number out of range.
        ExtraError: the engine's package is not installed.

    Attributes:
        tasks: what is run.
        arrived: candidates of the last `solve`, in the order of arrival; also after Ctrl-C.

    Example:
        >>> portfolio = Portfolio(["length", "H1@20", "RRTConnect:H1@20"], seeds=(1, 2))
        >>> len(portfolio.tasks)
        6
    """

    def __init__(
        self,
        members: Sequence[Task | str],
        *,
        seeds: Iterable[int] = (1,),
        effort: float = 1.0,
        time_limit: float = 60.0,
        workers: int | None = None,
        engine: str | Engine = "loky",
        **options: Any,
    ) -> None:
        self.engine = engine_of(engine, workers, **options)
        members = [members] if isinstance(members, Task | str) else list(members)
        seeds = tuple(seeds)
        for name, given in (("members", members), ("seeds", seeds)):
            if not given:
                raise ArgumentError(name, given, "at least one")
        texts = {"effort": effort, "time_limit": time_limit, "argument": "members"}
        self.tasks = tuple(_tasks(members, seeds, texts))
        _check(self.tasks)
        self.arrived: tuple[Candidate, ...] = ()

    def __repr__(self) -> str:
        return f"Portfolio({[task.label for task in self.tasks]})"

    def solve(
        self,
        problem: Problem,
        *,
        total_time: float | None = None,
        on_done: OnDone | None = None,
    ) -> list[Candidate]:
        """Run all tasks.

        What fails costs only itself: an exception, a crash or a hang of one run gives a candidate
        without a path that says so. Ctrl-C stops the workers; `arrived` has what came in.

        Args:
            problem: what to plan.
            total_time: seconds for all runs together [s]; none if left out.
            on_done: called with each candidate as it arrives, in this process.

        Returns:
            A candidate for each task, in the order of `tasks`.

        Raises:
            ArgumentError: a criterion that the problem has no use for, or a problem that cannot be
                sent to workers.
        """
        for task in self.tasks:
            task.criterion.risk(problem)  # refuses what no run could minimise
        self.arrived = ()

        def keep(candidate: Candidate) -> None:
            self.arrived += (candidate,)
            if on_done is not None:
                on_done(candidate)

        warm_up(problem)  # or each worker would compile the same
        return candidates(
            problem, self.tasks, engine=self.engine, total_time=total_time, on_done=keep
        )

    def rank(
        self,
        problem: Problem,
        norms: Iterable[Norm] = DEFAULT_NORMS,
        *,
        total_time: float | None = None,
        on_done: OnDone | None = None,
        **options: Any,
    ) -> CandidateRanking:
        """Run all tasks and rank what they find.

        Args:
            problem: what to plan.
            norms: to rank by.
            total_time: see `solve`.
            on_done: see `solve`.
            options: of `ompl_risk.rank`, such as `duration_tolerance`.

        Raises:
            ArgumentError: as `solve` and `ompl_risk.rank`.
            PlanningError: no task has found a path.

        Warns:
            DurationWarning: durations differ, as they mostly do where some members minimise length
                and others risk; `select` picks those of nearly equal duration.
        """
        found = self.solve(problem, total_time=total_time, on_done=on_done)
        return rank_candidates(problem, found, norms, **options)


def _tasks(
    members: Sequence[Task | str], seeds: Sequence[int], texts: dict[str, Any]
) -> Iterator[Task]:
    """Every member in its order, then the texts again with each further seed."""
    for k, seed in enumerate(seeds):
        for member in members:
            if isinstance(member, str):
                yield parse_task(member, seed=seed, **texts)
            elif k == 0:
                yield member


def _check(tasks: Sequence[Task]) -> None:
    for k, task in enumerate(tasks):
        if not isinstance(task, Task):
            raise ArgumentError("members", task, 'a Task, or a text such as "RRTstar:H1@20"')
        if task in tasks[:k]:
            allowed = "there once: the same task finds the same path; give it another seed"
            raise ArgumentError("members", task.label, allowed)
