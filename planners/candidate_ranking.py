"""A ranking of candidates that loses none of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ompl_risk.errors import PlanningError
from ompl_risk.norms import Norm
from ompl_risk.planners.problem import Problem
from ompl_risk.planners.task import Candidate
from ompl_risk.ranking import DEFAULT_NORMS, Ranking, rank


@dataclass(frozen=True, eq=False, repr=False)
class CandidateRanking(Ranking):
    """A ranking of candidates; made by `rank_candidates`.

    Args:
        candidates: all of them, in the order of the tasks.
    """

    candidates: tuple[Candidate, ...] = ()

    @property
    def unsolved(self) -> tuple[Candidate, ...]:
        """The candidates without a path; `status` and `reason` say why."""
        return tuple(c for c in self.candidates if not c.solved)

    @cached_property
    def by_name(self) -> dict[str, Candidate]:
        """The candidates that are ranked, by the names of their trajectories."""
        solved = [c for c in self.candidates if c.solved]
        return dict(zip((a.name for a in self.assessments), solved, strict=True))

    @property
    def summary(self) -> str:
        """How many were ranked, and what became of each of the others."""
        return _summary(self.candidates)


def rank_candidates(
    problem: Problem,
    found: Sequence[Candidate],
    norms: Iterable[Norm] = DEFAULT_NORMS,
    **options: Any,
) -> CandidateRanking:
    """Rank candidates by `ompl_risk.rank`, from their paths alone.

    Args:
        problem: whose clearance, avoidance function and speed count.
        found: candidates, from `Portfolio.solve` or `candidates`.
        norms: to rank by.
        options: of `ompl_risk.rank`.

    Returns:
        The ranking of those with a path, named by the labels of their tasks; `unsolved` has the
        others.

    Raises:
        ArgumentError: as `ompl_risk.rank`.
        PlanningError: there is no path to rank.
    """
    solved = [c for c in found if c.solved]
    if not solved:
        raise PlanningError(_summary(found), "look at status and reason of each candidate")
    names = _distinct([c.task.label for c in solved])
    paths = [c.trajectory(problem.speed, name) for c, name in zip(solved, names, strict=True)]
    ranking = rank(paths, problem.clearance, problem.avoidance, norms, **options)
    return CandidateRanking(
        ranking.assessments,
        ranking.norms,
        ranking.duration_tolerance,
        ranking.avoidance,
        tuple(found),
    )


def _summary(found: Sequence[Candidate]) -> str:
    unsolved = [c for c in found if not c.solved]
    lines = [f"{len(found) - len(unsolved)} of {len(found)} tasks found a path"]
    lines += [f"{c.task.label}: {c.status.value}, {c.reason}" for c in unsolved]
    return "; ".join(lines)


def _distinct(labels: Sequence[str]) -> list[str]:
    """Labels with a number behind those that repeat: tasks may differ in their budget alone."""
    names: list[str] = []
    for label in labels:
        repeats = sum(name.partition(" #")[0] == label for name in names)
        names.append(f"{label} #{repeats + 1}" if repeats else label)
    return names
