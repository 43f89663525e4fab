"""Runs benchmarks, prints their tables, and gathers what they measured."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone
from typing import Any, Literal

from rich.console import Console

from benchmarks import environment, report
from benchmarks.metric import Absent, Metric
from benchmarks.registry import Benchmark
from ompl_risk.cli.compiling import compilation_announced

Mode = Literal["full", "quick"]


@dataclass
class Measured:
    """What a run measured, and how.

    Attributes:
        mode: "full" or "quick".
        seed: of all random numbers.
        metrics: by benchmark.
        absent: peers that could not be asked, by benchmark.
        facts: machine, versions, configuration and time.
    """

    mode: Mode
    seed: int
    metrics: dict[str, list[Metric]] = field(default_factory=dict)
    absent: dict[str, list[Absent]] = field(default_factory=dict)
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def all(self) -> list[Metric]:
        """The metrics of all benchmarks."""
        return [metric for each in self.metrics.values() for metric in each]

    def document(self) -> str:
        """Everything as JSON."""
        absent = [
            {"benchmark": name, **asdict(a)} for name, each in self.absent.items() for a in each
        ]
        facts = {"mode": self.mode, "seed": self.seed, **self.facts, "absent": absent}
        return report.document(self.metrics, **facts)


def wide_console() -> Console:
    """A table that nobody looks at in a terminal need not squeeze into 80 columns."""
    return Console(width=None if sys.stdout.isatty() else 130)


def run(
    benchmarks: Mapping[str, Benchmark], names: Sequence[str], mode: Mode, seed: int, out: Console
) -> Measured:
    """Measure benchmarks by name, one after the other.

    Args:
        benchmarks: the benchmarks.
        names: those to run.
        mode: which configuration.
        seed: of all random numbers.
        out: where the tables go; progress goes to the standard error stream.
    """
    started, begin = datetime.now(timezone.utc), time.monotonic()
    progress = Console(stderr=True, highlight=False)
    machine = environment.machine()
    configurations = {
        name: benchmarks[name].quick if mode == "quick" else benchmarks[name].full
        for name in dict.fromkeys(names)
    }
    measured = Measured(mode, seed)
    with compilation_announced(progress):
        for name, config in configurations.items():

            def say(step: str, name: str = name) -> None:
                progress.print(f"{time.monotonic() - begin:6.1f} s  {name}: {step}", style="dim")

            rows = list(benchmarks[name].measure(config, seed, say))
            measured.metrics[name] = [row for row in rows if isinstance(row, Metric)]
            measured.absent[name] = [row for row in rows if isinstance(row, Absent)]
            _print(out, name, measured)
    measured.facts = {
        "started": started.isoformat(timespec="seconds"),
        "seconds": round(time.monotonic() - begin, 1),
        "machine": machine | {"load_after": environment.load()},
        "versions": environment.versions(),
        "configuration": {name: asdict(config) for name, config in configurations.items()},
    }
    return measured


def _print(out: Console, name: str, measured: Measured) -> None:
    out.print(report.table(name, measured.metrics[name]))
    for each in measured.absent[name]:
        out.print(f"  {each.name} {each.reason}: {each.remedy}", style="yellow", markup=False)
    for note in report.notes(measured.metrics[name]):
        out.print(f"  {note}", style="dim", highlight=False, markup=False)


def summary(out: Console, metrics: Sequence[Metric]) -> int:
    """Say which targets are missed; 1 if a figure of correctness is wrong, else 0."""
    failed = [metric.name for metric in metrics if metric.failed]
    missed = [metric.name for metric in metrics if metric.met is False and not metric.failed]
    if missed:
        out.print(f"targets not met: {'; '.join(missed)}", style="yellow")
    if failed:
        out.print(f"figures that are wrong: {'; '.join(failed)}", style="bold red")
    return 1 if failed else 0
