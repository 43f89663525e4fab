"""Tasks that between them find paths of different kinds."""

from __future__ import annotations

from collections.abc import Sequence

from ompl_risk._arrays import positive
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.criteria import parse_criterion
from ompl_risk.planners.methods import ALIASES, METHODS, method_of
from ompl_risk.planners.task import Task

SEARCHES = (
    "length", "InformedRRTstar:length", "RRTstar:length",
    "L1@10", "L2@10", "H1@10", "L1@20", "L2@20", "H1@20", "L4@20", "H1@30",
)  # fmt: skip
"""Searches that find both short and safe ways of little more than the least duration."""

PLANNER = "BITstar"
"""The planner of a search that names none: for the costs of risk, it finds good paths soonest."""

CRITERION = "length"
"""The criterion of a search that names only a planner."""


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
        searches: criteria (see `parse_criterion`), by `PLANNER`; planners (see `method_of`), by
            `CRITERION`; or "planner:criterion".
        runs: how often each is run.
        seed: of the first task, at least 1; the following count up from it.
        effort: factor on the planners' usual iterations.
        time_limit: most seconds for a task [s].

    Raises:
        ArgumentError: an unknown name, a planner that would hang or crash with the criterion, or a
            number out of range.
    """
    if not isinstance(runs, int) or runs < 1:
        raise ArgumentError("runs", runs, "a whole number of at least 1")
    searches = [searches] if isinstance(searches, str) else list(searches)
    if not searches:
        raise ArgumentError("searches", searches, "at least one")
    return [
        parse_task(search, seed=seed + k, effort=effort, time_limit=time_limit, argument="searches")
        for k, search in enumerate(searches * runs)
    ]


def parse_task(
    text: str,
    *,
    seed: int = 1,
    effort: float = 1.0,
    time_limit: float = 60.0,
    argument: str = "search",
) -> Task:
    """The task of a search.

    Args:
        text: such as "H1@20", "RRTConnect" or "BITstar:H1@20", see `menu`.
        seed: of the task.
        effort: factor on the planner's usual iterations.
        time_limit: most seconds [s].
        argument: what the caller calls the text in errors.

    Raises:
        ArgumentError: as `menu`.

    Example:
        >>> parse_task("RRTstar:H1@20", seed=3).label
        'RRTstar H1@20 seed 3'
    """
    effort = positive("effort", effort)
    planner, criterion = _parts(text, argument)
    method = method_of(planner, argument=argument)
    minimised = parse_criterion(criterion, argument=argument)
    method.check(minimised, argument)
    return Task(planner, minimised, seed, max(1, round(effort * method.iterations)), time_limit)


def _parts(text: str, argument: str) -> tuple[str, str]:
    """Planner and criterion."""
    if not isinstance(text, str):
        raise ArgumentError(argument, text, 'a text such as "BITstar:H1@20"')
    planner, colon, criterion = (part.strip() for part in text.rpartition(":"))
    if colon:
        return planner, criterion
    if "@" in text or criterion.lower() == CRITERION:
        return PLANNER, criterion
    if criterion in METHODS or criterion in ALIASES or "." in criterion:
        return criterion, CRITERION
    names = ", ".join([*METHODS, *ALIASES])
    allowed = f'a criterion such as "H1@20" or "length", a planner ({names}), or planner:criterion'
    raise ArgumentError(argument, text, allowed)
