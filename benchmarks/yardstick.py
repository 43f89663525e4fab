"""How quick this machine is now: the time of a fixed computation that is none of the library's."""

from __future__ import annotations

import time

import numpy as np

REPEATS = 15


def seconds() -> float:
    """Least processor time of sorting, sines and sums over some megabytes [s], some 6 ms.

    The least, not the median: it is the same work each time, and whatever disturbs it adds to it.
    """
    numbers = np.random.default_rng(0).random(200_000)
    found = []
    for _ in range(REPEATS):
        begin = time.thread_time()
        np.sort(numbers)
        np.cumsum(np.sin(numbers) * numbers)
        total = 0
        for k in range(100_000):
            total += k
        found.append(time.thread_time() - begin)
    return min(found)
