"""Timing that survives a busy machine: peers take turns, and waiting for a processor is free."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray


def interleaved(
    repeats: int,
    *tasks: Callable[[int], object],
    clock: Callable[[], float] = time.thread_time,
) -> NDArray[np.float64]:
    """Time of tasks that take turns.

    Repeat 0 warms up (compilation, lazy imports) and is not counted. The order is reversed from
    repeat to repeat, so that no task always runs with the caches that another one left.

    Args:
        repeats: counted repeats, at least 1.
        tasks: called with the number of the repeat, 0 to ``repeats``.
        clock: by default the processor time of this thread, since all of the tasks' work is done
            in it; ``time.perf_counter`` for work in several threads.

    Returns:
        Seconds, shape (tasks, repeats).
    """
    seconds = np.empty((len(tasks), repeats + 1))
    with _no_collection():
        for k in range(repeats + 1):
            order = range(len(tasks))
            for i in reversed(order) if k % 2 else order:
                start = clock()
                tasks[i](k)
                seconds[i, k] = clock() - start
    return seconds[:, 1:]


@contextmanager
def _no_collection() -> Iterator[None]:
    """Python's garbage collector must not run in one task for the rubbish of another."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
