"""What flies, for a manoeuvre."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field

import numpy as np

from ompl_risk._arrays import FloatArray, positive, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT


@dataclass(frozen=True)
class Vehicle:
    """What flies, and what its manoeuvres keep to.

    Args:
        helicopter: the model, in still air.
        limits: its limits.
        height: how far a manoeuvre between level trims may leave their height [m].
        reserve: share of the limits that manoeuvres leave for corrections, when they are not flown
            exactly as they were made; 0 or more and below 1.
        dt: time for which each input is held [s].

    Raises:
        ArgumentError: a height or time that is not positive, or a reserve out of range.
    """

    helicopter: Helicopter = field(default_factory=Helicopter)
    limits: Limits = field(default_factory=Limits)
    _: KW_ONLY
    height: float = 1.0
    reserve: float = 0.1
    dt: float = DT

    def __post_init__(self) -> None:
        for name in ("height", "dt"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))
        allowed = "0 or more and below 1"
        reserve = real_number("reserve", self.reserve, allowed)
        if not 0.0 <= reserve < 1.0:
            raise ArgumentError("reserve", self.reserve, allowed)
        object.__setattr__(self, "reserve", reserve)

    @property
    def kept(self) -> Limits:
        """The limits without the reserve: what trims and manoeuvres are made for."""
        return self.limits.scaled(1.0 - self.reserve)

    @property
    def ranges(self) -> FloatArray:
        """Greatest values of the inputs, either way: the units of their changes, shape (4,)."""
        return np.max(np.abs(self.limits.controls(self.helicopter)), axis=0)
