"""Avoidance functions by the names that people type: "inverse", "cap", "tail(12)"."""

from __future__ import annotations

import re

from ompl_risk.avoidance.base import Avoidance
from ompl_risk.avoidance.flat_cap import FlatCap
from ompl_risk.avoidance.gaussian_tail import GaussianTail
from ompl_risk.avoidance.inverse_distance import InverseDistance
from ompl_risk.errors import ArgumentError

ALLOWED = (
    '"inverse" (the paper\'s 1/d - 1/d0), "cap" (share of a ball below flat ground), or "tail(12)" '
    'with a standard deviation [m], "tail(12, 96)" with the distance where it ends as well'
)
_NUMBER = r"(\d+(?:\.\d+)?)"
_TAIL = re.compile(rf"tail\({_NUMBER}(?:, *{_NUMBER})?\)", re.IGNORECASE)


def parse_avoidance(text: str, d0: float, *, argument: str = "avoidance") -> Avoidance:
    """The avoidance function of that name.

    Args:
        text: its name; upper or lower case.
        d0: where "inverse" ends, and radius of the ball of "cap" [m].
        argument: what the caller calls it in errors.

    Raises:
        ArgumentError: no such name, or a length out of range.

    Example:
        >>> parse_avoidance("tail(12)", 100.0).d0
        48.0
    """
    name = text.strip()
    if name.lower() == "inverse":
        return InverseDistance(d0)
    if name.lower() == "cap":
        try:
            return FlatCap(d0)
        except ArgumentError as error:  # it calls d0 its radius
            raise ArgumentError("d0", d0, error.allowed) from None
    if match := _TAIL.fullmatch(name):
        try:
            return GaussianTail(float(match[1]), d0=float(match[2]) if match[2] else None)
        except ArgumentError as error:
            allowed = f"a {error.argument} that is {error.allowed}"
            raise ArgumentError(argument, text, allowed) from None
    raise ArgumentError(argument, text, ALLOWED)
