"""``python -m benchmarks evidence``: which norm predicts collisions in a closed loop."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import joblib
from rich.console import Console

from benchmarks.evidence.engines import ClusterLostError, Dask, Engine, Local, Lost
from benchmarks.evidence.settings import ROLLOUTS, Settings
from benchmarks.evidence.store import NAME, Kept, compact, keep, kept
from benchmarks.evidence.unit import COMPLETE, FAILED, evaluate, failed
from benchmarks.sessions import Progress, complain, consoles, count, log, teller
from benchmarks.working import WorkersDiedError
from ompl_risk.errors import FileError, OmplRiskError

UNITS, QUICK = 520, 10
QUICK_ROLLOUTS = 100
GOES_ON = "every finished unit is kept, and the same command goes on from here"


def main(argv: Sequence[str]) -> int:
    """Do what has not been done yet, then report.

    Returns:
        0; 1 if a unit failed, or workers died or went away for good; 2 for wrong use; 130 after
        Ctrl-C, when everything finished is kept.
    """
    options = _options(argv)
    out, err = consoles()
    try:
        return _session(options, out, err)
    except KeyboardInterrupt:
        err.print(f"\nstopped; {GOES_ON}")
        return 130
    except (WorkersDiedError, ClusterLostError) as error:
        complain(err, f"{error}; {GOES_ON}")
        return 1
    except (OmplRiskError, OSError) as error:
        complain(err, str(error))
        return 2


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
    if options.retry_failed:
        done = {number: unit for number, unit in done.items() if unit.status != FAILED}
    left = [number for number in range(options.units) if number not in done]
    if done:
        err.print(f"{len(done)} of {options.units} units were done before")
    say = teller(err)
    progress = Progress(say, options.units, len(done))
    for number, found in engine.run(partial(evaluate, settings), left, say):
        unit = failed(settings, number, found.reason) if isinstance(found, Lost) else found
        keep(options.output, unit)
        said = f": {unit.reason}" if unit.reason else ""
        progress.tell(f"unit {number} {unit.status}{said}")


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
    parser = argparse.ArgumentParser(
        "python -m benchmarks evidence",
        description="Many sets of five helicopter flights of equal time, each flown again and "
        "again in wind and error: which norm finds the safest. Start it again with the same "
        "command and it goes on where it was stopped.",
    )
    parser.add_argument(
        "--units", type=count, metavar="N",
        help=f"pairs of start and goal, each a set in every level ({UNITS}; quick {QUICK})",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="few units with few rollouts")
    parser.add_argument("--seed", type=int, default=0, help="of everything (%(default)s)")
    parser.add_argument(
        "--rollouts", type=count, metavar="N",
        help=f"of each flight in each level ({ROLLOUTS}; quick {QUICK_ROLLOUTS}); with another "
        "number it is another procedure, which needs another folder",
    )  # fmt: skip
    parser.add_argument("--workers", type=count, default=joblib.cpu_count(), help="(%(default)s)")
    parser.add_argument(
        "--engine", choices=("joblib", "dask"), default="joblib", help="(%(default)s)"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS",
        help="of a Dask cluster, such as tcp://host:8786; a local one is started if left out",
    )  # fmt: skip
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="(runs/evidence)")
    parser.add_argument("--retry-failed", action="store_true", help="do those again that failed")
    parser.add_argument("--report-only", action="store_true", help="report on what is there")
    options = parser.parse_args(argv)
    if options.units is None:
        options.units = QUICK if options.quick else UNITS
    if options.rollouts is None:
        options.rollouts = QUICK_ROLLOUTS if options.quick else ROLLOUTS
    if options.output is None:
        options.output = Path("runs") / f"evidence{'-quick' if options.quick else ''}"
    if options.seed < 0:
        parser.error(f"argument --seed: {options.seed}: must be 0 or more")
    if options.scheduler and options.engine != "dask":
        parser.error(f"argument --scheduler: {options.scheduler}: only with --engine dask")
    return options
