"""``python -m benchmarks``: the library's figures, their gate, its peers, and the objectives.

::

    python -m benchmarks [--quick] [--only NAME] [--seed N] [--output FILE.json]
    python -m benchmarks --gate | --update-baseline [--full] [--baseline FILE.json] [...]
    python -m benchmarks peers [--quick] [...]
    python -m benchmarks objectives ...
    python -m benchmarks helicopter ...
    python -m benchmarks evidence ...

Exit code 0 unless a figure of correctness is wrong: speed depends on the machine and on what else
runs on it, so targets of speed that are missed are shown and do not fail the run. With ``--gate``
it is 1 if any figure is worse than the committed baseline allows, and 2 if there is no baseline to
compare with.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence

from rich.console import Console

from benchmarks import baseline, gate, yardstick
from benchmarks.baseline import Baseline, BaselineError
from benchmarks.options import parsed
from benchmarks.readings import readings
from benchmarks.registry import BENCHMARKS, PEERS, Benchmark
from benchmarks.running import Measured, run, summary, wide_console


def main(arguments: Sequence[str] | None = None) -> int:
    """Do what the first argument says; the exit code."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    if given[:1] == ["objectives"]:
        from benchmarks.campaign.cli import main as objectives

        return objectives(given[1:])
    if given[:1] == ["helicopter"]:
        from benchmarks.scenario.cli import main as helicopter

        return helicopter(given[1:])
    if given[:1] == ["evidence"]:
        from benchmarks.evidence.cli import main as evidence

        return evidence(given[1:])
    if given[:1] == ["peers"]:
        return _measure(PEERS, parsed(given[1:], "python -m benchmarks peers", PEERS))
    options = parsed(given, "python -m benchmarks", BENCHMARKS, gated=True)
    if not (options.gate or options.update_baseline):
        return _measure(BENCHMARKS, options)
    try:
        return _update(options) if options.update_baseline else _gate(options)
    except BaselineError as error:
        Console(stderr=True).print(f"error: {error}", style="bold red", markup=False)
        return 2


def _measure(benchmarks: Mapping[str, Benchmark], options: argparse.Namespace) -> int:
    """Measure, print, and say whether all figures of correctness hold."""
    out = wide_console()
    measured = run(benchmarks, options.only or list(benchmarks), options.mode, options.seed, out)
    _write(measured, options)
    return summary(out, measured.all)


def _gate(options: argparse.Namespace) -> int:
    """Measure, and compare with the baseline."""
    known = baseline.load(options.baseline)  # before minutes are spent
    if (known.mode, known.seed) != (options.mode, options.seed):
        raise BaselineError(
            f"{options.baseline}: of a {known.mode} run with seed {known.seed}, "
            f"but this is a {options.mode} run with seed {options.seed}"
        )
    out, names = wide_console(), options.only or list(BENCHMARKS)
    before = yardstick.seconds()
    measured = run(BENCHMARKS, names, options.mode, options.seed, out)
    found = readings(measured.metrics, max(before, yardstick.seconds()))
    _write(measured, options)
    changes = gate.compared(known.readings, found, names if options.only else None)
    wrong = summary(out, measured.all)
    if any(change.verdict != "kept" for change in changes):
        out.print(gate.table(changes))
    out.print(gate.summary(changes))
    closed = any(change.closes for change in changes)
    out.print(f"gate {'CLOSED' if closed or wrong else 'open'}", style="bold")
    return 1 if closed or wrong else 0


def _update(options: argparse.Namespace) -> int:
    """Measure everything, and make it the baseline unless it is wrong."""
    out = wide_console()
    before = yardstick.seconds()
    measured = run(BENCHMARKS, list(BENCHMARKS), options.mode, options.seed, out)
    found = readings(measured.metrics, max(before, yardstick.seconds()))
    _write(measured, options)
    if summary(out, measured.all):
        raise BaselineError("figures are wrong, so the baseline stays as it was")
    baseline.save(options.baseline, Baseline(measured.mode, measured.seed, found, measured.facts))
    out.print(f"{len(found)} figures written to {options.baseline}", markup=False)
    return 0


def _write(measured: Measured, options: argparse.Namespace) -> None:
    if options.output:
        options.output.write_text(measured.document(), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
