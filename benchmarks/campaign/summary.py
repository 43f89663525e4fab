"""Which objective wins which metric, where and by whom."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.campaign.metrics import BOUNDS, METRICS, Metric
from benchmarks.campaign.objectives import OBJECTIVES
from benchmarks.campaign.planners import PLANNERS
from benchmarks.campaign.scenes import SCENES
from benchmarks.campaign.table import Row
from benchmarks.metric import Spread


@dataclass(frozen=True)
class Standing:
    """A metric of the paths that one planner finds for one objective in one scene.

    Attributes:
        scene, planner, objective, metric: their names.
        runs: how many.
        solved: how many of them found a sound path.
        spread: median and quartiles over all runs; one without a path counts as the worst value,
            so that an objective gains nothing by failing where paths are bad.
        bounds: of a probability, medians over the runs with a path; None for other metrics.
    """

    scene: str
    planner: str
    objective: str
    metric: str
    runs: int
    solved: int
    spread: Spread
    bounds: tuple[float, float] | None = None

    @property
    def order(self) -> float:
        """Less is better; inf where half of the runs have no path."""
        return self.spread.median * (1.0 if METRICS[self.metric].better == "lower" else -1.0)


@dataclass(frozen=True)
class Verdict:
    """The winner of a metric, for one planner in one scene.

    Attributes:
        winner: whose median is best; None if nobody has a path in half of the runs.
        equals: objectives whose median lies within the quartiles of the winner, best first.
    """

    winner: Standing | None
    equals: tuple[Standing, ...] = ()


def standings(rows: Sequence[Row]) -> list[Standing]:
    """All of them, in the order of scenes, planners, objectives and metrics."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for each in rows:
        groups.setdefault((each["scene"], each["planner"], each["objective"]), []).append(each)
    return [
        _standing(scene, planner, objective, metric, group)
        for scene, planner, objective in present(groups)
        for metric in METRICS
        for group in [groups[scene, planner, objective]]
    ]


def present(groups: Iterable[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
    """Scenes, planners and objectives in the order in which the campaign names them."""
    orders = [list(names) for names in (SCENES, PLANNERS, OBJECTIVES)]
    return sorted(
        groups, key=lambda group: [names.index(n) for names, n in zip(orders, group, strict=True)]
    )


def verdict(group: Sequence[Standing]) -> Verdict:
    """The winner among objectives; the group differs in nothing else."""
    ranked = sorted((each for each in group if each.order < math.inf), key=lambda s: s.order)
    if not ranked:
        return Verdict(None)
    winner, *others = ranked
    low, high = winner.spread.low, winner.spread.high
    equals = tuple(each for each in others if low <= each.spread.median <= high)
    return Verdict(winner, equals)


def verdicts(all_standings: Sequence[Standing]) -> dict[tuple[str, str, str], Verdict]:
    """Verdicts by scene, metric and planner."""
    groups: dict[tuple[str, str, str], list[Standing]] = {}
    for each in all_standings:
        groups.setdefault((each.scene, each.metric, each.planner), []).append(each)
    return {group: verdict(members) for group, members in groups.items()}


def summary_rows(all_standings: Sequence[Standing]) -> list[dict[str, Any]]:
    """Every standing as a row, the winners marked."""
    found = verdicts(all_standings)
    rows = []
    for each in all_standings:
        judged = found[each.scene, each.metric, each.planner]
        rows.append(
            {
                "scene": each.scene,
                "planner": each.planner,
                "metric": each.metric,
                "unit": METRICS[each.metric].unit,
                "objective": each.objective,
                "median": _finite(each.spread.median),
                "lower quartile": _finite(each.spread.low),
                "upper quartile": _finite(each.spread.high),
                "lower bound": None if each.bounds is None else each.bounds[0],
                "upper bound": None if each.bounds is None else each.bounds[1],
                "solved": each.solved,
                "runs": each.runs,
                "wins": each == judged.winner,
                "equal to the winner": each in judged.equals,
            }
        )
    return rows


def _standing(
    scene: str, planner: str, objective: str, name: str, group: Sequence[Row]
) -> Standing:
    metric: Metric = METRICS[name]
    values = [metric.worst if each[name] is None else each[name] for each in group]
    solved = sum(each["status"] == "solved" for each in group)
    spread = Spread.of(values)
    return Standing(
        scene, planner, objective, name, len(group), solved, spread, _bounds(name, group)
    )


def _bounds(name: str, group: Sequence[Row]) -> tuple[float, float] | None:
    ends = [
        [each[f"{name} {end}"] for each in group if each[name] is not None]
        for end in ("low", "high")
        if f"{name} {end}" in BOUNDS
    ]
    return (Spread.of(ends[0]).median, Spread.of(ends[1]).median) if ends and ends[0] else None


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
