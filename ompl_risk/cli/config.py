"""Configuration files: TOML in, TOML out."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ompl_risk.errors import ArgumentError, FileError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pyright: ignore[reportMissingImports]


def read_config(path: Path) -> dict[str, Any]:
    """The keys of a TOML file; what they mean is checked with the options of the command.

    Raises:
        FileError: the file cannot be read, is no TOML, or has tables.
    """
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileError(path, error.strerror or str(error)) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FileError(path, f"is no TOML: {error}") from None
    for key, value in values.items():
        if isinstance(value, dict):  # the parser would skip one that is called like a command
            raise FileError(path, f"[{key}] is a table", "options stand at the top, as key = value")
    return values


def to_toml(values: Mapping[str, Any], comment: str) -> str:
    """A TOML document of numbers, texts, paths, booleans and lists of these; None is left out."""
    lines = [f"# {line}" for line in comment.splitlines()]
    lines += [f"{key} = {_value(key, v)}" for key, v in values.items() if v is not None]
    return "\n".join(lines) + "\n"


def _value(key: str, value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str | Path):
        return json.dumps(str(value), ensure_ascii=False)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(key, v) for v in value) + "]"
    raise ArgumentError(key, value, "a number, a text, a path or a list of these")
