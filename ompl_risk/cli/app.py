"""The commands and their options; what they do is elsewhere, and imported when it is needed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter
from cyclopts.config import Dict
from rich.console import Console

from ompl_risk import __version__
from ompl_risk.cli.settings import JudgeSettings, PlanSettings


def make_app(console: Console, config: Mapping[str, Any], source: str) -> App:
    """The command-line application.

    Args:
        console: where it writes.
        config: options of the command by name, for those that are not on the command line.
        source: where the configuration comes from, for errors.
    """
    app = App(
        name="ompl-risk",
        help="Rank motion plans by their risk of collision.",
        version=__version__,
        console=console,
        suppress_keyboard_interrupt=False,
        default_parameter=Parameter(negative=(), consume_multiple=True),
        config=(Dict(dict(config), source=source, use_commands_as_keys=False),),
    )
    commands = Commands(console)
    for command in (commands.plan, commands.rank, commands.table1, commands.doctor):
        app.command(command)
    return app


class Commands:
    """The commands; each returns the exit code.

    Args:
        console: where they write.
    """

    def __init__(self, console: Console) -> None:
        self._console = console

    def plan(
        self,
        *,
        settings: Annotated[PlanSettings, Parameter(name="*")] = PlanSettings(),  # noqa: B008
        config: Path | None = None,  # noqa: ARG002 - read before parsing
    ) -> int:
        """Plan paths of equal time over terrain with OMPL, and rank them by risk.

        Without options: five paths of 15 km across a range of mountains, on real terrain.

        Args:
            settings: what is planned.
            config: TOML file with any of these options; the command line wins.
        """
        from ompl_risk.cli.planning import plan

        plan(settings, self._console)
        return 0

    def rank(
        self,
        terrain: str,
        files: tuple[Path, ...],
        *,
        settings: Annotated[JudgeSettings, Parameter(name="*")] = JudgeSettings(),  # noqa: B008
        config: Path | None = None,  # noqa: ARG002 - read before parsing
    ) -> int:
        """Rank trajectories from files over terrain, whoever planned them.

        Args:
            terrain: a name of the catalogue (jacksboro, hills, ridge_valley, canyon, fractal), or a
                GeoTIFF, ESRI ASCII grid, SRTM .hgt or NPZ file.
            files: two or more trajectories in the terrain's metres: .csv with a header t,x,y,z;
                .tum or .txt (timestamp tx ty tz qx qy qz qw); .npz with t and positions, or with a
                flight as plan --vehicle helicopter writes it, which --rollouts flies as it is.
            settings: how they are judged.
            config: TOML file with any of these options; the command line wins.
        """
        from ompl_risk.cli.ranking_files import rank_files

        rank_files(terrain, files, settings, self._console)
        return 0

    def table1(self, *, output: Path | None = None) -> int:
        """Compute Table I of the paper, and show it beside the printed one.

        Args:
            output: where to write a figure with the curves of Fig. 2 and the tables, if given.
        """
        from ompl_risk.table1 import table1

        table = table1()
        self._console.print(table)
        if output is not None:
            from ompl_risk.report import table1_figure

            table1_figure(table, output)
            self._console.print(f"Written to {output}", soft_wrap=True, markup=False)
        return 0

    def doctor(self) -> int:
        """Try the known traps of the OMPL that is installed; fails if ours to rely on is broken."""
        from ompl_risk.bridge.doctor import diagnose
        from ompl_risk.cli.progress import progress_bar

        with progress_bar(self._console) as progress:
            bar = progress.add_task("trying OMPL", total=None)
            diagnosis = diagnose(
                progress=lambda _row, done, total: progress.update(bar, completed=done, total=total)
            )
        self._console.print(diagnosis)
        return 0 if diagnosis.healthy else 1
