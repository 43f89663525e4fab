"""Fingerprints of procedures: what results in a folder were made by, and whether it is the same."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Any


def words(text: str | None) -> str:
    """A short name for a procedure as it is written down, however its lines are broken."""
    return hashlib.sha256(" ".join((text or "").split()).encode()).hexdigest()[:12]


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> Iterator[str]:
    """What differs, such as "places: 300 there, 3000 here"."""
    for name in {**there, **here}:
        if there.get(name) != here.get(name):
            yield f"{name}: {there.get(name)} there, {here.get(name)} here"
