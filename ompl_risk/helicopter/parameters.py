"""What the helicopter weighs and measures, and what it can do."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, asdict, dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, positive, readonly, real_number
from ompl_risk.errors import ArgumentError

Range = tuple[float, float]


@dataclass(frozen=True, init=False)
class Helicopter(ReadOnlyArrays):
    """A small helicopter as one rigid body, eqs. (7) and (8) of the paper.

    ::

        R' = R hat(omega),  x' = R v
        J omega' = J omega x omega + torque
        m v' = m v x omega + R^T (0, 0, -m g) + force - C (v - R^T wind)
        (torque, force) = F(gamma) u

    F(gamma) u is the wrench of the lift ``u_c (sin gp cos gr, -sin gr, cos gp cos gr)`` at the
    hub (0, 0, hub) and of the force ``(0, -u_psi, 0)`` at the tail rotor (-tail, 0, 0). Controls
    are the collective u_c [N], the yaw force u_psi [N], the pitch gamma_p and the roll gamma_r of
    the rotor [rad]. The drag C (v - wind) is not in the paper, and zero by default.

    The default is the X-Cell 60 of Gavrilets.

    Args:
        mass: m [kg].
        inertia: principal moments J1, J2, J3 about the forward, left and upward axis [kg m^2].
        hub: height of the rotor hub above the centre of gravity, d_t [m].
        tail: distance of the tail rotor behind the centre of gravity, d_r [m].
        gravity: g [m/s^2].
        drag: coefficients along the body's axes, the diagonal of C [kg/s], shape (3,).
        wind: velocity of the air in the world [m/s], shape (3,).

    Raises:
        ArgumentError: a number out of range, or moments that no body has: each is at most the sum
            of the other two.

    Example:
        >>> round(Helicopter().weight, 2)
        80.44

    Reference:
        Gavrilets, Mettler & Feron, Dynamic model for a miniature aerobatic helicopter, MIT-LIDS
        report P-2579, 2003 (mass, inertia, rotor hub and tail rotor).
    """

    mass: float
    _: KW_ONLY
    inertia: tuple[float, float, float]
    hub: float
    tail: float
    gravity: float
    drag: tuple[float, float, float]
    wind: tuple[float, float, float]

    def __init__(
        self,
        mass: float = 8.2,
        *,
        inertia: ArrayLike = (0.18, 0.34, 0.28),
        hub: float = 0.235,
        tail: float = 0.91,
        gravity: float = 9.81,
        drag: ArrayLike = (0.0, 0.0, 0.0),
        wind: ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        fields = {
            "mass": positive("mass", mass),
            "inertia": _inertia(inertia),
            "hub": positive("hub", hub),
            "tail": positive("tail", tail),
            "gravity": positive("gravity", gravity),
            "drag": _drag(drag),
            "wind": _triple("wind", wind),
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def weight(self) -> float:
        """m g [N], the collective in hover."""
        return self.mass * self.gravity

    @cached_property
    def given(self) -> FloatArray:
        """The parameters as kernels take them, read-only."""
        body = [self.mass, *self.inertia, self.hub, self.tail, self.gravity]
        return readonly("given", [*body, *self.drag, *self.wind], (None,), "(13,)")


def _triple(name: str, value: ArrayLike) -> tuple[float, float, float]:
    x, y, z = readonly(name, value, (3,), "(3,)").tolist()
    return x, y, z


def _drag(value: ArrayLike) -> tuple[float, float, float]:
    drag = _triple("drag", value)
    if min(drag) < 0.0:
        raise ArgumentError("drag", list(drag), "0 or more in every direction")
    return drag


def _inertia(value: ArrayLike) -> tuple[float, float, float]:
    inertia = _triple("inertia", value)
    if min(inertia) <= 0.0:
        raise ArgumentError("inertia", list(inertia), "positive principal moments [kg m^2]")
    largest, rest = max(inertia), sum(inertia) - max(inertia)
    if largest > rest * (1.0 + 1e-12):
        allowed = (
            f"moments of a body: the largest, {largest:g}, at most the sum of the others, {rest:g}"
        )
        raise ArgumentError("inertia", list(inertia), allowed)
    return inertia


@dataclass(frozen=True, init=False)
class Limits:
    """What the helicopter may do.

    Args:
        lift: least and greatest collective, in weights of the helicopter.
        yaw_force: greatest force of the tail rotor, either way [N].
        tilt: greatest pitch and roll of the rotor, either way [rad].
        lift_rate: greatest change of the collective, in weights a second.
        yaw_force_rate: greatest change of the tail rotor's force [N/s].
        tilt_rate: greatest change of the rotor's pitch and roll [rad/s].
        speed: greatest speed [m/s].
        rate: greatest angular velocity about any axis of the body [rad/s].
        attitude: greatest angle between the body's upward axis and the vertical [rad].

    Raises:
        ArgumentError: a number out of range, or a range of lift without 1: it could not hover.
    """

    _: KW_ONLY
    lift: Range
    yaw_force: float
    tilt: float
    lift_rate: float
    yaw_force_rate: float
    tilt_rate: float
    speed: float
    rate: float
    attitude: float

    def __init__(
        self,
        *,
        lift: Range = (0.2, 2.0),
        yaw_force: float = 6.0,
        tilt: float = 0.2,
        lift_rate: float = 4.0,
        yaw_force_rate: float = 30.0,
        tilt_rate: float = 2.0,
        speed: float = 35.0,
        rate: float = 2.0,
        attitude: float = 1.1,
    ) -> None:
        allowed = "(low, high) with 0 <= low < 1 < high, in weights"
        low, high = readonly("lift", lift, (2,), allowed).tolist()
        if not 0.0 <= low < 1.0 < high:
            raise ArgumentError("lift", lift, allowed)
        object.__setattr__(self, "lift", (low, high))
        allowed = "above 0 and up to pi [rad]"
        if not 0.0 < real_number("attitude", attitude, allowed) <= math.pi:
            raise ArgumentError("attitude", attitude, allowed)
        allowed = "above 0 and below pi/2 [rad]"
        if not 0.0 < real_number("tilt", tilt, allowed) < 0.5 * math.pi:
            raise ArgumentError("tilt", tilt, allowed)
        rest = {
            "yaw_force": yaw_force,
            "tilt": tilt,
            "lift_rate": lift_rate,
            "yaw_force_rate": yaw_force_rate,
            "tilt_rate": tilt_rate,
            "speed": speed,
            "rate": rate,
            "attitude": attitude,
        }
        for name, value in rest.items():
            object.__setattr__(self, name, positive(name, value))

    def scaled(self, share: float) -> Limits:
        """The same with a share of every range: of the lift above and below 1.

        Args:
            share: above 0.

        Raises:
            ArgumentError: a share that is not positive, or one that makes a limit impossible.
        """
        share = positive("share", share)
        low, high = self.lift
        rest = asdict(self)
        del rest["lift"]
        return Limits(
            lift=(1.0 - share * (1.0 - low), 1.0 + share * (high - 1.0)),
            **{name: share * value for name, value in rest.items()},
        )

    def controls(self, helicopter: Helicopter) -> tuple[FloatArray, FloatArray]:
        """Least and greatest u_c [N], u_psi [N], gamma_p and gamma_r [rad], shapes (4,)."""
        low, high = self.lift
        rest = np.array([self.yaw_force, self.tilt, self.tilt])
        return (
            np.append(low * helicopter.weight, -rest),
            np.append(high * helicopter.weight, rest),
        )

    def control_rates(self, helicopter: Helicopter) -> FloatArray:
        """Greatest change of the controls, either way [1/s], shape (4,)."""
        lift = self.lift_rate * helicopter.weight
        return np.array([lift, self.yaw_force_rate, self.tilt_rate, self.tilt_rate])
