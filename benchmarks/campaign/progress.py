"""What has been done, and how long the rest will take."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from benchmarks.campaign.run import Run
from benchmarks.progress import Pace


class Monitor:
    """Shows progress with the time left: a bar on a terminal, else a line for each run.

    Args:
        console: where; a file gets no bar.
        total: number of runs.
        done: how many of them were done before.
    """

    def __init__(self, console: Console, total: int, done: int) -> None:
        self._console, self._before = console, done
        self._pace = Pace(total, done)
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
            self._console.print(f"{self._before} of {self._pace.total} runs were done before")
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def tell(self, run: Run, result: Mapping[str, Any]) -> None:
        """A run has finished."""
        self._pace.step()
        words = f"{run.label}: {result['status']}"
        failed = result["status"] in ("failed", "unsound")
        if failed:
            words += f" ({result['reason']})"
        if self._bar is not None:
            done, left = self._pace.done, self._pace.left
            self._bar.update(self._task, completed=done, description=run.label, left=left)
        if self._bar is None or failed:
            self._console.print(self._pace.line(words), markup=False, soft_wrap=True)
