"""Long work in portions that leave room to stop."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

QUICK = 0.01
"""Seconds that a portion should take."""


class Portions:
    """Cuts rows into portions that take about ``QUICK`` seconds each, by what earlier ones took."""

    def __init__(self) -> None:
        self._size = 16.0

    def of(self, n: int, stop: Callable[[], bool]) -> Iterator[slice]:
        """Portions of n rows, until ``stop()``."""
        first = 0
        while first < n and not stop():
            last = min(n, first + max(1, int(self._size)))
            begin = time.perf_counter()
            yield slice(first, last)
            seconds = max(time.perf_counter() - begin, 1e-6)
            aim = (last - first) * QUICK / seconds
            self._size = min(max(aim, self._size / 8.0), self._size * 8.0)
            first = last
