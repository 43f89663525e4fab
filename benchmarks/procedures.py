"""Fingerprints of procedures: what results in a folder were made by, and whether it is the same."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import ompl_risk


def words(text: str | None) -> str:
    """A short name for a procedure as it is written down, however its lines are broken."""
    return hashlib.sha256(" ".join((text or "").split()).encode()).hexdigest()[:12]


def constants(module: object, names: Iterable[str]) -> dict[str, Any]:
    """Values of a module's constants, by their names in lower case."""
    return {name.lower(): getattr(module, name) for name in names}


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """What differs, such as "places: 300 there, 3000 here"."""
    for name in {**there, **here}:
        if there.get(name) != here.get(name):
            yield f"{name}: {there.get(name)} there, {here.get(name)} here"


@cache
def code(*sources: Path) -> str:
    """A fingerprint of the library's source, and of more.

    Args:
        sources: files, and folders of which all Python files count.
    """
    digest = hashlib.sha256()
    for source in (Path(ompl_risk.__file__).parent, *sources):
        for path in sorted(_files(source)):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:12]


def _files(source: Path) -> Iterator[Path]:
    if not source.is_dir():
        yield source
        return
    for path in source.iterdir():  # not rglob: it does not follow the links within the package
        if path.is_dir() or path.suffix == ".py":
            yield from _files(path)
