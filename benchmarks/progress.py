"""How far numbered work has come, and how long the rest will take."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

FAILED = "failed"
"""The status of what can be done again."""


class Pace:
    """Counts what gets done, and expects the rest at the pace of this session.

    Args:
        total: how many things there are.
        before: how many of them were done before.
    """

    def __init__(self, total: int, before: int) -> None:
        self.total, self.done = total, before
        self._before, self._begin = before, time.monotonic()

    def step(self) -> None:
        """One more is done."""
        self.done += 1

    @property
    def left(self) -> str:
        """Time for the rest, such as "0:07 left"; once one is done."""
        pace = (time.monotonic() - self._begin) / (self.done - self._before)
        return f"{clock(pace * (self.total - self.done))} left"

    def line(self, words: str) -> str:
        """Such as "3/8  0:07 left  words"."""
        return f"{self.done}/{self.total}  {self.left}  {words}"


class Queue:
    """The numbers of what is left to do, and a line for each that gets done.

    Args:
        thing: what is done, such as "unit".
        total: they are numbered from 0 to one less.
        statuses: of those that were done before.
        again: whether those of them that failed are done again.
        say: called with a line.

    Attributes:
        left: the numbers, in order.
    """

    def __init__(
        self,
        thing: str,
        total: int,
        statuses: Mapping[int, str],
        *,
        again: bool,
        say: Callable[[str], object],
    ) -> None:
        done = {number for number, status in statuses.items() if not (again and status == FAILED)}
        self.left = [number for number in range(total) if number not in done]
        if done:
            say(f"{len(done)} of {total} {thing}s were done before")
        self._thing, self._say, self._pace = thing, say, Pace(total, len(done))

    def tell(self, number: int, status: str, reason: str = "") -> None:
        """One of them is done; a reason is of a status that needs one."""
        self._pace.step()
        said = f": {reason}" if reason else ""
        self._say(self._pace.line(f"{self._thing} {number} {status}{said}"))


def clock(seconds: float) -> str:
    """Such as "0:07" or "1:02:30"."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02d}:{second:02d}" if hours else f"{minute}:{second:02d}"
