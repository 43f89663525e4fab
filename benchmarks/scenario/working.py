"""Pairs evaluated in worker processes, which may die."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import Any

import joblib

from benchmarks.scenario.records import Record, evaluate

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
    seed: int,
    numbers: Sequence[int],
    places: int,
    *,
    workers: int,
    say: Callable[[str], object],
    work: Work = evaluate,
) -> Iterator[Record]:
    """Records of pairs, as they come.

    A process that dies takes what the others are at with it, but nothing that was finished. What is
    left is started again, what had just been begun at the end, so that a pair that kills its worker
    does not keep the others from their turn.

    Args:
        seed: of the pairs.
        numbers: of the pairs.
        places: of the roadmaps.
        workers: how many processes; 1 works in this one.
        say: called with a message when a process has died.
        work: work(seed, number, places) does it; importable by name.

    Raises:
        WorkersDiedError: they die again and again.
    """
    left, deaths = list(numbers), 0
    while left:
        try:
            pool: Any = joblib.Parallel(n_jobs=workers, return_as="generator_unordered")
            for record in pool(joblib.delayed(work)(seed, number, places) for number in left[:]):
                left.remove(record["pair"])
                deaths = 0
                yield record
        except BrokenProcessPool:
            deaths += 1
            if deaths == DEATHS:
                raise WorkersDiedError(left) from None
            say(f"a worker process died; {len(left)} pairs are left and started again")
            left = left[workers:] + left[:workers]
