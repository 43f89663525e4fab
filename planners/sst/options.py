"""How SST is told to plan."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

from ompl_risk._arrays import positive, real_number
from ompl_risk.errors import ArgumentError

PRUNING = 0.012
"""Radius that a witness stands for, in distances from start to goal."""

PRUNING_RANGE = (0.5, 4.0)
"""The same at least and at most [m]: from hover, a second's flight must lead out of it."""

SELECTION = 10.0
"""Radius within which the least cost is selected, in those of the pruning."""


@dataclass(frozen=True)
class Options:
    """The arguments of ``SST``, checked.

    Raises:
        ArgumentError: a value out of range.
    """

    _: KW_ONLY
    seed: int
    selection_radius: float | None
    pruning_radius: float | None
    iterations: int | None
    authority: float
    shrink: bool

    def __post_init__(self) -> None:
        if not _is_whole(self.seed) or not 0 <= self.seed < 2**64:
            raise ArgumentError("seed", self.seed, "a whole number from 0 and below 2^64")
        if self.iterations is not None and not (_is_whole(self.iterations) and self.iterations > 0):
            raise ArgumentError("iterations", self.iterations, "None or a whole number from 1")
        if not isinstance(self.shrink, bool):
            raise ArgumentError("shrink", self.shrink, "True or False")
        for name in ("selection_radius", "pruning_radius"):
            if getattr(self, name) is not None:
                positive(name, getattr(self, name))
        allowed = "above 0 and up to 1"
        if not 0.0 < real_number("authority", self.authority, allowed) <= 1.0:
            raise ArgumentError("authority", self.authority, allowed)

    def radii(self, way: float) -> tuple[float, float]:
        """For selection and for pruning [m].

        Args:
            way: from start to goal [m].
        """
        least, most = PRUNING_RANGE
        pruning = min(max(PRUNING * way, least), most)
        if self.pruning_radius is not None:
            pruning = self.pruning_radius
        if self.selection_radius is not None:
            return self.selection_radius, pruning
        return SELECTION * pruning, pruning


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)
