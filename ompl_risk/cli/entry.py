"""Where the command line begins and every known error ends, as one line."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from cyclopts import CycloptsError
from rich.console import Console

from ompl_risk.cli.app import make_app
from ompl_risk.cli.compiling import compilation_announced
from ompl_risk.cli.config import read_config
from ompl_risk.cli.settings import PlanSettings
from ompl_risk.errors import ArgumentError, OmplRiskError

INTERRUPTED = 130
"""The exit code of a process that Ctrl-C has ended, by convention."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Args:
        arguments: the command line without the program's name; that of the process if left out.

    Returns:
        The exit code: 0 if all went well, 1 after an error, which is told in one line on standard
        error, 130 after Ctrl-C.
    """
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    errors = Console(stderr=True)
    try:
        return _run(tokens)
    except CycloptsError as error:
        line = f"{_of_parser(error)} See ompl-risk {_command(tokens)}--help"
    except OmplRiskError as error:
        line = " ".join(_as_typed(error).split())
    except KeyboardInterrupt:
        errors.print("stopped; what had been written is kept", highlight=False)
        return INTERRUPTED
    errors.print(f"ompl-risk: {line}", soft_wrap=True, markup=False, highlight=False)
    return 1


def _run(tokens: list[str]) -> int:
    source = _config_file(tokens)
    values: dict[str, Any] = {} if source is None else read_config(source)
    console = Console()
    app = make_app(console, values, str(source))
    with compilation_announced(console):
        result = app(
            tokens,
            exit_on_error=False,
            print_error=False,
            result_action="return_value",
        )
    return result if isinstance(result, int) else 0  # --help and --version return None


def _config_file(tokens: Sequence[str]) -> Path | None:
    """The file after --config, which has to be read before the other options can be."""
    for k, token in enumerate(tokens):
        if token.startswith("--config="):
            return Path(token.removeprefix("--config="))
        if token == "--config" and k + 1 < len(tokens):
            return Path(tokens[k + 1])
    return None


def _of_parser(error: CycloptsError) -> str:
    """The message of the parser in one line, with the argument if it does not say."""
    error.verbose = False
    message = " ".join(str(error).split())
    name = getattr(error.argument, "name", "")
    if name and name not in message and name.lstrip("-") not in message:
        return f"{name}: {message}"
    return message


def _command(tokens: Sequence[str]) -> str:
    """The command that was asked for, with a blank, if there is one of that name."""
    first = tokens[0] if tokens else ""
    return f"{first} " if first in ("plan", "rank", "table1", "doctor") else ""


def _as_typed(error: OmplRiskError) -> str:
    """The message, with an argument that is an option written as the option."""
    message = str(error)
    if isinstance(error, ArgumentError):
        name, bracket, rest = error.argument.partition("[")
        if name in {field.name for field in fields(PlanSettings)}:
            option = f"--{name.replace('_', '-')}{bracket}{rest}"
            return option + message.removeprefix(error.argument)
    return message
