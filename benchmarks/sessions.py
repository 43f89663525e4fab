"""What commands that can be stopped and go on tell, keep of each start, and end with."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from rich.console import Console

from benchmarks import environment
from benchmarks.working import WorkersGoneError
from ompl_risk.errors import OmplRiskError

Say = Callable[[str], object]
Session = Callable[[Console, Console], int]


def exit_code(session: Session, thing: str) -> int:
    """Do what a command is asked for, and say what ended it.

    Args:
        session: session(out, err) does it and returns an exit code.
        thing: what it does one of after the other, such as "unit".

    Returns:
        The session's exit code; 1 if workers have gone for good; 2 for wrong use; 130 after Ctrl-C,
        when everything finished is kept.
    """
    out, err = consoles()
    goes_on = f"every finished {thing} is kept, and the same command goes on from here"
    try:
        return session(out, err)
    except KeyboardInterrupt:
        err.print(f"\nstopped; {goes_on}")
        return 130
    except WorkersGoneError as error:
        complain(err, f"{error}; {goes_on}")
        return 1
    except (OmplRiskError, OSError) as error:
        complain(err, str(error))
        return 2


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


def facts(options: argparse.Namespace) -> dict[str, Any]:
    """When, with what and on what a command was started, fit for JSON."""
    return {
        "started": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "options": {name: str(value) for name, value in vars(options).items()},
        "machine": environment.machine(),
        "versions": environment.versions(),
    }


def log(folder: Path, options: argparse.Namespace) -> None:
    """Add to the folder's list of sessions, which is a line of JSON for each."""
    with (folder / "sessions.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps(facts(options)) + "\n")
