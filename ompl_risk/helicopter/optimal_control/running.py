"""All manoeuvres of a library, one after the other, and what became of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from ompl_risk.helicopter.library_file import write_library
from ompl_risk.helicopter.optimal_control.making import Made, make
from ompl_risk.helicopter.optimal_control.settings import Settings
from ompl_risk.helicopter.optimal_control.store import Store
from ompl_risk.helicopter.optimal_control.task import Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle
from ompl_risk.helicopter.primitives import replay


class Row(NamedTuple):
    """A task, and the manoeuvre that was made for it."""

    task: Task
    made: Made


def chosen(tasks: Sequence[Task], only: Sequence[str]) -> list[Task]:
    """The tasks whose name has one of these texts, from the beginning of a word; or all of them."""
    return [t for t in tasks if not only or any(f" {text}" in f" {t.name}" for text in only)]


def make_all(tasks: Sequence[Task], vehicle: Vehicle, store: Store, console: Console) -> list[Row]:
    """Make manoeuvres, or take them from the store, with a bar that shows how far it is."""
    rows: list[Row] = []
    with _bar(console) as bar:
        track = bar.add_task("", total=len(tasks))
        for task in tasks:
            bar.update(track, description=task.name)
            rows.append(Row(task, _made(task, vehicle, store)))
            bar.advance(track)
    return rows


def write(path: Path, settings: Settings, rows: Sequence[Row]) -> None:
    """Write the library.

    Raises:
        FileError: it cannot be written.
    """
    vehicle, grid = settings
    write_library(
        path,
        vehicle.helicopter,
        vehicle.limits,
        vehicle.dt,
        grid.speeds,
        grid.turns,
        [grid.climbs_at(speed) for speed in grid.speeds],
        [(row.task.first.key, row.task.last.key, row.made.controls) for row in rows],
    )


def table_of(rows: Sequence[Row], vehicle: Vehicle) -> Table:
    """What the manoeuvres do."""
    table = Table(box=None, header_style="bold", pad_edge=False)
    table.add_column("manoeuvre", no_wrap=True)
    heads = ("duration [s]", "rounded up by [s]", "x [m]", "y [m]", "z [m]", "heading [deg]")
    for head in (*heads, "lowest [m]", "highest [m]", "error at the end"):
        table.add_column(head, justify="right")
    for row in rows:
        table.add_row(row.task.name, *_figures(row, vehicle))
    return table


def _figures(row: Row, vehicle: Vehicle) -> Iterator[str]:
    task, made = row
    flown = replay(vehicle.helicopter, task.first, task.last, made.controls, dt=vehicle.dt)
    x, y, z, heading = flown.displacement.tolist()
    yield f"{flown.duration:.2f}"
    yield f"{flown.duration - made.least:.4f}"
    yield from (f"{value + 0.0:.3f}" for value in np.round([x, y, z], 3).tolist())
    yield f"{np.degrees(heading):.2f}"
    yield from (f"{edge(flown.track[:, 2]):.3f}" for edge in (np.min, np.max))
    yield f"{made.error:.1e}"


def _made(task: Task, vehicle: Vehicle, store: Store) -> Made:
    made = store.find(task, vehicle)
    if made is None:
        made = make(task, vehicle)
        store.keep(task, vehicle, made)
    return made


def _bar(console: Console) -> Progress:
    columns = (BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, TextColumn("{task.description}"), console=console)
