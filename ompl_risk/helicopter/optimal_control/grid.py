"""Which trims and manoeuvres a library has."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.optimal_control.task import Task
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle
from ompl_risk.helicopter.trims import solve_trim

GRAVITY = 9.81
"""What banks are meant under [m/s^2]: turn rate = g tan(bank) / V."""


@dataclass(frozen=True)
class Grid:
    """Speeds, turns and climbs of a library.

    Args:
        speeds: speeds [m/s], increasing, 0 or more.
        banks: gentle and hard bank of the turns at speed [rad].
        hover_turns: gentle and hard turn rate at speed 0 [rad/s].
        climbs: climb rates at speed, other than 0 [m/s], increasing.
        hover_climbs: climb rates at speed 0, other than 0 [m/s], increasing.

    Raises:
        ArgumentError: a number out of range.
    """

    speeds: Sequence[float] = (0.0, 10.0, 20.0, 30.0)
    banks: tuple[float, float] = (math.radians(15.0), math.radians(40.0))
    hover_turns: tuple[float, float] = (0.3, 0.8)
    climbs: Sequence[float] = (-6.0, -2.0, 2.0, 6.0)
    hover_climbs: Sequence[float] = (-2.0, 2.0)

    def __post_init__(self) -> None:
        speeds = _increasing("speeds", self.speeds)
        if not speeds or speeds[0] < 0.0:
            raise ArgumentError("speeds", speeds, "one or more, and none below 0")
        object.__setattr__(self, "speeds", speeds)
        for name in ("banks", "hover_turns"):
            object.__setattr__(self, name, _pair(name, getattr(self, name)))
        if self.banks[1] >= 0.5 * math.pi:
            raise ArgumentError("banks", self.banks, "below pi/2 [rad]")
        for name in ("climbs", "hover_climbs"):
            rates = _increasing(name, getattr(self, name))
            if 0.0 in rates:
                raise ArgumentError(name, rates, "other than 0, which is always there")
            object.__setattr__(self, name, rates)

    def turns_at(self, speed: float) -> tuple[float, float]:
        """Gentle and hard turn rate to the left [rad/s]."""
        if speed == 0.0:
            return self.hover_turns
        gentle, hard = (GRAVITY * math.tan(bank) / speed for bank in self.banks)
        return gentle, hard

    def climbs_at(self, speed: float) -> tuple[float, ...]:
        """Climb rates other than 0 [m/s]."""
        return tuple(self.climbs if speed else self.hover_climbs)

    @property
    def turns(self) -> FloatArray:
        """Turn rates by speed, hard right to hard left [rad/s], shape (k, 4)."""
        rates = [self.turns_at(speed) for speed in self.speeds]
        return np.array([(-hard, -gentle, gentle, hard) for gentle, hard in rates])

    def tasks(self, vehicle: Vehicle) -> list[Task]:
        """The manoeuvres to make: those to the right are mirror images, and left out.

        Raises:
            ArgumentError: a trim that does not exist, or breaks a limit less the reserve.
        """
        tasks: list[Task] = []
        for speed in self.speeds:
            sides = [(speed, 0.0, turn) for turn in self.turns_at(speed)]
            sides += [(speed, climb, 0.0) for climb in self.climbs_at(speed)]
            level = solve_trim(vehicle.helicopter, speed, limits=vehicle.kept)
            for key in sides:
                trim = solve_trim(vehicle.helicopter, *key, limits=vehicle.kept)
                tasks += [Task(level, trim), Task(trim, level)]
            others = (other for other in self.speeds if other != speed)
            tasks += [
                Task(level, solve_trim(vehicle.helicopter, other, limits=vehicle.kept))
                for other in others
            ]
        return tasks


def _increasing(name: str, value: Sequence[float]) -> tuple[float, ...]:
    numbers = readonly(name, list(value), (None,), "(n,)")
    if (np.diff(numbers) <= 0.0).any():
        raise ArgumentError(name, numbers.tolist(), "increasing")
    return tuple(numbers.tolist())


def _pair(name: str, value: Sequence[float]) -> tuple[float, float]:
    gentle, hard = readonly(name, list(value), (2,), "(2,), gentle and hard").tolist()
    if not positive(name, gentle) < hard:
        raise ArgumentError(name, (gentle, hard), "positive, the gentle one below the hard one")
    return gentle, hard
