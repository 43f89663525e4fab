"""The Pareto set of duration and risk: table, file and figure."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from rich import box
from rich.table import Table

from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.norms import Norm
from ompl_risk.planners.roadmap.exploring import Front
from ompl_risk.planners.roadmap.roadmap import Route
from ompl_risk.trajectory import Trajectory
from ompl_risk.trajectory_files import write_csv

if TYPE_CHECKING:
    from rich.console import Console

ROWS = 8
"""Rows of the table: more than that nobody reads."""


def write_pareto(
    front: Front,
    norm: Norm,
    unit: str,
    trajectory: Callable[[Route, str], Trajectory],
    folder: RunFolder,
    console: Console,
) -> None:
    """Print some of the set, write all of it: pareto.csv, pareto.png, and the paths in pareto/.

    Args:
        front: the set.
        norm: by which risk is counted.
        unit: of the avoidance function.
        trajectory: what a route of a name is written as.
        folder: where to write.
        console: where to print.
    """
    from ompl_risk.report.pareto import pareto_figure

    norms = [norm_of(route, norm) for route in front.routes]
    durations = [route.duration for route in front.routes]
    path = folder.path / "pareto.csv"
    with path.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["path", "duration_s", norm.label])
        rows.writerows(
            [k + 1, repr(t), repr(value)]
            for k, (t, value) in enumerate(zip(durations, norms, strict=True))
        )
    paths = folder.made("pareto")
    for k, route in enumerate(front.routes):
        name = f"{k + 1:04d}"
        write_csv(paths / f"{name}.csv", trajectory(route, name))
    pareto_figure(durations, norms, norm, folder.path / "pareto.png", unit=unit)
    console.print(_table(durations, norms, norm))
    console.print(
        f"{len(norms)} paths that no other undercuts in both: pareto.csv, pareto.png, pareto/",
        highlight=False,
    )


def norm_of(route: Route, norm: Norm) -> float:
    """The norm from its power."""
    return route.risk if norm.exponent == float("inf") else route.risk ** (1.0 / norm.exponent)


def _table(durations: Sequence[float], norms: Sequence[float], norm: Norm) -> Table:
    table = Table(
        title="Pareto set of duration and risk", title_justify="left", box=box.SIMPLE_HEAD
    )
    for heading in ("path", "duration", "longer by", norm.label, "less risk by"):
        table.add_column(heading, justify="right")
    n = len(norms)
    shown = sorted({round(k * (n - 1) / max(1, ROWS - 1)) for k in range(ROWS)}) if n else []
    for k in shown:
        saved = 1.0 - norms[k] / norms[0] if norms[0] > 0.0 else 0.0
        table.add_row(
            str(k + 1),
            f"{durations[k]:.1f} s",
            f"{100.0 * (durations[k] / durations[0] - 1.0):.1f} %",
            f"{norms[k]:.4g}",
            f"{100.0 * saved:.1f} %",
        )
    return table
