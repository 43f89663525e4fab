"""Numbered pieces of work done in worker processes, which may die."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

import joblib

DEATHS = 3
"""In a row, with nothing finished between them, after which the rest is given up."""

Result = TypeVar("Result")


class WorkersGoneError(Exception):
    """Nobody is left to do the rest; what is finished is kept."""


class WorkersDiedError(WorkersGoneError):
    """Workers die, and nothing gets finished any more.

    Args:
        left: numbers of what is left.
        what: they are numbers of.
    """

    def __init__(self, left: Sequence[int], what: str) -> None:
        self.left = tuple(left)
        super().__init__(
            f"worker processes died {DEATHS} times with nothing finished between, and "
            f"{len(left)} {what} are left; if memory ran out, fewer --workers need less"
        )


def finished(
    work: Callable[[int], Result],
    numbers: Sequence[int],
    *,
    workers: int,
    say: Callable[[str], object],
    what: str,
    recovered: Callable[[int], Result | None] = lambda _number: None,
) -> Iterator[tuple[int, Result]]:
    """Numbers and results, as they come.

    A process that dies takes what the others are at with it. What is left is started again, what
    had just been begun at the end, so that a piece that kills its worker does not keep the others
    from their turn.

    Args:
        work: does the piece of that number; importable by name.
        numbers: of the pieces.
        workers: how many processes; 1 works in this one.
        say: called with a message when a process has died.
        what: the pieces are called in messages.
        recovered: a result that was kept by a worker before another one died, if there is one.

    Raises:
        WorkersDiedError: they die again and again.
    """
    left, deaths = list(numbers), 0
    while left:
        began = len(left)
        calls = [joblib.delayed(_numbered)(work, number) for number in left]
        try:
            for number, result in _pool(workers)(calls):
                left.remove(number)
                yield number, result
        except BrokenProcessPool:
            left = left[workers:] + left[:workers]
            for number in list(left):  # the pool forgets what it has not handed on yet
                if (result := recovered(number)) is not None:
                    left.remove(number)
                    yield number, result
            deaths = 1 if len(left) < began else deaths + 1
            if left and deaths == DEATHS:
                raise WorkersDiedError(left, what) from None
            say(f"a worker process died; {len(left)} {what} are left and started again")


def _pool(workers: int) -> Any:
    one: Any = 1  # a call at a time: a batch would be lost as a whole
    return joblib.Parallel(workers, return_as="generator_unordered", batch_size=one)


def _numbered(work: Callable[[int], Result], number: int) -> tuple[int, Result]:
    return number, work(number)
