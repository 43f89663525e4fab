"""Probabilities of collision that a ranking is given: along a trajectory, or of the whole of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ompl_risk.errors import ArgumentError
from ompl_risk.ranking.assessment import Estimate, Profile

KINDS = (
    "a profile with arrays t and p, as from collision_probability, an estimate with probability, "
    "low and high, as from closed_loop_probability, or a tuple of both"
)


@dataclass(frozen=True, eq=False)
class Given:
    """What is known of one trajectory.

    Args:
        profile: probability along it.
        estimate: probability that the whole of it ends in collision.
    """

    profile: Profile | None = None
    estimate: Estimate | None = None


def given_probabilities(
    probability: Mapping[str, Any] | Sequence[Any] | None, names: Sequence[str]
) -> dict[str, Given]:
    """Sort out what was given, by name.

    Args:
        probability: by name or in the order of ``names``; each a profile, an estimate or a tuple.
        names: of the trajectories.

    Raises:
        ArgumentError: something else, other names or another number of them, an estimate that has
            the name of another trajectory, or one kind for some of the trajectories only.
    """
    if probability is None:
        return {name: Given() for name in names}
    if not isinstance(probability, Mapping):
        if isinstance(probability, str) or not isinstance(probability, Iterable):
            raise ArgumentError("probability", probability, "a list, or a dictionary by name")
        probability = tuple(probability)
        if len(probability) != len(names):
            raise ArgumentError("len(probability)", len(probability), f"{len(names)}: one each")
        probability = dict(zip(names, probability, strict=True))
    elif set(probability) != set(names):
        allowed = f"a profile or estimate for each of {list(names)}"
        raise ArgumentError("probability", sorted(probability), allowed)
    found = {name: _sorted_out(name, probability[name]) for name in names}
    for name, given in found.items():
        other = getattr(given.estimate, "name", name)
        if other != name and other in names:
            raise ArgumentError(f"probability[{name!r}]", f"that of {other!r}", f"that of {name!r}")
    for kind in ("profile", "estimate"):
        without = [name for name in names if getattr(found[name], kind) is None]
        if 0 < len(without) < len(names):
            allowed = f"given with {_article(kind)}, as the others"
            raise ArgumentError(f"probability[{without[0]!r}]", probability[without[0]], allowed)
    return found


def _sorted_out(name: str, value: Any) -> Given:
    parts = value if isinstance(value, tuple) else (value,)
    profiles = [part for part in parts if hasattr(part, "t") and hasattr(part, "p")]
    estimates = [part for part in parts if _is_estimate(part)]
    alien = len(profiles) + len(estimates) != len(parts)
    if not parts or alien or len(profiles) > 1 or len(estimates) > 1:
        raise ArgumentError(f"probability[{name!r}]", value, KINDS)
    for estimate in estimates:
        _check(name, estimate)
    return Given(profiles[0] if profiles else None, estimates[0] if estimates else None)


def _is_estimate(part: Any) -> bool:
    return all(hasattr(part, field) for field in ("probability", "low", "high"))


def _check(name: str, estimate: Estimate) -> None:
    numbers = float(estimate.low), float(estimate.probability), float(estimate.high)
    if any(math.isnan(p) for p in numbers) or not 0.0 <= numbers[0] <= numbers[2] <= 1.0:
        allowed = "0 <= low <= high <= 1"
        raise ArgumentError(
            f"probability[{name!r}]", f"low {numbers[0]}, high {numbers[2]}", allowed
        )


def _article(kind: str) -> str:
    return f"an {kind}" if kind[0] in "aeiou" else f"a {kind}"
