"""What the vehicle believes about its own state, and how far that is from the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, positive, readonly
from ompl_risk.errors import ArgumentError

Triple = tuple[float, float, float]

DEGREE = math.pi / 180.0
"""[rad]"""

HORIZONTAL_95 = math.sqrt(-2.0 * math.log(0.05))
"""Radius within which 95 % of horizontal errors lie, in standard deviations of an axis: 2.448."""

VERTICAL_95 = 1.959963984540054
"""Size below which 95 % of vertical errors lie, in standard deviations."""


def _deviations(name: str, value: ArrayLike) -> Triple:
    x, y, z = readonly(name, value, (3,), "(3,): standard deviations").tolist()
    if min(x, y, z) < 0.0:
        raise ArgumentError(name, [x, y, z], "0 or more in every direction")
    return x, y, z


@dataclass(frozen=True, init=False)
class Drift:
    """Errors of three components: a first-order Gauss-Markov bias plus white noise.

    ::

        b(t + s) = exp(-s / time) b(t) + white noise,   error = b + noise

    The bias is stationary: of standard deviation ``bias`` at any time, with the autocorrelation
    ``exp(-s / time)``. The noise is new at every update.

    Args:
        bias: standard deviations of the bias, shape (3,).
        noise: standard deviations of the noise, shape (3,).
        time: correlation time of the bias [s].

    Raises:
        ArgumentError: a negative deviation, or a time that is not positive.

    Reference: Gelb (ed.), Applied Optimal Estimation, 1974 (exponentially correlated variables).
    """

    bias: Triple
    noise: Triple
    time: float

    def __init__(self, bias: ArrayLike, noise: ArrayLike, time: float) -> None:
        object.__setattr__(self, "bias", _deviations("bias", bias))
        object.__setattr__(self, "noise", _deviations("noise", noise))
        object.__setattr__(self, "time", positive("time", time))

    @classmethod
    def within(cls, total: ArrayLike, noise: ArrayLike, time: float) -> Drift:
        """One whose bias and noise together have the standard deviations ``total``, shape (3,).

        Raises:
            ArgumentError: more noise than that.
        """
        both, part = _deviations("total", total), _deviations("noise", noise)
        if any(n > t for n, t in zip(part, both, strict=True)):
            raise ArgumentError("noise", list(part), f"at most the total, {list(both)}")
        return cls([math.sqrt(t * t - n * n) for n, t in zip(part, both, strict=True)], part, time)


def gps_position(horizontal_95: float, vertical_95: float) -> Drift:
    """Errors of a satellite fix [m] from the sizes that 95 % of them do not exceed.

    Horizontal errors are taken to be the same in all directions. The bias forgets itself over
    1100 s, as in the error model of Beard and McLain after Rankin: over a flight of a minute it
    hardly moves. The noise, 0.1 m, is what remains of a receiver's after filtering with inertial
    measurements: a stated assumption, which matters little beside the bias.

    Args:
        horizontal_95: radius [m].
        vertical_95: [m].

    Raises:
        ArgumentError: sizes that are not positive, or smaller than the noise.

    Reference:
        Beard & McLain, Small Unmanned Aircraft: Theory and Practice, 2012, section 7.5 (GPS; the
        published code of the book, too, has 1/1100 per second);
        Rankin, An error model for sensor simulation: GPS and differential GPS, IEEE Position
        Location and Navigation Symposium, 1994.
    """
    level = positive("horizontal_95", horizontal_95) / HORIZONTAL_95
    upward = positive("vertical_95", vertical_95) / VERTICAL_95
    return Drift.within((level, level, upward), (0.1, 0.1, 0.1), 1100.0)


def small_ahrs(roll_pitch: float, heading: float) -> Drift:
    """Errors of attitude [rad] of a small attitude and heading reference from its rms in degrees.

    The noise is 0.05 degrees; the rest drifts over 100 s, the time in which such a filter forgets
    a gyroscope's bias. Both are stated assumptions.
    """
    total = (roll_pitch * DEGREE, roll_pitch * DEGREE, heading * DEGREE)
    return Drift.within(total, (0.05 * DEGREE,) * 3, 100.0)


def small_velocity(rms: float) -> Drift:
    """Errors of velocity [m/s] from their rms.

    A third of it is noise, and the rest drifts as in ``small_ahrs``: stated assumptions.
    """
    return Drift.within((rms, rms, rms), (rms / 3.0,) * 3, 100.0)


_POSITION, _ATTITUDE, _VELOCITY = gps_position(8.0, 13.0), small_ahrs(0.4, 1.0), small_velocity(0.1)


@dataclass(frozen=True)
class NavigationError:
    """Errors of the vehicle's estimate of its own state: what its controller does not know.

    The default is GPS as the standard positioning service promises it on the global average, 8 m
    horizontally and 13 m vertically at 95 %, with a small attitude and heading reference, 0.4
    degrees in roll and pitch and 1 degree in heading, and velocities to 0.1 m/s. The data sheet
    does not say what its 0.4 degrees are: they are taken to be rms, as the heading's are. 10
    updates a second are an assumption.

    Args:
        position: errors in the world, east, north and up [m].
        attitude: errors about the body's axes [rad].
        velocity: errors along the body's axes [m/s].
        rate: of the updates [Hz]; errors are held between two of them.

    Raises:
        ArgumentError: a rate that is not positive, or a part that is no ``Drift``.

    Reference:
        Global Positioning System Standard Positioning Service Performance Standard, 5th edition,
        2020, table 3.8-3 (signal in space only: a receiver's own errors come on top);
        Moog Crossbow NAV440 data sheet, revision B (attitude below 0.4 degrees, magnetic heading
        below 1.0 rms);
        Xsens MTi User Manual MT0605P, revision E, 2014, section 4.4 (MTi-G-700: velocity 0.1 m/s
        rms at 30 m/s).
    """

    position: Drift = _POSITION
    attitude: Drift = _ATTITUDE
    velocity: Drift = _VELOCITY
    rate: float = 10.0

    def __post_init__(self) -> None:
        for name in ("position", "attitude", "velocity"):
            if not isinstance(getattr(self, name), Drift):
                raise ArgumentError(name, getattr(self, name), "a Drift")
        positive("rate", self.rate)

    def given(self, update: float) -> FloatArray:
        """The parameters as the kernel takes them, shape (36,), read-only.

        Args:
            update: time from one update to the next [s].

        Raises:
            ArgumentError: a time that is not positive.
        """
        update = positive("update", update)
        parts = (self.position, self.attitude, self.velocity)
        past = update / np.repeat([part.time for part in parts], 3)
        bias = np.concatenate([part.bias for part in parts])
        noise = np.concatenate([part.noise for part in parts])
        drive = bias * np.sqrt(-np.expm1(-2.0 * past))
        given = np.concatenate([np.exp(-past), drive, bias, noise])
        given.setflags(write=False)
        return given
