"""Runs a compiled kernel over chunks of a batch, a thread each."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from ompl_risk.errors import ArgumentError

MIN_CHUNK = 4096
"""Queries below which a further thread costs more than it saves."""


def thread_count(threads: int | None) -> int:
    """The number of threads to use; ``None`` means all processors that we may run on.

    Raises:
        ArgumentError: not a positive whole number.
    """
    if threads is None:
        affinity = getattr(os, "sched_getaffinity", None)
        return len(affinity(0)) if affinity else os.cpu_count() or 1
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise ArgumentError("threads", threads, "None or a whole number from 1")
    return threads


def in_chunks(
    work: Callable[[int, int], None], n: int, threads: int | None, *, least: int = MIN_CHUNK
) -> None:
    """Call ``work(first, last)`` over chunks of ``range(n)``.

    Args:
        work: must release the GIL to gain anything, and write only to its own rows.
        n: length of the batch.
        threads: at most so many at a time.
        least: smallest chunk that is worth a thread.
    """
    count = max(1, min(thread_count(threads), n // least))
    if count == 1:
        work(0, n)
        return
    edges = [n * k // count for k in range(count + 1)]
    with ThreadPoolExecutor(count) as pool:
        for done in [pool.submit(work, *edge) for edge in itertools.pairwise(edges)]:
            done.result()
