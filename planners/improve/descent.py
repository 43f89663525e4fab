"""Newton descent of a path's cost within a box and a duration."""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.chain import solve_chain
from ompl_risk.planners.improve.chain import Chain, Point

STEPS = 100
"""Most steps of a descent."""

CALM = 1e-3
"""A step that saves less than this share of the cost counts as calm; three in a row end it."""

TRIALS = 10
"""Most step sizes that are tried before a descent ends."""

DAMPING = 1e-2
"""At first; in units of the stiffness that a price of the path's mean cost for time would give."""

FLOOR = 0.02
"""Least price of time in second derivatives, in the path's mean cost: legs without risk resist."""


AIM = 1.0 - 1e-5
"""Descents aim at this share of the longest duration, to end below it."""


class Limits(NamedTuple):
    """What a path has to keep to.

    Attributes:
        low, high: box, shape (3,) [m].
        longest: duration [s].
        deadline: computing ends at this time.monotonic() [s].
    """

    low: FloatArray
    high: FloatArray
    longest: float
    deadline: float


class Descent:
    """Lowers the cost of a path subject to duration <= longest, corners in the box, ends fixed.

    Each step solves the quadratic model ::

        min  g.p + p.(H + price T'' + damping)p / 2   subject to   duration + t.p <= longest

    with g and t the gradients of cost and duration and H, T'' positive semidefinite second
    derivatives, all block-tridiagonal, so that a step costs as much as a few evaluations. The
    multiplier of the constraint is the price of a second [cost / s]. A step counts if it lowers
    ``cost + 2 price max(duration - longest, 0)``; else it is tried with more damping, which
    resists bending of the path, so that corners move together (the covariant metric of CHOMP).

    Args:
        chain: the cost.
        limits: see there.
        steps: at most so many.

    Reference:
        Ratliff, Zucker, Bagnell and Srinivasa, CHOMP: Gradient optimization techniques for
        efficient motion planning, ICRA 2009, for the metric; Nocedal and Wright, Numerical
        Optimization, chapter 18, for the sequential quadratic programme.
    """

    def __init__(self, chain: Chain, limits: Limits, *, steps: int = STEPS) -> None:
        self._chain, self._limits, self._aim = chain, limits, AIM * limits.longest
        self._price, self._damping = 0.0, DAMPING
        self._steps = steps

    def run(self, corners: FloatArray) -> FloatArray | None:
        """The cheapest path met that keeps to the duration; None if there was none."""
        point = self._chain.at(corners)
        self._price = point.cost / point.duration
        best, calm = self._better(None, point), 0
        for _ in range(self._steps):
            following = None if calm >= 3 or self._late() else self._step(point)
            if following is None:
                break
            saved = self._merit(point) - self._merit(following)
            kept = following.duration <= self._limits.longest
            calm = calm + 1 if kept and saved < CALM * point.cost else 0
            point = following
            best = self._better(best, point)
        return None if best is None else best.corners

    def _step(self, point: Point) -> Point | None:
        """The next path; None if no step lowers the cost."""
        mean = point.cost / point.duration
        stiff = max(self._price, FLOOR * mean)
        diagonal, coupling = self._chain.curvature(point)
        rate = np.maximum(stiff + point.by_leg, 0.3 * stiff)
        _add_tension(diagonal, coupling, point, rate, stiff)
        for attempt in range(TRIALS):
            trial = self._trial(point, diagonal.copy(), coupling.copy(), mean)
            if trial is not None:
                self._damping /= 3.0 if attempt == 0 else 1.0
                return trial
            self._damping *= 4.0
            if self._late():
                return None
        return None

    def _trial(
        self, point: Point, diagonal: FloatArray, coupling: FloatArray, mean: float
    ) -> Point | None:
        """A step with the present damping; None if it lowers nothing."""
        push = self._damping * mean
        _add_tension(diagonal, coupling, point, push, push)
        typical = point.duration / (len(point.corners) - 1)
        diagonal += 1e-3 * push / (typical * _speed(point) ** 2) * np.eye(3)
        slope = point.by_corners + self._price * point.longer
        low, high = self._limits.low, self._limits.high
        fixed = ((point.corners <= low) & (slope > 0.0)) | ((point.corners >= high) & (slope < 0.0))
        right = np.stack([-point.by_corners, -point.longer])
        found = np.empty_like(right)
        if solve_chain(diagonal, coupling, fixed, right, found):
            price = self._price_of(point, found, mean)
            moved = point.corners + found[0] + price * found[1]
            moved[1:-1] = np.clip(moved[1:-1], low, high)
            trial = self._chain.at(moved)
            old_price, self._price = self._price, max(price, self._price)
            gain = self._merit(point) - self._merit(trial)
            if gain > 0.0:
                self._price = price
                return trial
            self._price = old_price
        return None

    def _price_of(self, point: Point, found: FloatArray, mean: float) -> float:
        """The multiplier with which the model's step ends at the longest duration, 0 or more."""
        late = point.duration - self._aim
        late += max(late, 0.0)  # a step ends later than its tangent: aim as far on the other side
        excess = late + float((point.longer * found[0]).sum())
        per_price = -float((point.longer * found[1]).sum())
        most = max(10.0 * self._price, mean)
        return min(max(excess / per_price, 0.0), most) if per_price > 0.0 else most

    def _merit(self, point: Point) -> float:
        return point.cost + 2.0 * self._price * max(point.duration - self._aim, 0.0)

    def _better(self, best: Point | None, point: Point) -> Point | None:
        if point.duration > self._limits.longest or not np.isfinite(point.cost):
            return best
        return point if best is None or point.cost < best.cost else best

    def _late(self) -> bool:
        return time.monotonic() > self._limits.deadline


def _speed(point: Point) -> float:
    return float(point.legs.sum()) / point.duration


def _add_tension(
    diagonal: FloatArray,
    coupling: FloatArray,
    point: Point,
    across: FloatArray | float,
    along: float,
) -> None:
    """Add the second derivatives of a price of time: `across` the legs, and `along` them.

    A second derivative of the duration along the legs is zero; with one the corners keep apart.
    """
    speed, u = _speed(point), point.along
    lateral = (across / (speed * point.legs))[:, None, None] * np.eye(3)
    twist = ((along - across) / (speed * point.legs))[:, None, None]
    block = lateral + twist * (u[:, :, None] * u[:, None, :])
    diagonal[:-1] += block
    diagonal[1:] += block
    coupling -= block
