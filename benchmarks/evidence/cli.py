"""``python -m benchmarks evidence``: which norm predicts collisions in a closed loop."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from rich.console import Console

from benchmarks.commands import Command, count, seed
from benchmarks.evidence.engines import Dask, Engine, Local, Lost
from benchmarks.evidence.settings import ROLLOUTS, Settings
from benchmarks.evidence.store import NAME, Kept, compact, keep, kept
from benchmarks.evidence.unit import COMPLETE, evaluate, failed
from benchmarks.progress import FAILED, Queue
from benchmarks.sessions import log, teller
from ompl_risk.errors import FileError

COMMAND = Command(
    "evidence", "unit",
    full={"units": 520, "rollouts": ROLLOUTS}, quick={"units": 10, "rollouts": 100},
)  # fmt: skip


def main(argv: Sequence[str]) -> int:
    """Do what has not been done yet, then report.

    Returns:
        0; 1 if a unit failed, or workers died or went away for good; 2 for wrong use; 130 after
        Ctrl-C, when everything finished is kept.
    """
    return COMMAND.run(partial(_session, _options(argv)))


def _session(options: argparse.Namespace, out: Console, err: Console) -> int:
    settings = Settings(options.seed, options.rollouts)
    if options.report_only:
        _report(_compacted(options.output, settings), options.output, out)
        return 0
    engine = _engine(options)
    done = kept(options.output, settings, options.units, say=teller(err))
    options.output.mkdir(parents=True, exist_ok=True)
    log(options.output, options)
    _carry_out(engine, settings, options, done, err)
    ended = kept(options.output, settings, options.units)
    _tell(ended, err)
    if any(unit.status == COMPLETE for unit in ended.values()):
        _report(compact(options.output, settings), options.output, out)
    else:
        err.print("no unit is complete, so there is nothing to report")
    return 1 if any(unit.status == FAILED for unit in ended.values()) else 0


def _engine(options: argparse.Namespace) -> Engine:
    if options.engine == "dask":
        return Dask(options.workers, options.scheduler)
    return Local(options.workers)


def _carry_out(
    engine: Engine,
    settings: Settings,
    options: argparse.Namespace,
    done: dict[int, Kept],
    err: Console,
) -> None:
    """Work on the units that are left, keep each as it comes, and tell of it."""
    say = teller(err)
    statuses = {number: unit.status for number, unit in done.items()}
    queue = Queue("unit", options.units, statuses, again=options.retry_failed, say=say)
    for number, found in engine.run(partial(evaluate, settings), queue.left, say):
        unit = failed(settings, number, found.reason) if isinstance(found, Lost) else found
        keep(options.output, unit)
        queue.tell(number, unit.status, unit.reason)


def _tell(ended: dict[int, Kept], err: Console) -> None:
    """How many ended how, and whether one code made them all."""
    statuses = Counter(unit.status for unit in ended.values())
    counts = ", ".join(f"{number} {status}" for status, number in sorted(statuses.items()))
    err.print(f"{len(ended)} units: {counts}")
    codes = {unit.code for unit in ended.values()}
    if len(codes) > 1:
        err.print(f"note: they were made by {len(codes)} versions of the code")


def _compacted(folder: Path, settings: Settings) -> Path:
    """The file to report on: of the units, or as it is where there are none."""
    if (folder / "units").is_dir():
        return compact(folder, settings)
    if not (folder / NAME).is_file():
        raise FileError(folder, f"has neither units nor {NAME}", "let the campaign run first")
    return folder / NAME


def _report(parquet: Path, folder: Path, out: Console) -> None:
    from benchmarks.evidence.analysis import report

    out.print(f"{parquet}: {parquet.stat().st_size / 1e6:.1f} MB", markup=False, soft_wrap=True)
    report(parquet, folder, out)


def _options(argv: Sequence[str]) -> argparse.Namespace:
    parser = COMMAND.parser(
        "Many sets of five helicopter flights of equal time, each flown again and again in wind "
        "and error: which norm finds the safest."
    )
    parser.add_argument(
        "--units", type=count, metavar="N",
        help=f"pairs of start and goal, each a set in every level {COMMAND.sizes('units')}",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="few units with few rollouts")
    parser.add_argument("--seed", type=seed, default=0, help="of everything (%(default)s)")
    parser.add_argument(
        "--rollouts", type=count, metavar="N",
        help=f"of each flight in each level {COMMAND.sizes('rollouts')}; with another number it is "
        "another procedure, which needs another folder",
    )  # fmt: skip
    COMMAND.add_workers(parser)
    parser.add_argument(
        "--engine", choices=("joblib", "dask"), default="joblib", help="(%(default)s)"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS",
        help="of a Dask cluster, such as tcp://host:8786; a local one is started if left out",
    )  # fmt: skip
    COMMAND.add_kept(parser)
    parser.add_argument("--report-only", action="store_true", help="report on what is there")
    options = COMMAND.parsed(parser, argv)
    if options.scheduler and options.engine != "dask":
        parser.error(f"argument --scheduler: {options.scheduler}: only with --engine dask")
    return options
