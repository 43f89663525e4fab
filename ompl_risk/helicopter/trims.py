"""Trims: motions of the helicopter that go on unchanged under one constant input."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, as_floats, positive, readonly, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter import equilibrium
from ompl_risk.helicopter.flight_limits import broken_in_controls, broken_in_states
from ompl_risk.helicopter.parameters import Helicopter, Limits

NAMES = "(speed, climb, turn)"


class Key(NamedTuple):
    """What a trim is named by: speed and climb [m/s], turn rate [rad/s]."""

    speed: float
    climb: float = 0.0
    turn: float = 0.0

    def __str__(self) -> str:
        return f"({self.speed:.6g} m/s, climb {self.climb:.6g} m/s, turn {self.turn:.6g} rad/s)"


@dataclass(frozen=True, eq=False)
class Trim(ReadOnlyArrays):
    """A relative equilibrium of eqs. (7) and (8): straight flight, or a helix of constant attitude.

    ::

        x' = (V cos psi, V sin psi, climb),  psi' = turn,  v' = 0,  omega' = 0

    with the heading psi, the angle of the forward axis from east. The flight goes where the
    helicopter points to.

    Args:
        speed: horizontal speed V [m/s].
        climb: vertical speed [m/s].
        turn: turn rate [rad/s], positive to the left.
        orientation: quaternion (x, y, z, w) from body to world at heading 0, shape (4,).
        velocity: v in the body's frame [m/s], shape (3,).
        rates: omega in the body's frame [rad/s], shape (3,).
        control: u_c [N], u_psi [N], gamma_p and gamma_r [rad], shape (4,).
        residual: greatest of |v'| [m/s^2] and |omega'| [rad/s^2] that the solution leaves.
    """

    speed: float
    climb: float
    turn: float
    orientation: FloatArray
    velocity: FloatArray
    rates: FloatArray
    control: FloatArray
    residual: float

    @property
    def key(self) -> Key:
        """Speed, climb and turn."""
        return Key(self.speed, self.climb, self.turn)

    @property
    def roll(self) -> float:
        """Angle phi about the forward axis [rad]; negative leans to the left."""
        x, y, z, w = self.orientation.tolist()
        return math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))

    @property
    def pitch(self) -> float:
        """Angle theta about the left axis [rad]; positive is nose down."""
        x, y, z, w = self.orientation.tolist()
        return math.asin(max(-1.0, min(1.0, 2.0 * (w * y - x * z))))

    def state(self, position: ArrayLike = (0.0, 0.0, 0.0), heading: float = 0.0) -> FloatArray:
        """The state in this trim at a position [m] and heading [rad], shape (13,)."""
        s, c = math.sin(0.5 * heading), math.cos(0.5 * heading)
        x, y, z, w = self.orientation.tolist()
        turned = [c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z]
        where = as_floats("position", position)
        if where.shape != (3,):
            raise ArgumentError("position.shape", where.shape, "(3,)")
        return np.concatenate([where, turned, self.velocity, self.rates])

    def displacement(self, duration: float) -> FloatArray:
        """Change of x, y, z [m] and heading [rad] over a time [s], from heading 0, shape (4,)."""
        half = 0.5 * self.turn * duration
        chord = self.speed * duration * (math.sin(half) / half if half else 1.0)
        x, y = chord * math.cos(half), chord * math.sin(half)
        return np.array([x, y, self.climb * duration, 2.0 * half])

    def mirrored(self) -> Trim:
        """The same trim with left and right exchanged."""
        signs = {
            "orientation": (-1.0, 1.0, -1.0, 1.0),
            "velocity": (1.0, -1.0, 1.0),
            "rates": (-1.0, 1.0, -1.0),
            "control": (1.0, -1.0, 1.0, -1.0),
        }
        fields = {
            name: readonly(name, getattr(self, name) * np.array(sign) + 0.0, (len(sign),), "")
            for name, sign in signs.items()  # + 0.0: no -0.0
        }
        turn = -self.turn + 0.0
        return Trim(self.speed, self.climb, turn, **fields, residual=self.residual)


def solve_trim(
    helicopter: Helicopter,
    speed: float,
    climb: float = 0.0,
    turn: float = 0.0,
    limits: Limits | None = None,
) -> Trim:
    """The trim of a speed, climb and turn rate.

    Args:
        helicopter: what flies; in still air, since a turn in wind is no equilibrium.
        speed: horizontal speed [m/s], 0 or more.
        climb: vertical speed [m/s].
        turn: turn rate [rad/s], positive to the left.
        limits: what the helicopter may do; None: anything.

    Raises:
        ArgumentError: there is no such trim, or it breaks a limit: names the limit.

    Example:
        >>> trim = solve_trim(Helicopter(), 20.0, turn=0.5)
        >>> round(math.degrees(trim.roll), 1)
        -45.6
    """
    key = _checked_key(speed, climb, turn)
    if any(helicopter.wind):
        raise ArgumentError("helicopter.wind", helicopter.wind, "zero: trims are of still air")
    found = equilibrium.solve(helicopter, *key)
    if found.residual > equilibrium.TOLERANCE:
        allowed = f"a motion that has a trim; the best leaves {found.residual:.3g} m/s^2"
        raise ArgumentError(NAMES, tuple(key), allowed)
    trim = _trim(key, found)
    if limits is not None:
        _keep(limits, helicopter, trim)
    return trim


def _checked_key(speed: float, climb: float, turn: float) -> Key:
    if speed != 0.0:
        positive("speed", speed)
    for name, value in (("climb", climb), ("turn", turn)):
        if not math.isfinite(real_number(name, value, "a finite number")):
            raise ArgumentError(name, value, "a finite number")
    return Key(float(speed), float(climb), float(turn))


def _trim(key: Key, found: equilibrium.Equilibrium) -> Trim:
    s, c = math.sin(0.5 * found.roll), math.cos(0.5 * found.roll)
    sy, cy = math.sin(0.5 * found.pitch), math.cos(0.5 * found.pitch)
    return Trim(
        *key,
        orientation=readonly("orientation", [cy * s, sy * c, 0.0 - sy * s, cy * c], (4,), "(4,)"),
        velocity=readonly("velocity", found.velocity, (3,), "(3,)"),
        rates=readonly("rates", found.rates, (3,), "(3,)"),
        control=readonly("control", found.control, (4,), "(4,)"),
        residual=found.residual,
    )


def _keep(limits: Limits, helicopter: Helicopter, trim: Trim) -> None:
    """Raise an error that names the first limit that the trim breaks."""
    broken = broken_in_states(limits, trim.state()[None])
    broken = broken or broken_in_controls(limits, helicopter, trim.control[None])
    if broken is not None:
        raise ArgumentError(NAMES, tuple(trim.key), f"a motion within the limits: {broken}")
