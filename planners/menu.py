"""Tasks that between them find paths of different kinds."""

from __future__ import annotations

from collections.abc import Sequence

from ompl_risk._arrays import positive
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.criteria import parse_criterion
from ompl_risk.planners.task import ITERATIONS, Task

SEARCHES = (
    "length", "InformedRRTstar:length", "RRTstar:length",
    "L1@10", "L2@10", "H1@10", "L1@20", "L2@20", "H1@20", "L4@20", "H1@30",
)  # fmt: skip
"""Searches that find both short and safe ways of little more than the least duration."""

PLANNER = "BITstar"
"""The planner of a search that names none: for the costs of risk, it finds good paths soonest."""


def menu(
    searches: Sequence[str] = SEARCHES,
    *,
    runs: int = 2,
    seed: int = 1,
    effort: float = 1.0,
    time_limit: float = 20.0,
) -> list[Task]:
    """Every search, `runs` times, each time with a seed of its own.

    Args:
        searches: criteria (see `parse_criterion`), by `PLANNER`, or "planner:criterion" with a
            planner of `ITERATIONS`.
        runs: how often each is run.
        seed: of the first task, at least 1; the following count up from it.
        effort: factor on the planners' usual iterations.
        time_limit: most seconds for a task [s].

    Raises:
        ArgumentError: an unknown name or a number out of range.
    """
    effort = positive("effort", effort)
    if not isinstance(runs, int) or runs < 1:
        raise ArgumentError("runs", runs, "a whole number of at least 1")
    if not searches:
        raise ArgumentError("searches", list(searches), "at least one")
    tasks: list[Task] = []
    for search in list(searches) * runs:
        planner, _, criterion = search.rpartition(":")
        planner = planner or PLANNER
        if planner not in ITERATIONS:
            allowed = f"a criterion, or planner:criterion by one of {', '.join(ITERATIONS)}"
            raise ArgumentError("searches", search, allowed)
        iterations = max(1, round(effort * ITERATIONS[planner]))
        what = parse_criterion(criterion, argument="searches")
        tasks.append(Task(planner, what, seed + len(tasks), iterations, time_limit))
    return tasks
