"""What a unit's result depends on besides the library's code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks import blind_flights, procedures
from benchmarks.evidence import grounds, procedure, profiles
from ompl_risk.simulation.disturbances.together import Disturbances

CONSTANTS = (
    "FLIGHTS", "FAR", "MARGIN", "NEAREST", "FARTHEST", "HEIGHT", "LEAST", "GREATEST", "LOWEST",
    "HIGHEST", "ASIDE", "BELOW", "FEWEST", "MOST", "EXCESS", "SEPARATION", "STEP",
)  # fmt: skip

ROLLOUTS = 512
"""Of each flight in each level."""


@dataclass(frozen=True)
class Settings:
    """What may be chosen for a campaign; everything else is fixed in ``procedure``.

    Args:
        seed: of all random numbers.
        rollouts: of each flight in each level.
        places: of the roadmaps.
    """

    seed: int = 0
    rollouts: int = ROLLOUTS
    places: int = procedure.PLACES

    @property
    def fingerprint(self) -> dict[str, Any]:
        """The whole procedure as it is now, by name, fit for JSON."""
        kinds = {name: [kind.split, kind.first] for name, kind in grounds.KINDS.items()}
        ranges = {name: kind.ranges for name, kind in grounds.KINDS.items()}
        return {
            "seed": self.seed,
            "rollouts": self.rollouts,
            "places": self.places,
            "words": procedures.words(procedure.__doc__),
            "blind": procedure.BLIND.d0,
            "radius": grounds.RADIUS,
            "reach": profiles.REACH,
            "bits": profiles.BITS,
            **procedures.constants(procedure, CONSTANTS),
            **flat(kinds),
            **flat(ranges),
            **flat(levels()),
        }


def levels() -> dict[str, Any]:
    """The disturbances of each level, fit for JSON."""
    return {name: plain(Disturbances.level(name).as_data()) for name in procedure.LEVELS}


def flat(data: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested values by names such as "calm gusts wind_at_6m"."""
    found: dict[str, Any] = {}
    for name, value in data.items():
        if isinstance(value, Mapping):
            found |= flat(value, f"{prefix}{name} ")
        else:
            found[f"{prefix}{name}"] = plain(value)
    return found


def plain(value: Any) -> Any:
    """With lists for tuples, as JSON gives them back."""
    if isinstance(value, Mapping):
        return {name: plain(each) for name, each in value.items()}
    return [plain(each) for each in value] if isinstance(value, list | tuple) else value


@cache
def code() -> str:
    """A fingerprint of the source that units are made by: the library's, and what is here."""
    here = sorted(Path(__file__).parent.glob("*.py"))
    return procedures.code(*here, Path(blind_flights.__file__))
