"""Pairs evaluated in worker processes, which may die."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import joblib

from benchmarks.scenario.records import Record, evaluate, keep, path_of, read

DEATHS = 3
"""In a row, with nothing finished between them, after which the rest is given up."""

Work = Callable[[int, int, int], Record]


class WorkersDiedError(Exception):
    """Workers die, and nothing gets finished any more.

    Args:
        left: numbers of the pairs that are left.
    """

    def __init__(self, left: Sequence[int]) -> None:
        self.left = tuple(left)
        super().__init__(
            f"worker processes died {DEATHS} times with nothing finished between, and "
            f"{len(left)} pairs are left; if memory ran out, fewer --workers need less"
        )


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

    A process that dies takes what the others are at with it, but nothing that was finished. What is
    left is started again, what had just been begun at the end, so that a pair that kills its worker
    does not keep the others from their turn.

    Args:
        folder: where records are kept.
        seed: of the pairs.
        numbers: of the pairs.
        places: of the roadmaps.
        workers: how many processes; 1 works in this one.
        say: called with a message when a process has died.
        work: work(seed, number, places) does it; importable by name.

    Raises:
        WorkersDiedError: they die again and again.
    """
    before = {number: _written(folder, number) for number in numbers}
    left, deaths = list(numbers), 0
    while left:
        began = len(left)
        calls = [joblib.delayed(_keep)(folder, work, seed, number, places) for number in left]
        try:
            for record in _pool(workers)(calls):
                left.remove(record["pair"])
                yield record
        except BrokenProcessPool:
            left = left[workers:] + left[:workers]
            for number in [n for n in left if _written(folder, n) != before[n]]:
                left.remove(number)  # the pool forgets what it has not handed on yet
                yield read(folder, number)
            deaths = 1 if len(left) < began else deaths + 1
            if left and deaths == DEATHS:
                raise WorkersDiedError(left) from None
            say(f"a worker process died; {len(left)} pairs are left and started again")


def _pool(workers: int) -> Any:
    one: Any = 1  # a call at a time: a batch would be lost as a whole
    return joblib.Parallel(workers, return_as="generator_unordered", batch_size=one)


def _keep(folder: Path, work: Work, seed: int, number: int, places: int) -> Record:
    record = work(seed, number, places)
    keep(folder, record)
    return record


def _written(folder: Path, number: int) -> int | None:
    """When a pair's record was written [ns]; none if there is none."""
    path = path_of(folder, number)
    return path.stat().st_mtime_ns if path.exists() else None
