"""What commands that can be stopped and go on have in common: options, log, and telling."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from datetime import datetime, timezone
from pathlib import Path

from rich.console import Console

from benchmarks import environment
from benchmarks.campaign.progress import clock

Say = Callable[[str], object]


def consoles() -> tuple[Console, Console]:
    """For results, and for messages."""
    width = None if sys.stdout.isatty() else 150
    return Console(width=width, highlight=False), Console(stderr=True, highlight=False)


def teller(console: Console) -> Say:
    """Prints lines as they are."""
    return lambda line: console.print(line, markup=False, soft_wrap=True)


def complain(console: Console, message: str) -> None:
    """Print an error."""
    console.print(f"error: {message}", style="red", markup=False, soft_wrap=True)


def log(folder: Path, options: argparse.Namespace) -> None:
    """Add to the folder's list of sessions, which is a line of JSON for each."""
    facts = {
        "started": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "options": {name: str(value) for name, value in vars(options).items()},
        "machine": environment.machine(),
        "versions": environment.versions(),
    }
    with (folder / "sessions.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(facts) + "\n")


def count(text: str) -> int:
    """A number of things from the command line.

    Raises:
        argparse.ArgumentTypeError: it is not a whole number of at least 1.
    """
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number of at least 1")
    return int(text)


class Progress:
    """Tells of each thing that gets done, with the time left at the pace of this session.

    Args:
        say: called with a line.
        total: how many there are.
        before: how many of them were done before.
    """

    def __init__(self, say: Say, total: int, before: int) -> None:
        self._say, self._total, self._before = say, total, before
        self._done, self._begin = before, time.monotonic()

    def tell(self, what: str) -> None:
        """One more is done."""
        self._done += 1
        pace = (time.monotonic() - self._begin) / (self._done - self._before)
        left = clock(pace * (self._total - self._done))
        self._say(f"{self._done}/{self._total}  {left} left  {what}")
