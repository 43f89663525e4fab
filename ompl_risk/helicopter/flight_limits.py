"""Whether states and inputs of a flight keep the limits of the helicopter."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.helicopter.parameters import Helicopter, Limits

SLACK = 1e-9
"""A limit counts as kept if it is exceeded by no more than this share: rounding."""

CONTROLS = (("collective", "N"), ("yaw force", "N"), ("rotor pitch", "rad"), ("rotor roll", "rad"))


class BrokenLimit(NamedTuple):
    """A value that is out of its limits.

    Args:
        name: what it is.
        unit: its unit.
        value: the value.
        low: what is allowed at least.
        high: what is allowed at most.
        step: at which state or input, from 0.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    step: int

    def __str__(self) -> str:
        return f"{self.name} {self.value:.6g}, not {self.range}"

    @property
    def range(self) -> str:
        """What is allowed, in words."""
        return f"{self.low:.6g} to {self.high:.6g} {self.unit}"


def broken_in_states(limits: Limits, states: FloatArray) -> BrokenLimit | None:
    """The first limit that states, shape (n, 13), break by the most, if there is one."""
    x, y = states[:, 3], states[:, 4]
    speed = np.sqrt((states[:, 7:10] ** 2).sum(axis=1))
    attitude = np.arccos(np.clip(1.0 - 2.0 * (x * x + y * y), -1.0, 1.0))
    spin = np.abs(states[:, 10:]).max(axis=1)
    rows = [
        ("speed", "m/s", speed, 0.0, limits.speed),
        ("attitude", "rad", attitude, 0.0, limits.attitude),
        ("angular velocity", "rad/s", spin, 0.0, limits.rate),
    ]
    return next(_broken(rows), None)


def broken_in_controls(
    limits: Limits, helicopter: Helicopter, controls: FloatArray
) -> BrokenLimit | None:
    """The first limit that inputs, shape (n, 4), break by the most, if there is one."""
    low, high = limits.controls(helicopter)
    rows = [
        (*CONTROLS[i], controls[:, i], float(low[i]), float(high[i])) for i in range(len(CONTROLS))
    ]
    return next(_broken(rows), None)


def broken_in_changes(
    limits: Limits, helicopter: Helicopter, controls: FloatArray, dt: float
) -> BrokenLimit | None:
    """The first limit that changes from input to input, dt [s] apart, break by the most."""
    most = limits.control_rates(helicopter)
    change = np.diff(controls, axis=0) / dt
    rows = [
        (f"change of the {name}", f"{unit}/s", change[:, i], -float(most[i]), float(most[i]))
        for i, (name, unit) in enumerate(CONTROLS)
    ]
    return next(_broken(rows), None)


def _broken(rows: list[tuple[str, str, FloatArray, float, float]]) -> Iterator[BrokenLimit]:
    for name, unit, values, low, high in rows:
        excess = np.maximum(values - high, low - values)
        step = int(np.argmax(excess))
        if not excess[step] <= SLACK * max(abs(low), abs(high)):
            yield BrokenLimit(name, unit, float(values[step]), low, high, step)
