"""``python -m benchmarks [--quick] [--only NAME] [--seed N] [--output FILE.json]``.

Exit code 0 unless a figure of correctness is wrong: speed depends on the machine and on what else
runs on it, so targets of speed that are missed are shown and do not fail the run.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict
from datetime import datetime, timezone
from pathlib import Path

from rich.console import Console

from benchmarks import environment, report
from benchmarks.metric import Metric
from benchmarks.registry import BENCHMARKS


def main(arguments: Sequence[str] | None = None) -> int:
    """Run benchmarks, print their tables, and say whether all figures of correctness hold."""
    options = _parser().parse_args(arguments)
    started, begin = datetime.now(timezone.utc), time.monotonic()
    # a table that nobody looks at in a terminal need not squeeze into 80 columns
    console = Console(width=None if sys.stdout.isatty() else 130)
    progress = Console(stderr=True, highlight=False)
    machine = environment.machine()
    results: dict[str, list[Metric]] = {}
    names = list(dict.fromkeys(options.only or BENCHMARKS))
    configurations = {
        name: BENCHMARKS[name].quick if options.quick else BENCHMARKS[name].full for name in names
    }
    for name, config in configurations.items():

        def say(step: str, name: str = name) -> None:
            progress.print(f"{time.monotonic() - begin:6.1f} s  {name}: {step}", style="dim")

        results[name] = list(BENCHMARKS[name].measure(config, options.seed, say))
        console.print(report.table(name, results[name]))
        for note in report.notes(results[name]):
            console.print(f"  {note}", style="dim", highlight=False)
    if options.output:
        text = report.document(
            results,
            started=started.isoformat(timespec="seconds"),
            seconds=round(time.monotonic() - begin, 1),
            mode="quick" if options.quick else "full",
            seed=options.seed,
            machine=machine | {"load_after": environment.load()},
            versions=environment.versions(),
            configuration={name: asdict(config) for name, config in configurations.items()},
        )
        options.output.write_text(text, encoding="utf-8")
    return _summary(console, [metric for each in results.values() for metric in each])


def _summary(console: Console, metrics: Sequence[Metric]) -> int:
    failed = [metric.name for metric in metrics if metric.failed]
    missed = [metric.name for metric in metrics if metric.met is False and not metric.failed]
    if missed:
        console.print(f"targets of speed not met: {'; '.join(missed)}", style="yellow")
    if failed:
        console.print(f"figures that are wrong: {'; '.join(failed)}", style="bold red")
    return 1 if failed else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m benchmarks", description="Measure the library beside its peers."
    )
    parser.add_argument("--quick", action="store_true", help="smaller; takes under a minute")
    parser.add_argument(
        "--only", action="append", choices=list(BENCHMARKS), metavar="NAME",
        help=f"one of {', '.join(BENCHMARKS)}; may be repeated",
    )  # fmt: skip
    parser.add_argument("--seed", type=_seed, default=0, help="of all random numbers (0)")
    parser.add_argument("--output", type=_new_file, metavar="FILE.json", help="write figures here")
    return parser


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number from 0")
    return int(text)


def _new_file(text: str) -> Path:
    """A path that can be written, found out before minutes are spent."""
    path = Path(text)
    if not path.parent.is_dir() or path.is_dir():
        raise argparse.ArgumentTypeError(f"{text!r}: must be a file in a folder that exists")
    return path


if __name__ == "__main__":
    sys.exit(main())
