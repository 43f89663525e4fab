"""Pairs evaluated in worker processes, which may die."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from benchmarks import working
from benchmarks.scenario.records import PAIRS, Record, evaluate, keep, read

Work = Callable[[int, int, int], Record]


def finished(
    folder: Path,
    seed: int,
    numbers: Sequence[int],
    places: int,
    *,
    workers: int,
    say: Callable[[str], object],
    work: Work = evaluate,
) -> Iterator[Record]:
    """Records of pairs, as they come, each kept by the process that made it.

    A process that dies takes what the others are at with it, but nothing that was finished.

    Args:
        folder: where records are kept.
        seed: of the pairs.
        numbers: of the pairs.
        places: of the roadmaps.
        workers: how many processes; 1 works in this one.
        say: called with a message when a process has died.
        work: work(seed, number, places) does it; importable by name.

    Raises:
        working.WorkersDiedError: they die again and again.
    """
    before = {number: _written(folder, number) for number in numbers}

    def recovered(number: int) -> Record | None:
        new = _written(folder, number) != before[number]
        return read(folder, number) if new else None

    coming = working.finished(
        partial(_keep, folder, work, seed, places),
        numbers,
        workers=workers,
        say=say,
        what="pairs",
        recovered=recovered,
    )
    for _number, record in coming:
        yield record


def _keep(folder: Path, work: Work, seed: int, places: int, number: int) -> Record:
    record = work(seed, number, places)
    keep(folder, record)
    return record


def _written(folder: Path, number: int) -> int | None:
    """When a pair's record was written [ns]; none if there is none."""
    path = PAIRS.path(folder, number)
    return path.stat().st_mtime_ns if path.exists() else None
