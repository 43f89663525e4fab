"""The command line of ``python -m ompl_risk.helicopter.optimal_control``."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from cyclopts import App, CycloptsError, Parameter
from rich.console import Console

from ompl_risk.errors import ArgumentError, OmplRiskError
from ompl_risk.helicopter.optimal_control import running
from ompl_risk.helicopter.optimal_control.grid import Grid
from ompl_risk.helicopter.optimal_control.needs import casadi
from ompl_risk.helicopter.optimal_control.settings import (
    Settings,
    default_settings,
    read_settings,
)
from ompl_risk.helicopter.optimal_control.store import Store
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle

NAME = "python -m ompl_risk.helicopter.optimal_control"
INTERRUPTED = 130
"""The exit code of a process that Ctrl-C has ended, by convention."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        arguments: the command line without the program's name; that of the process if left out.

    Returns:
        The exit code: 0 if all went well, 1 after an error, 130 after Ctrl-C.
    """
    errors = Console(stderr=True)
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    app = App(
        name=NAME,
        console=Console(),
        version_flags=(),
        suppress_keyboard_interrupt=False,
        default_parameter=Parameter(negative=()),
    )
    app.default(manoeuvres)
    try:
        app(tokens, exit_on_error=False, print_error=False, result_action="return_value")
    except (CycloptsError, OmplRiskError) as error:
        line = " ".join(str(error).split())
        errors.print(f"{NAME}: {line}", soft_wrap=True, markup=False, highlight=False)
        return 1
    except KeyboardInterrupt:
        errors.print("stopped; run it again to go on", highlight=False)
        return INTERRUPTED
    return 0


def manoeuvres(
    *,
    output: Path = Path("primitives.npz"),
    settings: Path | None = None,
    only: tuple[str, ...] = (),
    work: Path = Path("runs/primitives"),
    show_settings: bool = False,
) -> None:
    """Make the manoeuvres of a helicopter by optimal control, as a file for PrimitiveLibrary.

    A manoeuvre leads from one steady flight into another in the least time that inputs, their
    rates, body rates, attitude and speed allow, with a tenth of each limit in reserve. Takes about
    a minute; if interrupted, the next run goes on where it was.

    Args:
        output: the file to write.
        settings: a TOML file with mass, inertia, limits, speeds, reserve and so on; the X-Cell 60
            without.
        only: make only manoeuvres with this text in their name, such as '10 m/s to 20', and write
            no library.
        work: folder in which manoeuvres are kept as they are made.
        show_settings: print the default settings as TOML, and do nothing else.
    """
    console = Console()
    if show_settings:
        console.print(default_settings(), end="", markup=False, highlight=False, soft_wrap=True)
        return
    casadi()
    given = Settings(Vehicle(), Grid()) if settings is None else read_settings(settings)
    tasks = running.chosen(given.grid.tasks(given.vehicle), only)
    if not tasks:
        raise ArgumentError("--only", list(only), "part of a name, such as '10 m/s to 20 m/s'")
    if not output.parent.is_dir():
        raise ArgumentError("--output", str(output), "a file in a folder that exists")
    rows = running.make_all(tasks, given.vehicle, Store(work), console)
    _wide(console).print(running.table_of(rows, given.vehicle))
    if not only:
        running.write(output, given, rows)
        console.print(f"{len(rows)} manoeuvres in {output}", highlight=False, markup=False)


def _wide(console: Console) -> Console:
    """A table that goes to a file or a pipe is not cut to the width of a terminal."""
    return console if console.is_terminal else Console(width=160)
