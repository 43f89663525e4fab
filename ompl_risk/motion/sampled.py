"""Motions for any clearance: the same halving as in compiled code, a batch of queries at a time."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._interpolation import great_arc
from ompl_risk._kernels.motion import BLIND, COARSE, CONTACT, FINE, FIRST, NEAR
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.base import MotionModel, Risk
from ompl_risk.norms.lp import mean_power

Floats = NDArray[np.float64]


class _Pieces(NamedTuple):
    """Pieces of a motion: ends as fractions of it, clearances there [m]."""

    s0: Floats
    s1: Floats
    d0: Floats
    d1: Floats

    def where(self, keep: NDArray[np.bool_]) -> _Pieces:
        return _Pieces(*(column[keep] for column in self))

    @property
    def between(self) -> Floats:
        """The middles of the pieces."""
        return 0.5 * (self.s0 + self.s1)

    def halved(self, keep: NDArray[np.bool_], middle: Floats) -> _Pieces:
        """Both halves of the pieces to keep; ``middle`` holds the clearances in between."""
        s0, s1, d0, d1 = self.where(keep)
        d, s = middle[keep], 0.5 * (s0 + s1)
        return _Pieces(*(np.concatenate(x) for x in ((s0, s), (s, s1), (d0, d), (d, d1))))


class SampledMotion(MotionModel):
    """``MotionModel`` over anything that maps points to distances.

    The clearance must be 1-Lipschitz in the position, as ``Clearance`` says. Along a motion that
    also turns, a piece's length is what the farthest point of the body can travel, and that length
    divided by the speed is its duration: no point of the body moves faster than the speed.

    Args:
        clearance: callable with points (n, 3) [m], or poses (n, 7) if it ``uses_orientation``.
        risk: how risk is counted.
        width: length of the state buffers.
    """

    def __init__(self, clearance: Any, risk: Risk, width: int = 3) -> None:
        self.a, self.b = np.zeros(width), np.zeros(width)
        self._clearance, self._risk = clearance, risk
        self._posed = bool(getattr(clearance, "uses_orientation", False))
        self._reach = float(getattr(clearance, "reach", 0.0))
        if self._posed and width < 7:
            raise ArgumentError(
                "clearance", clearance, "one that does not use the orientation: states have none"
            )

    def clearance(self) -> float:
        """Clearance d [m] at a."""
        columns = 7 if self._posed else 3
        return float(self._distances(self.a[None, :columns].copy())[0])

    def is_free(self) -> bool:
        """Whether a is free, d > 0."""
        return self.clearance() > 0.0

    def is_motion_free(self) -> bool:
        """Whether every state from a to b is free."""
        travel, pieces = self._whole()
        while len(pieces.s0):
            if min(pieces.d0.min(), pieces.d1.min()) <= CONTACT:
                return False
            open_ = pieces.d0 + pieces.d1 <= (pieces.s1 - pieces.s0) * travel + CONTACT
            middle = np.full(len(open_), np.nan)
            middle[open_] = self._along(pieces.between[open_])
            pieces = pieces.halved(open_, middle)
        return True

    def cost(self) -> float:
        """Cost of the motion from a to b."""
        if math.isinf(self._risk.exponent):
            return self._maximum()
        duration = self._travel / self._risk.speed
        return self._power(duration) + self._risk.weight * duration

    def heuristic(self) -> float:
        """Lower bound for the cost of any way from a to b."""
        least = self._risk.weight * self._travel / self._risk.speed
        d = self._along(np.array([0.0, 1.0]))
        if d.min() <= CONTACT:
            return least
        f0, f1 = self._risk.avoidance(d)
        if math.isinf(self._risk.exponent):
            return float(max(f0, f1))
        return float(least + self._risk.time_scale * abs(f1 * f1 - f0 * f0))

    def _power(self, duration: float) -> float:
        """Integral of f^p + tau^2 f'^2 by halving, see the compiled kernel of the same name."""
        risk, far, total = self._risk, self._risk.avoidance.d0, 0.0
        travel, pieces = self._whole()
        if min(pieces.d0.min(), pieces.d1.min()) <= CONTACT:
            return math.inf
        negligible = 1e-3 * far**-risk.exponent
        while len(pieces.s0):
            h = (pieces.s1 - pieces.s0) * travel
            pieces = pieces.where(pieces.d0 + pieces.d1 - h < 2.0 * far)
            if not len(pieces.s0):
                break
            h, dt = (pieces.s1 - pieces.s0) * travel, (pieces.s1 - pieces.s0) * duration
            middle = self._along(pieces.between)
            if middle.min() <= CONTACT:
                return math.inf
            once = self._shares(pieces.d0, pieces.d1, dt)
            twice = self._shares(pieces.d0, middle, dt / 2)
            twice += self._shares(middle, pieces.d1, dt / 2)
            change, near = twice - once, np.minimum(np.minimum(pieces.d0, pieces.d1), middle)
            near = np.minimum(near, far)
            exact = np.abs(change) <= risk.tolerance * (twice + negligible * dt)
            exact &= (twice > 0.0) | (h <= BLIND * near)
            done = (h <= COARSE * near) & (exact | (h <= FINE * risk.tolerance * near))
            total += float(np.maximum(twice + change / 3.0, 0.0)[done].sum())
            pieces = pieces.halved(~done, middle)
        return total

    def _shares(self, d0: Floats, d1: Floats, dt: Floats) -> Floats:
        """Integrals of f^p + tau^2 f'^2 over pieces on which f is linear."""
        f0, f1 = self._risk.avoidance(d0), self._risk.avoidance(d1)
        shares = dt * mean_power(f0, f1, self._risk.exponent)
        if self._risk.time_scale > 0.0:
            rate = np.divide(self._risk.time_scale * (f1 - f0), dt, where=dt > 0.0, out=0.0 * dt)
            shares = shares + dt * rate * rate
        return shares

    def _maximum(self) -> float:
        """Maximum of f along the motion, to the tolerance."""
        far = self._risk.avoidance.d0
        travel, pieces = self._whole()
        least = min(pieces.d0.min(), pieces.d1.min())
        while len(pieces.s0):
            if least <= CONTACT:
                return math.inf
            h = (pieces.s1 - pieces.s0) * travel
            slack = self._risk.tolerance * max(least, NEAR * far)
            lowest = min(max(least - slack, 0.5 * CONTACT), far)
            open_ = 0.5 * (pieces.d0 + pieces.d1 - h) < lowest
            middle = np.full(len(open_), np.inf)
            if open_.any():
                middle[open_] = self._along(pieces.between[open_])
            least = min(least, float(middle.min()))
            pieces = pieces.halved(open_, middle)
        return float(self._risk.avoidance(np.array([least]))[0])

    @property
    def _travel(self) -> float:
        """What the farthest point of the body can travel from a to b [m]."""
        travel = float(np.linalg.norm(self.b[:3] - self.a[:3]))
        if self._posed:
            cosine = min(abs(float(self.a[3:7] @ self.b[3:7])), 1.0)
            travel += self._reach * 2.0 * math.acos(cosine)
        return travel

    def _whole(self) -> tuple[float, _Pieces]:
        """What the farthest point of the body can travel [m], and the motion in two pieces."""
        travel = self._travel
        d = self._along(np.array([0.0, FIRST, 1.0]))
        return travel, _Pieces(np.array([0.0, FIRST]), np.array([FIRST, 1.0]), d[:2], d[1:])

    def _along(self, s: Floats) -> Floats:
        """Clearances [m] at fractions s of the motion."""
        if not len(s):
            return np.empty(0)
        points = self.a[:3] + s[:, None] * (self.b[:3] - self.a[:3])
        if self._posed:
            points = np.hstack(
                [points, great_arc(s, np.array([0.0, 1.0]), np.array([self.a[3:7], self.b[3:7]]))]
            )
        return self._distances(np.ascontiguousarray(points))

    def _distances(self, queries: Floats) -> Floats:
        d = np.asarray(self._clearance(queries), dtype=np.float64)
        if d.shape != (len(queries),):
            raise ArgumentError("clearance(points).shape", d.shape, f"({len(queries)},)")
        if np.isnan(d).any():
            row = int(np.flatnonzero(np.isnan(d))[0])
            raise ArgumentError(
                "clearance(points)", math.nan, f"a distance, also at {queries[row].tolist()}"
            )
        return d
