"""``python -m benchmarks helicopter``: the paper's scenario once in pictures, and many times."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from rich.console import Console

from benchmarks.commands import Command, count, seed
from benchmarks.pieces import Say
from benchmarks.progress import FAILED, Queue
from benchmarks.scenario import procedure
from benchmarks.scenario.example import draw_example
from benchmarks.scenario.records import Record, kept
from benchmarks.scenario.report import draw_hits, markdown, notes, terminal_tables
from benchmarks.scenario.working import finished
from benchmarks.sessions import log, teller

COMMAND = Command("helicopter", "pair", full={"pairs": 200}, quick={"pairs": 8})


def main(argv: Sequence[str]) -> int:
    """Do what has not been done yet, then report.

    Returns:
        0; 1 if a pair failed or worker processes died for good; 2 for wrong use; 130 after Ctrl-C,
        when everything finished is kept.
    """
    return COMMAND.run(partial(_session, _options(argv)))


def _session(options: argparse.Namespace, out: Console, err: Console) -> int:
    done = _kept(options, teller(err))
    options.output.mkdir(parents=True, exist_ok=True)
    log(options.output, options)
    _carry_out(options, done, err)
    records = list(_kept(options).values())
    _report(records, options.output, out)
    if not options.no_example:
        err.print("drawing the example's figures 4 and 5")
        draw_example(options.output, out, places=options.places)
    return 1 if any(record["status"] == FAILED for record in records) else 0


def _kept(options: argparse.Namespace, say: Say = lambda _message: None) -> dict[int, Record]:
    return kept(options.output, options.seed, options.pairs, options.places, say=say)


def _carry_out(options: argparse.Namespace, done: dict[int, Record], err: Console) -> None:
    """Evaluate the pairs that are left, and tell of each as it comes."""
    say = teller(err)
    statuses = {number: record["status"] for number, record in done.items()}
    queue = Queue("pair", options.pairs, statuses, again=options.retry_failed, say=say)
    records = finished(
        options.output, options.seed, queue.left, options.places, workers=options.workers, say=say
    )
    for record in records:
        failed = record["status"] == FAILED
        queue.tell(record["pair"], record["status"], record["reason"] if failed else "")


def _report(records: list[Record], folder: Path, out: Console) -> None:
    for note in notes(records):
        out.print(note, markup=False, soft_wrap=True)
    for table in terminal_tables(records):
        out.print(table)
    (folder / "report.md").write_text(markdown(records), encoding="utf-8")
    draw_hits(records, folder / "hits.png")
    out.print(f"in {folder}: report.md, hits.png, pairs/", markup=False, soft_wrap=True)


def _options(argv: Sequence[str]) -> argparse.Namespace:
    parser = COMMAND.parser(
        "Five helicopter flights of equal time over Jacksboro, for many pairs of start and goal: "
        "how often what the paper found holds."
    )
    parser.add_argument("--pairs", type=count, help=COMMAND.sizes("pairs"))
    parser.add_argument("--quick", action="store_true", help="few pairs, in a minute or two")
    parser.add_argument("--seed", type=seed, default=0, help="of the pairs (%(default)s)")
    COMMAND.add_workers(parser)
    parser.add_argument(
        "--places", type=count, default=procedure.PLACES, metavar="N",
        help="of a roadmap (%(default)s); with any other number it is another procedure, which "
        "needs another folder",
    )  # fmt: skip
    COMMAND.add_kept(parser)
    parser.add_argument("--no-example", action="store_true", help="without figures 4 and 5")
    return COMMAND.parsed(parser, argv)
