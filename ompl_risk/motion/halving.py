"""Collision checks and risks of many motions by halving them, in steps that all take together.

All rest on one fact: d changes along a motion by at most the distance travelled. Between two
samples h apart with clearances d0 and d1 it therefore stays above ``(d0 + d1 - h) / 2``. The
compiled kernels decide likewise, a motion at a time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.motion import CONTACT, FIRST, NEAR
from ompl_risk._kernels.shares import BLIND, COARSE, FINE
from ompl_risk._pieces import Pieces
from ompl_risk.motion.base import Risk
from ompl_risk.motion.lines import BLOCK
from ompl_risk.norms.lp import mean_power

SAMPLES = np.array([0.0, FIRST, 1.0])
"""Where motions are sampled before the halving begins."""


class Motions(Protocol):
    """Many motions, as ``Lines``: what halving needs to know of them.

    Attributes:
        travel: how far each can take any point of the body [m], shape (n,); so far also between
            any two fractions of it, times their difference.
    """

    travel: FloatArray

    def __len__(self) -> int: ...

    def clearances(self, k: NDArray[np.intp], s: FloatArray) -> FloatArray:
        """Clearances [m] at fractions s of the motions k, 0 in collision, shape (m,)."""
        ...


def _lengths(pieces: Pieces, lines: Motions) -> FloatArray:
    """Distances travelled on them [m]."""
    return (pieces.s1 - pieces.s0) * lines.travel[pieces.k]


def are_free(lines: Motions) -> NDArray[np.bool_]:
    """Whether every state of the motions is free, for certain; shape (n,)."""
    least, pieces = _begun(lines)
    free = least > CONTACT

    def step(pieces: Pieces) -> Pieces:
        near = pieces.d0 + pieces.d1 <= _lengths(pieces, lines) + CONTACT
        pieces = pieces.chosen(near & free[pieces.k])
        if not len(pieces.k):
            return pieces
        d = lines.clearances(pieces.k, pieces.middle)
        free[pieces.k[d <= CONTACT]] = False
        return pieces.halved(d)

    _refine(pieces, step)
    return free


def maxima(lines: Motions, risk: Risk) -> FloatArray:
    """Maxima of f along the motions, to the tolerance; inf in collision, shape (n,)."""
    far, steady, tolerance = risk.avoidance.d0, risk.avoidance.steady, risk.tolerance
    least, pieces = _begun(lines)

    def step(pieces: Pieces) -> Pieces:
        found = least[pieces.k]
        length = np.clip(found, NEAR * far, far) if steady is None else COARSE * steady
        enough = found - tolerance * length
        enough = np.minimum(np.maximum(enough, 0.5 * CONTACT), far)
        lowest = 0.5 * (pieces.d0 + pieces.d1 - _lengths(pieces, lines))
        pieces = pieces.chosen((lowest < enough) & (found > CONTACT))
        if not len(pieces.k):
            return pieces
        d = lines.clearances(pieces.k, pieces.middle)
        np.minimum.at(least, pieces.k, d)
        return pieces.halved(d)

    _refine(pieces, step)
    least[least <= CONTACT] = 0.0
    return risk.avoidance(least)


def powers(lines: Motions, risk: Risk, seconds: FloatArray | None = None) -> FloatArray:
    """Integrals of f^p + tau^2 f'^2 along the motions; inf in collision, shape (n,).

    A piece is accepted once halving it changes its share by less than the tolerance; the
    difference also extrapolates it. Ripples of f that are short against the clearance can be
    missed, not so collisions.

    Args:
        lines: the motions.
        risk: how risk is counted.
        seconds: their durations [s], shape (n,); None: those at ``risk.speed``.
    """
    far, n = risk.avoidance.d0, len(lines)
    seconds = lines.travel / risk.speed if seconds is None else seconds
    least, pieces = _begun(lines)
    total = np.where(least > CONTACT, 0.0, math.inf)

    def step(pieces: Pieces) -> Pieces:
        nonlocal total
        h = _lengths(pieces, lines)
        near = (pieces.d0 + pieces.d1 - h < 2.0 * far) & (total[pieces.k] < math.inf)
        pieces, h = pieces.chosen(near), h[near]
        if not len(pieces.k):
            return pieces
        d = lines.clearances(pieces.k, pieces.middle)
        if d.min() <= CONTACT:
            total[pieces.k[d <= CONTACT]] = math.inf
            flown = total[pieces.k] < math.inf
            pieces, h, d = pieces.chosen(flown), h[flown], d[flown]
        dt = (pieces.s1 - pieces.s0) * seconds[pieces.k]
        done, shares = _settled(pieces, h, dt, d, risk)
        total += np.bincount(pieces.k[done], shares[done], minlength=n)
        return pieces.chosen(~done).halved(d[~done])

    _refine(pieces, step)
    return total


def _settled(
    pieces: Pieces, h: FloatArray, dt: FloatArray, d: FloatArray, risk: Risk
) -> tuple[NDArray[np.bool_], FloatArray]:
    """Which pieces need not be halved again, and the shares of all.

    Args:
        pieces: the pieces.
        h: their lengths [m].
        dt: their durations [s].
        d: clearances in their middles [m].
        risk: how risk is counted.
    """
    ends, far = np.minimum(pieces.d0, pieces.d1), risk.avoidance.d0
    near = np.minimum(np.minimum(ends, d), far)
    length = near if risk.avoidance.steady is None else risk.avoidance.steady
    f0, f, f1 = risk.avoidance(np.stack([pieces.d0, d, pieces.d1]))
    once = _integrals(f0, f1, dt, risk)
    twice = _integrals(f0, f, 0.5 * dt, risk) + _integrals(f, f1, 0.5 * dt, risk)
    change = twice - once
    exact = np.abs(change) <= risk.tolerance * (twice + risk.negligible * dt)
    exact &= (twice > 0.0) | (h <= BLIND * near)
    if risk.time_scale > 0.0:  # f' jumps at d0: see the kernel
        exact &= (near >= far) | (np.maximum(np.maximum(pieces.d0, pieces.d1), d) <= far)
    done = (h <= COARSE * length) & (exact | (h <= FINE * risk.tolerance * length))
    done &= 0.5 * h < d + ends  # so d is positive everywhere
    return done, np.maximum(twice + change / 3.0, 0.0)


def _integrals(f0: FloatArray, f1: FloatArray, dt: FloatArray, risk: Risk) -> FloatArray:
    """Integrals of f^p + tau^2 f'^2 over pieces on which f is linear."""
    p, tau = risk.exponent, risk.time_scale
    if p == 2.0:
        integrals = dt * (f0 * f0 + f0 * f1 + f1 * f1) / 3.0
    else:
        integrals = 0.5 * dt * (f0 + f1) if p == 1.0 else dt * mean_power(f0, f1, p)
    if tau > 0.0:
        rise = tau * (f1 - f0)
        integrals += np.divide(rise * rise, dt, where=dt > 0.0, out=np.zeros_like(dt))
    return integrals


def _begun(lines: Motions) -> tuple[FloatArray, Pieces]:
    """The least clearances found [m], shape (n,), and the motions in two pieces each.

    A piece that has an end in contact may be among them.
    """
    n = len(lines)
    k, at = np.concatenate((np.arange(n),) * 3), SAMPLES.repeat(n)
    d = lines.clearances(k, at)
    pieces = Pieces(k[n:], at[: 2 * n], at[n:], d[: 2 * n], d[n:])
    return d.reshape(3, n).min(axis=0), pieces


def _refine(pieces: Pieces, step: Callable[[Pieces], Pieces]) -> None:
    """Call ``step``, which settles some pieces and returns the halves of the others, until all are.

    No more than ``BLOCK`` are taken at a time, the last that came first: a long motion a hand's
    breadth above the ground may need millions, but never all at once.
    """
    waiting = [pieces]
    while waiting:
        pieces = waiting.pop()
        if len(pieces.k) > BLOCK:
            waiting.append(pieces.chosen(slice(BLOCK, None)))
            pieces = pieces.chosen(slice(BLOCK))
        halves = step(pieces)
        if len(halves.k):
            waiting.append(halves)
