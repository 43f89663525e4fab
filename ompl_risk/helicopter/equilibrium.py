"""Newton's method for the attitude and the input that keep the helicopter in one motion."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.helicopter.parameters import Helicopter

TOLERANCE = 1e-10
"""Greatest acceleration that a solution may leave [m/s^2, rad/s^2]."""

MOST_STEPS = 50

_NEXT, _AFTER = [1, 2, 0], [2, 0, 1]


class Equilibrium(NamedTuple):
    """Attitude and input that keep up a motion; see `Trim` for the fields."""

    roll: float
    pitch: float
    control: FloatArray
    velocity: FloatArray
    rates: FloatArray
    residual: float


def solve(helicopter: Helicopter, speed: float, climb: float, turn: float) -> Equilibrium:
    """Solve the six equations v' = 0, omega' = 0 of a motion.

    ::

        force - C v - m R^T (0, V turn, g) = 0,  J omega x omega + torque = 0
        v = R^T (V, 0, climb),  omega = R^T (0, 0, turn),  R = Ry(theta) Rx(phi)

    The unknowns are phi, theta, u_c, u_psi, gamma_p and gamma_r; derivatives are analytic.

    Args:
        helicopter: what flies, in still air.
        speed: horizontal speed V [m/s].
        climb: vertical speed [m/s].
        turn: turn rate [rad/s].

    Returns:
        The best that was found; its residual says whether it is a solution.
    """
    motion = np.array(
        [[speed, 0.0, 0.0], [0.0, speed * turn, 0.0], [climb, helicopter.gravity, turn]]
    )
    with np.errstate(all="ignore"):  # a flight out of all bounds ends in a residual of infinity
        best, least = _newton(helicopter, motion, _guess(helicopter, motion))
        body = _body_axes(best[0], best[1]) @ motion
    roll, pitch, *control = (best + 0.0).tolist()  # 0.0 for -0.0
    rest = np.array(control), body[:, 0] + 0.0, body[:, 2] + 0.0
    return Equilibrium(roll, pitch, *rest, least)


def _newton(
    helicopter: Helicopter, motion: FloatArray, unknowns: FloatArray
) -> tuple[FloatArray, float]:
    """The best unknowns on Newton's way, and the greatest acceleration that they leave."""
    best, least = unknowns, math.inf
    for _ in range(MOST_STEPS):
        errors, slopes = _accelerations(helicopter, motion, unknowns)
        worst = float(np.abs(errors).max())
        if worst < least:
            best, least = unknowns, worst
        elif least <= TOLERANCE:  # no better: rounding
            break
        if worst == 0.0 or not math.isfinite(worst):
            break
        try:
            unknowns = unknowns - np.linalg.solve(slopes, errors)
        except np.linalg.LinAlgError:
            break
        if not np.isfinite(unknowns).all():
            break
        unknowns[:2] = [math.remainder(angle, math.tau) for angle in unknowns[:2]]
    return best, least


def _guess(helicopter: Helicopter, motion: FloatArray) -> FloatArray:
    """The rotor's axis along the force that is needed; exact without drag and rotation."""
    velocity, acceleration = motion[:, 0], motion[:, 1]
    force = helicopter.mass * acceleration + np.array(helicopter.drag) * velocity
    lift = float(np.linalg.norm(force))
    if not 0.0 < lift < math.inf:  # the air carries the whole weight, or no numbers at all
        return np.zeros(6)
    roll, pitch = -math.asin(force[1] / lift), math.atan2(force[0], force[2])
    return np.array([roll, pitch, lift, 0.0, 0.0, 0.0])


def _body_axes(roll: float, pitch: float) -> FloatArray:
    """R^T, which takes vectors of the world at heading 0 to the body."""
    s, c, sy, cy = math.sin(roll), math.cos(roll), math.sin(pitch), math.cos(pitch)
    return np.array([[cy, 0.0, -sy], [s * sy, c, s * cy], [c * sy, -s, c * cy]])


def _accelerations(
    helicopter: Helicopter, motion: FloatArray, unknowns: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """v' and omega', shape (6,), and their derivatives by the unknowns, shape (6, 6)."""
    roll, pitch, *control = unknowns.tolist()
    s, c = math.sin(roll), math.cos(roll)
    body = _body_axes(roll, pitch) @ motion
    by_roll = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]) @ body
    by_pitch = np.array([[0.0, -s, -c], [s, 0.0, 0.0], [c, 0.0, 0.0]]) @ body
    load, load_slopes = _load(helicopter, *control)
    j = np.array(helicopter.inertia)
    gyration = j[_NEXT] - j[_AFTER]
    omega = body[:, 2]
    errors, slopes = load, np.zeros((6, 6))
    errors[:3] -= _carried(helicopter, body)
    errors[3:] += gyration * omega[_NEXT] * omega[_AFTER]
    for k, slope in enumerate((by_roll, by_pitch)):
        d = slope[:, 2]
        slopes[:3, k] = -_carried(helicopter, slope)
        slopes[3:, k] = gyration * (d[_NEXT] * omega[_AFTER] + omega[_NEXT] * d[_AFTER])
    slopes[:, 2:] = load_slopes
    inertia = np.concatenate([np.full(3, helicopter.mass), j])
    return errors / inertia, slopes / inertia[:, None]


def _carried(helicopter: Helicopter, body: FloatArray) -> FloatArray:
    """Force that drag, weight and the curve ask for [N], linear in the columns of ``body``."""
    return np.array(helicopter.drag) * body[:, 0] + helicopter.mass * body[:, 1]


def _load(
    helicopter: Helicopter, u_c: float, u_psi: float, gamma_p: float, gamma_r: float
) -> tuple[FloatArray, FloatArray]:
    """Force and torque of the controls, shape (6,), and derivatives by them, shape (6, 4)."""
    h, t = helicopter.hub, helicopter.tail
    sp, cp, sr, cr = (
        math.sin(gamma_p),
        math.cos(gamma_p),
        math.sin(gamma_r),
        math.cos(gamma_r),
    )
    lift = np.array([sp * cr, -sr, cp * cr, h * sr, h * sp * cr, 0.0])
    tail = np.array([0.0, -1.0, 0.0, 0.0, 0.0, t])
    by_pitch = u_c * np.array([cp * cr, 0.0, -sp * cr, 0.0, h * cp * cr, 0.0])
    by_roll = u_c * np.array([-sp * sr, -cr, -cp * sr, h * cr, -h * sp * sr, 0.0])
    return u_c * lift + u_psi * tail, np.stack([lift, tail, by_pitch, by_roll], axis=1)
