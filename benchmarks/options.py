"""What can be asked of ``python -m benchmarks``."""

from __future__ import annotations

import argparse
from collections.abc import Collection, Sequence
from pathlib import Path

from benchmarks.baseline import FILE

COMMANDS = (
    "peers (beside other libraries and planners), objectives (what they choose), "
    "helicopter (the paper's scenario), evidence (which norm finds the safest flight)"
)


def parsed(
    given: Sequence[str], program: str, names: Collection[str], *, gated: bool = False
) -> argparse.Namespace:
    """The options of a command, with ``mode``: "quick" or "full".

    Args:
        given: what the user typed after the program.
        program: what the user types for that.
        names: of the benchmarks that may be chosen.
        gated: whether there is a baseline to compare with.
    """
    parser = _parser(program, names, gated)
    options = parser.parse_args(given)
    compares = gated and (options.gate or options.update_baseline)
    options.mode = "quick" if options.quick or (compares and not options.full) else "full"
    if gated and options.update_baseline and options.only:
        parser.error("argument --update-baseline: a baseline is of everything: not with --only")
    if gated and options.baseline != FILE and not compares:
        parser.error("argument --baseline: only with --gate or --update-baseline")
    return options


def _parser(program: str, names: Collection[str], gated: bool) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        program,
        description="Measure the library beside its peers.",
        epilog=f"commands with options of their own: {COMMANDS}" if gated else None,
    )
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--quick", action="store_true", help="smaller; takes half a minute")
    size.add_argument("--full", action="store_true", help="the usual size, also with --gate")
    parser.add_argument(
        "--only", action="append", choices=list(names), metavar="NAME",
        help=f"one of {', '.join(names)}; may be repeated",
    )  # fmt: skip
    parser.add_argument("--seed", type=_seed, default=0, help="of all random numbers (0)")
    parser.add_argument("--output", type=_new_file, metavar="FILE.json", help="write figures here")
    if gated:
        _add_gate(parser)
    return parser


def _add_gate(parser: argparse.ArgumentParser) -> None:
    action = parser.add_mutually_exclusive_group()
    action.add_argument(
        "--gate", action="store_true", help="exit code 1 if worse than the baseline; quick"
    )
    action.add_argument(
        "--update-baseline", action="store_true", help="make this run the baseline; quick"
    )
    parser.add_argument(
        "--baseline", type=_new_file, default=FILE, metavar="FILE.json",
        help="instead of the committed one",
    )  # fmt: skip


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r}: must be a whole number from 0")
    return int(text)


def _new_file(text: str) -> Path:
    """A path that can be written, found out before minutes are spent."""
    path = Path(text)
    if not path.parent.is_dir() or path.is_dir():
        raise argparse.ArgumentTypeError(f"{text!r}: must be a file in a folder that exists")
    return path
