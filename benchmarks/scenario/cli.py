"""``python -m benchmarks helicopter``: the paper's scenario once in pictures, and many times."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

import joblib
from rich.console import Console

from benchmarks.scenario import procedure
from benchmarks.scenario.example import draw_example
from benchmarks.scenario.records import Record, kept
from benchmarks.scenario.report import draw_hits, markdown, notes, terminal_tables
from benchmarks.scenario.working import WorkersDiedError, finished
from benchmarks.sessions import Progress, complain, consoles, count, log, teller
from ompl_risk.errors import OmplRiskError

PAIRS, QUICK = 200, 8
GOES_ON = "every finished pair is kept, and the same command goes on from here"


def main(argv: Sequence[str]) -> int:
    """Do what has not been done yet, then report.

    Returns:
        0; 1 if a pair failed or worker processes died for good; 2 for wrong use; 130 after Ctrl-C,
        when everything finished is kept.
    """
    options = _options(argv)
    out, err = consoles()
    try:
        return _session(options, out, err)
    except KeyboardInterrupt:
        err.print(f"\nstopped; {GOES_ON}")
        return 130
    except WorkersDiedError as error:
        complain(err, f"{error}; {GOES_ON}")
        return 1
    except (OmplRiskError, OSError) as error:
        complain(err, str(error))
        return 2


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
    return 1 if any(record["status"] == "failed" for record in records) else 0


def _kept(
    options: argparse.Namespace, say: Callable[[str], object] = lambda _message: None
) -> dict[int, Record]:
    return kept(options.output, options.seed, options.pairs, options.places, say=say)


def _carry_out(options: argparse.Namespace, done: dict[int, Record], err: Console) -> None:
    """Evaluate the pairs that are left, and tell of each as it comes."""
    if options.retry_failed:
        done = {k: record for k, record in done.items() if record["status"] != "failed"}
    left = [number for number in range(options.pairs) if number not in done]
    if done:
        err.print(f"{len(done)} of {options.pairs} pairs were done before")
    say = teller(err)
    progress = Progress(say, options.pairs, len(done))
    records = finished(
        options.output, options.seed, left, options.places, workers=options.workers, say=say
    )
    for record in records:
        said = f": {record['reason']}" if record["status"] == "failed" else ""
        progress.tell(f"pair {record['pair']} {record['status']}{said}")


def _report(records: list[Record], folder: Path, out: Console) -> None:
    for note in notes(records):
        out.print(note, markup=False, soft_wrap=True)
    for table in terminal_tables(records):
        out.print(table)
    (folder / "report.md").write_text(markdown(records), encoding="utf-8")
    draw_hits(records, folder / "hits.png")
    out.print(f"in {folder}: report.md, hits.png, pairs/", markup=False, soft_wrap=True)


def _options(argv: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        "python -m benchmarks helicopter",
        description="Five helicopter flights of equal time over Jacksboro, for many pairs of start "
        "and goal: how often what the paper found holds. Start it again with the same command and "
        "it goes on where it was stopped.",
    )
    parser.add_argument("--pairs", type=count, help=f"({PAIRS}; quick {QUICK})")
    parser.add_argument("--quick", action="store_true", help="few pairs, in a minute or two")
    parser.add_argument("--seed", type=int, default=0, help="of the pairs (%(default)s)")
    parser.add_argument("--workers", type=count, default=joblib.cpu_count(), help="(%(default)s)")
    parser.add_argument(
        "--places", type=count, default=procedure.PLACES, metavar="N",
        help="of a roadmap (%(default)s); with any other number it is another procedure, which "
        "needs another folder",
    )  # fmt: skip
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="(runs/helicopter)")
    parser.add_argument("--retry-failed", action="store_true", help="do those again that failed")
    parser.add_argument("--no-example", action="store_true", help="without figures 4 and 5")
    options = parser.parse_args(argv)
    if options.pairs is None:
        options.pairs = QUICK if options.quick else PAIRS
    if options.output is None:
        options.output = Path("runs") / f"helicopter{'-quick' if options.quick else ''}"
    if options.seed < 0:
        parser.error(f"argument --seed: {options.seed}: must be 0 or more")
    return options
