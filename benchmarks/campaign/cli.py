"""``python -m benchmarks objectives``: run the campaign, or what is left of it, and report."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import joblib
from rich.console import Console

from benchmarks.campaign import planners
from benchmarks.campaign.objectives import OBJECTIVES
from benchmarks.campaign.output import write_all
from benchmarks.campaign.processes import finished
from benchmarks.campaign.progress import Monitor
from benchmarks.campaign.report import EXPLAINED, notes, winner_tables
from benchmarks.campaign.run import Run, code, runs
from benchmarks.campaign.scenes import SCENES
from benchmarks.campaign.store import Store
from benchmarks.campaign.table import row
from benchmarks.commands import Command, count
from benchmarks.sessions import facts

GRACE = 300.0
"""Seconds beyond its own after which a run is given up: the first one compiles everything."""
COMMAND = Command(
    "objectives",
    "run",
    full={
        "seconds": 5.0,
        "seeds": 5,
        "scenes": list(SCENES),
        "objectives": list(OBJECTIVES),
    },
    quick={
        "seconds": 1.0,
        "seeds": 2,
        "scenes": ["jacksboro", "circles"],
        "objectives": ["length", "H1", "clearance", "time+risk"],
    },
)


def main(argv: Sequence[str]) -> int:
    """Run what has not been run yet, and write tables, figures, logs and the database.

    Args:
        argv: arguments after the command's name.

    Returns:
        0; 1 if a run failed; 2 for wrong use; 130 after Ctrl-C, when everything finished is kept.
    """
    return COMMAND.run(partial(_session, _options(argv)))


def _session(options: argparse.Namespace, out: Console, err: Console) -> int:
    with Store(options.output) as store:
        store.check(options.seconds)
        return _campaign(store, options, out, err)


def _campaign(store: Store, options: argparse.Namespace, out: Console, err: Console) -> int:
    able, messages = planners.available()
    for message in messages:
        err.print(message, style="yellow", markup=False)
    names = [name for name in options.planners if name in able]
    wanted = runs(options.scenes, options.objectives, names, options.seeds, options.seconds)
    left = [run for run in wanted if not _is_done(store, run, options.retry_failed)]
    store.log_session({**facts(options), "code": code()})
    _carry_out(store, left, len(wanted), options.workers, err)
    if not store.records:
        err.print("nothing to report: no planner can run")
        return 1
    made = write_all(store, [row(each) for each in store.records.values()])
    _summarise(store, made, out)
    return 1 if any(e["result"]["status"] == "failed" for e in store.records.values()) else 0


def _carry_out(store: Store, left: list[Run], total: int, workers: int, err: Console) -> None:
    with Monitor(err, total, total - len(left)) as monitor:
        for run, result in finished(left, workers=workers, grace=GRACE):
            store.add(run, result)
            monitor.tell(run, result)


def _is_done(store: Store, run: Run, retry_failed: bool) -> bool:
    record = store.records.get(run.identity)
    if record is None:
        return False
    return not (retry_failed and record["result"]["status"] == "failed")


def _summarise(store: Store, made: Sequence[str], out: Console) -> None:
    rows = [row(each) for each in store.records.values()]
    for table in winner_tables(rows):
        out.print(table)
        out.print()
    out.print(EXPLAINED, style="dim")
    for note in notes(rows):
        out.print(note, markup=False, soft_wrap=True)
    out.print(f"in {store.folder}: {', '.join(made)}", markup=False, soft_wrap=True)


def _options(argv: Sequence[str]) -> argparse.Namespace:
    parser = _parser()
    options = COMMAND.parsed(parser, argv)
    processors = joblib.cpu_count()
    if options.workers > processors:
        parser.error(
            f"argument --workers: {options.workers} of them on {processors} processors would "
            "take each other's time"
        )
    return options


def _parser() -> argparse.ArgumentParser:
    parser = COMMAND.parser(
        "Compare objectives: every objective, planner, scene and seed in a run of its own."
    )
    parser.add_argument("--quick", action="store_true", help="a small campaign, in a few minutes")
    parser.add_argument(
        "--output", type=Path, metavar="FOLDER", help="where to keep it (runs/objectives)"
    )
    parser.add_argument(
        "--seconds", type=_seconds, metavar="S",
        help=f"processor time of each run {COMMAND.sizes('seconds')}",
    )  # fmt: skip
    parser.add_argument("--seeds", type=count, metavar="N", help=COMMAND.sizes("seeds"))
    for what, known in (
        ("scenes", SCENES), ("planners", planners.PLANNERS), ("objectives", OBJECTIVES)
    ):  # fmt: skip
        parser.add_argument(
            f"--{what}", nargs="+", choices=list(known), metavar="NAME",
            help=f"some of {', '.join(known)}",
        )  # fmt: skip
    parser.set_defaults(planners=list(planners.PLANNERS))
    parser.add_argument(
        "--workers", type=count, default=min(2, joblib.cpu_count()), metavar="N",
        help="processes at a time (%(default)s); time is processor time, but memory is shared",
    )  # fmt: skip
    parser.add_argument(
        "--retry-failed", action="store_true", help="run those again that failed or crashed"
    )
    return parser


def _seconds(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r}: must be a positive number of seconds")
    return value
