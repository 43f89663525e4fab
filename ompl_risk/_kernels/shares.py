"""What a piece of a motion adds to the risk, once it is short enough."""

from __future__ import annotations

from ompl_risk._kernels.integrand import FAR, NUMBERS, avoid, reach
from ompl_risk._kernels.jit import kernel

COARSE = 0.25
"""Longest piece of a motion, in lengths over which f changes: clearances, if it has a pole."""

FINE = 0.5
"""Pieces shorter than so many such lengths times the tolerance are not halved again: this ends the
halving at kinks of f, where it converges only in proportion to the length."""

BLIND = 0.1
"""Longest piece with no risk at its ends and middle, but perhaps some between, in clearances."""

# places in the parameters, behind those of the integrand
RADIUS, SPEED, POWER, TAU, TOLERANCE, WEIGHT, SMALL = range(NUMBERS, NUMBERS + 7)
PARAMETERS = NUMBERS + 7
"""Numbers in the parameters; ``SMALL`` is a value of f^p that hardly counts."""


@kernel
def _piece(f0, f1, dt, p, tau):
    """Integral of f^p + tau^2 f'^2 for f linear over dt; exact for p = 1 and 2, else Simpson."""
    if p == 2.0:
        rise = f1 - f0
        return dt * (f0 * f0 + f0 * f1 + f1 * f1) / 3.0 + tau * tau * rise * rise / dt
    if p == 1.0:
        return 0.5 * dt * (f0 + f1)
    return dt * (f0**p + 4.0 * (0.5 * (f0 + f1)) ** p + f1**p) / 6.0


@kernel
def settled(d0, d, d1, h, dt, given):
    """Share of a piece in the integral of f^p + tau^2 f'^2, or -1 if it must be halved.

    Args:
        d0, d, d1: clearances at its beginning, in its middle and at its end [m].
        h: how far the vehicle can move on it [m].
        dt: its duration [s].
        given: the parameters.
    """
    p, tau, tolerance = given[POWER], given[TAU], given[TOLERANCE]
    far = given[FAR]
    near = min(d0, d, d1, far)
    length = reach(near, given)
    if h > COARSE * length or 0.5 * h >= d + min(d0, d1):  # else d is positive everywhere
        return -1.0
    if dt <= 0.0:
        return 0.0
    f0, f, f1 = avoid(d0, given), avoid(d, given), avoid(d1, given)
    once = _piece(f0, f1, dt, p, tau)
    twice = _piece(f0, f, 0.5 * dt, p, tau) + _piece(f, f1, 0.5 * dt, p, tau)
    change = twice - once
    exact = abs(change) <= tolerance * (twice + given[SMALL] * dt)
    if tau > 0.0 and near < far < max(d0, d, d1):
        exact = False  # f' jumps at d0, and close to an end of the piece the change hardly shows it
    if h <= FINE * tolerance * length or (exact and (twice > 0.0 or h <= BLIND * near)):
        return max(twice + change / 3.0, 0.0)
    return -1.0
