"""What has been done, and how long the rest will take."""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from benchmarks.campaign.run import Run


class Monitor:
    """Shows progress with the time left: a bar on a terminal, else a line for each run.

    Args:
        console: where; a file gets no bar.
        total: number of runs.
        done: how many of them were done before.
        workers: how many run at a time.
    """

    def __init__(self, console: Console, total: int, done: int, workers: int) -> None:
        self._console, self._total, self._done, self._before = console, total, done, done
        self._workers, self._begin = workers, time.monotonic()
        self._bar: Progress | None = None
        if console.is_terminal:
            self._bar = Progress(
                BarColumn(),
                MofNCompleteColumn(),
                TextColumn("{task.fields[left]}"),
                TextColumn("{task.description}"),
                console=console,
            )
            self._task = self._bar.add_task("", total=total, completed=done, left="")

    def __enter__(self) -> Monitor:
        if self._before:
            self._console.print(f"{self._before} of {self._total} runs were done before")
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def tell(self, run: Run, result: Mapping[str, Any]) -> None:
        """A run has finished."""
        self._done += 1
        words = f"{run.label}: {result['status']}"
        failed = result["status"] in ("failed", "unsound")
        if failed:
            words += f" ({result['reason']})"
        left = f"{clock(self._left())} left"
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, description=run.label, left=left)
        if self._bar is None or failed:
            line = f"{self._done}/{self._total}  {left}  {words}"
            self._console.print(line, markup=False, soft_wrap=True)

    def _left(self) -> float:
        """Seconds for the rest, at the pace of this session."""
        pace = (time.monotonic() - self._begin) / (self._done - self._before)
        return pace * (self._total - self._done)


def clock(seconds: float) -> str:
    """Such as "0:07" or "1:02:30"."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02d}:{second:02d}" if hours else f"{minute}:{second:02d}"
