"""The anytime curve of a run: what the best path cost, and when."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np

Rows = list[tuple[float, float]]


class Watch:
    """Tells a planner when to stop, and asks meanwhile what its best path costs.

    OMPL asks a termination condition once an iteration or more often, so this sees the planner
    at work, whatever its objective: overriding `isSatisfied` instead works for objectives written
    in Python, but OMPL's path length ignores it.

    Time is processor time of the process: what others do on the machine costs a planner nothing.
    All planners run in one thread, so on an idle machine it is the time on the wall.

    Args:
        seconds: processor time that the planner has from now [s].
        best: cost of the best path so far, inf without one.

    Attributes:
        rows: (processor seconds, cost) of each improvement seen; costs fall strictly.
    """

    EVERY = 1e-3
    """Time on the wall between two questions [s]; the clock of the processor is slow to read."""

    def __init__(self, seconds: float, best: Callable[[], float]) -> None:
        self.rows: Rows = []
        self._best, self._cost, self._seconds = best, math.inf, seconds
        self._begin, self._begin_cpu = time.perf_counter(), time.process_time()
        self._next, self._over = self._begin, False
        self._clocks = [(0.0, 0.0)]

    def __call__(self) -> bool:
        """Whether to stop."""
        now = time.perf_counter()
        if now >= self._next:
            self._next = now + self.EVERY
            _, cpu = self.read()
            self._over = cpu >= self._seconds
            cost = self._best()
            if cost < self._cost:
                self._cost = cost
                self.rows.append((cpu, cost))
        return self._over

    def read(self) -> tuple[float, float]:
        """Time on the wall and processor time since the start [s]."""
        found = time.perf_counter() - self._begin, time.process_time() - self._begin_cpu
        self._clocks.append(found)
        return found

    def in_processor_time(self, rows: Sequence[tuple[float, float]]) -> Rows:
        """Rows of (seconds on the wall since the start, cost) in processor time.

        Between two questions the processor is taken to have been given evenly.
        """
        wall, cpu = np.array(self._clocks).T
        return [(float(np.interp(t, wall, cpu)), cost) for t, cost in rows]
