"""What a record depends on besides the library's code: seed, words and numbers of the procedure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from benchmarks import procedures
from benchmarks.scenario import procedure

CONSTANTS = (
    "FLIGHTS", "RADIUS", "FAR", "MARGIN", "NEAREST", "FARTHEST", "HEIGHT", "LEAST", "EXCESS",
    "SEPARATION", "STEP",
)  # fmt: skip


def fingerprint(places: int) -> dict[str, Any]:
    """The procedure as it is now, fit for JSON.

    Args:
        places: of the roadmaps.
    """
    return {
        "words": procedures.words(procedure.__doc__),
        "places": places,
        "norms": [norm.label for norm in procedure.NORMS],
        "blind": procedure.BLIND.d0,
        **procedures.constants(procedure, CONSTANTS),
    }


def differences(record: Mapping[str, Any], seed: int, places: int) -> Iterator[str]:
    """What a record was made with that differs, such as "places: 300 there, 3000 here".

    Records from before there were fingerprints are of the procedure as it is by default.
    """
    there = {"seed": record["seed"], **record.get("procedure", fingerprint(procedure.PLACES))}
    here = {"seed": seed, **fingerprint(places)}
    return procedures.differences(there, here)
