"""The options that commands that can be stopped and go on share, and what is taken for them."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import joblib

from benchmarks.sessions import Session, exit_code

AGAIN = "Start it again with the same command and it goes on where it was stopped."


@dataclass(frozen=True)
class Command:
    """A command of ``python -m benchmarks`` that does one thing after the other.

    Attributes:
        name: what it is called, and its folder in ``runs``.
        thing: what it does one of after the other, such as "unit".
        full: what is taken for options that are left out, by their names.
        quick: the same with ``--quick``.
    """

    name: str
    thing: str
    full: Mapping[str, Any]
    quick: Mapping[str, Any]

    def run(self, session: Session) -> int:
        """The exit code of a session, see `exit_code`."""
        return exit_code(session, self.thing)

    def parser(self, description: str) -> argparse.ArgumentParser:
        """A parser that has no options yet."""
        return argparse.ArgumentParser(
            f"python -m benchmarks {self.name}", description=f"{description} {AGAIN}"
        )

    def sizes(self, option: str) -> str:
        """What is taken for a number that is left out, such as "(520; quick 10)"."""
        return f"({self.full[option]:g}; quick {self.quick[option]:g})"

    def add_workers(self, parser: argparse.ArgumentParser) -> None:
        """Add ``--workers``, as many as there are processors."""
        parser.add_argument(
            "--workers", type=count, default=joblib.cpu_count(), help="(%(default)s)"
        )

    def add_kept(self, parser: argparse.ArgumentParser) -> None:
        """Add ``--output`` and ``--retry-failed``."""
        parser.add_argument("--output", type=Path, metavar="FOLDER", help=f"(runs/{self.name})")
        parser.add_argument(
            "--retry-failed", action="store_true", help="do those again that failed"
        )

    def parsed(self, parser: argparse.ArgumentParser, argv: Sequence[str]) -> argparse.Namespace:
        """The options, with all that is left out filled in.

        Args:
            parser: has ``--quick``, ``--output`` and an option for everything in ``full``, each of
                which is None if left out.
            argv: arguments after the command's name.
        """
        options = parser.parse_args(argv)
        for name, default in (self.quick if options.quick else self.full).items():
            if getattr(options, name) is None:
                setattr(options, name, default)
        if options.output is None:
            options.output = Path("runs") / f"{self.name}{'-quick' if options.quick else ''}"
        return options


def count(text: str) -> int:
    """A number of things from the command line.

    Raises:
        argparse.ArgumentTypeError: it is not a whole number of at least 1.
    """
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number of at least 1")
    return int(text)


def seed(text: str) -> int:
    """A seed from the command line.

    Raises:
        argparse.ArgumentTypeError: it is not a whole number of at least 0.
    """
    try:
        value = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"invalid int value: {text!r}") from None
    if value < 0:
        raise argparse.ArgumentTypeError(f"{value}: must be 0 or more")
    return value
