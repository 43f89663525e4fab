"""Risk of motions that a steering chooses, from that of their straight pieces."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.base import Risk
from ompl_risk.motion.batch import MotionBatch
from ompl_risk.motion.choice import motion_batch
from ompl_risk.motion.steering import Steering, StraightSteering
from ompl_risk.motion.ways import Ways
from ompl_risk.norms import Lp

STILL = 1e-9
"""A piece that travels less than this fraction of what it could is taken to hover."""

HASTE = 1e-6
"""By how much a piece may be faster than allowed: rounding."""


class SteeredBatch(MotionBatch):
    """``MotionBatch`` whose motions are the connections of a ``Steering``.

    A straight piece that takes c times as long as at full speed, ``c = dt * speed / length >= 1``,
    adds ::

        c * L + (S - L) / c,    L = integral of f^p dt,  S = integral of f^p + tau^2 f'^2 dt,

    with L and S at full speed: exact for constant speed on each piece, and as accurate as these.
    For a Sobolev norm every piece is therefore evaluated twice. A piece without length hovers and
    adds ``f^p * dt``. ``Lp(inf)`` does not depend on speed.

    The connections of the last pairs asked about are kept, so that costs, durations and samples of
    the same pairs connect them once.

    Args:
        steering: chooses the motions.
        clearance: callable with points (n, 3) [m], or poses (n, 7) if it ``uses_orientation``.
        risk: how risk is counted; no piece of a connection may be faster than its speed.
        width: numbers in a state.
        threads: of compiled code, at most; ``None`` uses all processors.

    Raises:
        ArgumentError: no steering, or as for ``motion_batch``; later: a connection that breaks
            the duties of a steering.
    """

    compiled = False

    def __init__(
        self,
        steering: Steering,
        clearance: Any,
        risk: Risk,
        width: int = 3,
        *,
        threads: int | None = None,
    ) -> None:
        if not isinstance(steering, Steering):
            raise ArgumentError("steering", steering, "a Steering, as StraightSteering(speed)")
        self.steering, self.width, self.symmetric = steering, width, bool(steering.symmetric)
        self._risk = risk
        pure = replace(risk, duration_weight=0.0)
        self._straight = motion_batch(clearance, risk, width, threads=threads)
        self._whole = motion_batch(clearance, pure, width, threads=threads)
        level = replace(pure, norm=Lp(risk.exponent))
        self._level = motion_batch(clearance, level, width, threads=threads)
        self._last: tuple[FloatArray, FloatArray, Ways] | None = None

    def clearances(self, states: FloatArray) -> FloatArray:
        """Clearances d [m], shape (n,)."""
        return self._straight.clearances(states)

    def are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        """Whether there is a way from a[k] to b[k] and every state of it is free, shape (n,)."""
        ways = self._ways(a, b)
        free = ways.exist
        free[ways.owner[~self._straight.are_free(ways.tails, ways.heads)]] = False
        return free

    def costs(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Costs of the ways from a[k] to b[k], inf in collision or without one, shape (n,)."""
        ways = self._ways(a, b)
        costs = np.where(ways.exist, 0.0, math.inf)
        if math.isinf(self._risk.exponent):
            maxima = self._whole.costs(ways.tails, ways.heads)
            np.maximum.at(costs, ways.owner, maxima)
            return costs
        costs += np.bincount(ways.owner, self._shares(ways), minlength=len(ways))
        costs[ways.exist] += self._risk.weight * ways.durations[ways.exist]
        return costs

    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Durations [s] of the ways from a[k] to b[k], inf where there is none, shape (n,)."""
        return self._ways(a, b).durations.copy()

    def heuristics(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> FloatArray:
        """Lower bounds for the cost of any way from a[k] to b[k]: as for straight motions."""
        return self._straight.heuristics(a, b, d_a, d_b)

    def least_durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Lower bounds for the duration [s] of any way: straight at full speed, shape (n,)."""
        return self._straight.durations(a, b)

    def samples(self, a: FloatArray, b: FloatArray) -> list[FloatArray]:
        """States that the ways pass at equal time steps, see ``MotionBatch``; read-only."""
        return list(self._ways(a, b).samples)

    def _shares(self, ways: Ways) -> FloatArray:
        """What the pieces add to the p-th power of the norm; inf in collision."""
        level = self._level.costs(ways.tails, ways.heads)
        whole = level if self._risk.time_scale == 0.0 else self._whole.costs(ways.tails, ways.heads)
        shares = np.full(len(level), math.inf)
        quickest = self._straight.durations(ways.tails, ways.heads)
        still = quickest <= STILL * ways.seconds
        free = np.isfinite(level) & np.isfinite(whole)
        moves = free & ~still
        c = ways.seconds[moves] / quickest[moves]
        change = np.maximum(whole[moves] - level[moves], 0.0)
        shares[moves] = c * level[moves] + change / c
        hovers = free & still
        f = self._risk.avoidance(self._straight.clearances(ways.tails[hovers]))
        shares[hovers] = ways.seconds[hovers] * f**self._risk.exponent
        return shares

    def _ways(self, a: FloatArray, b: FloatArray) -> Ways:
        """The connections, each made once."""
        for name, states in (("a", a), ("b", b)):
            if np.shape(states) != (len(a), self.width):
                allowed = f"(n, {self.width}), the same for a and b"
                raise ArgumentError(f"{name}.shape", np.shape(states), allowed)
        if self._last is not None:
            last_a, last_b, ways = self._last
            if np.array_equal(a, last_a) and np.array_equal(b, last_b):
                return ways
        ways = Ways.joining(self.steering, a, b)
        self._check_speed(ways)
        self._last = (np.array(a), np.array(b), ways)
        return ways

    def _check_speed(self, ways: Ways) -> None:
        """The implementer's third duty: the lower bounds rely on it."""
        quickest = self._straight.durations(ways.tails, ways.heads)
        hasty = np.flatnonzero(quickest > (1.0 + HASTE) * ways.seconds + STILL)
        if not len(hasty):
            return
        k, speed = int(hasty[0]), self._risk.speed
        found = speed * quickest[k] / ways.seconds[k] if ways.seconds[k] > 0.0 else math.inf
        raise ArgumentError(
            f"speed of steering.connect(a, b) from {ways.tails[k].tolist()}",
            float(found),
            f"at most risk.speed = {speed:g} m/s",
        )


def steered_batch(
    steering: Steering,
    clearance: Any,
    risk: Risk,
    width: int = 3,
    *,
    threads: int | None = None,
) -> MotionBatch:
    """The quickest batch for a steering: ``motion_batch`` if it is a ``StraightSteering``.

    Args:
        steering: chooses the motions.
        clearance: callable with points (n, 3) [m], or poses (n, 7).
        risk: how risk is counted; a slower ``StraightSteering`` flies at its own speed.
        width: numbers in a state.
        threads: of compiled code, at most; ``None`` uses all processors.

    Raises:
        ArgumentError: a ``StraightSteering`` faster than ``risk.speed``, or see ``SteeredBatch``.
    """
    # A derived class may connect otherwise.
    if type(steering) is not StraightSteering:
        return SteeredBatch(steering, clearance, risk, width, threads=threads)
    if steering.speed > risk.speed:
        raise ArgumentError("steering.speed", steering.speed, f"at most risk.speed = {risk.speed}")
    return motion_batch(clearance, replace(risk, speed=steering.speed), width, threads=threads)
