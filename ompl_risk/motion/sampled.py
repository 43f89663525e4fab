"""Motions for any clearance: the same halving as in compiled code, thousands of motions at once."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.motion import CONTACT
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import halving
from ompl_risk.motion.base import Risk
from ompl_risk.motion.batch import MotionBatch
from ompl_risk.motion.lines import BLOCK, Distances, Lines

MOTIONS = 4096
"""Motions that are taken together: enough for large queries, and at three each still one block."""

STEPS = np.arange(9)[:, None, None] / 8
"""Where f is taken for the sum that bounds its integral from below."""


class SampledBatch(MotionBatch):
    """``MotionBatch`` over anything that maps points to distances.

    The clearance must be 1-Lipschitz in the position, as ``Clearance`` says; it is asked up to
    16,384 queries at a time. Along a motion that also turns, a piece's length is what the farthest
    point of the body can travel, and that length divided by the speed is its duration: no point of
    the body moves faster than the speed.

    Args:
        clearance: callable with points (n, 3) [m], or poses (n, 7) if it ``uses_orientation``.
        risk: how risk is counted.
        width: numbers in a state; those beyond the position and orientation do not count.

    Raises:
        ArgumentError: a clearance that needs an orientation, and states that have none; later:
            states of another width or that are not finite, a clearance that answers with NaN or
            in another shape.
    """

    compiled = False

    def __init__(self, clearance: Any, risk: Risk, width: int = 3) -> None:
        self._distances, self._risk = Distances(clearance, width), risk
        self.width = width

    def clearances(self, states: FloatArray) -> FloatArray:
        """Clearances d [m], shape (n,)."""
        queries = self._distances.states("states", states)
        if len(queries) <= BLOCK:
            return self._distances(queries)
        starts = range(0, len(queries), BLOCK)
        return np.concatenate([self._distances(queries[i : i + BLOCK]) for i in starts])

    def are_free(self, a: FloatArray, b: FloatArray) -> NDArray[np.bool_]:
        """Whether every state from a[k] to b[k] is free, shape (n,)."""
        return self._together(halving.are_free, np.empty(len(a), np.bool_), a, b)

    def costs(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Costs of the motions from a[k] to b[k], inf in collision, shape (n,)."""
        return self._together(self._costs, np.empty(len(a)), a, b)

    def durations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Durations [s] of the motions from a[k] to b[k], shape (n,)."""
        return self._together(self._durations, np.empty(len(a)), a, b)

    def heuristics(
        self, a: FloatArray, b: FloatArray, d_a: FloatArray, d_b: FloatArray
    ) -> FloatArray:
        """Lower bounds for the cost of any way from a[k] to b[k], from the clearances there."""
        return self._together(self._bounds, np.empty(len(a)), a, b, d_a, d_b)

    def _costs(self, lines: Lines) -> FloatArray:
        if math.isinf(self._risk.exponent):
            return halving.maxima(lines, self._risk)
        return halving.powers(lines, self._risk) + self._risk.weight * self._durations(lines)

    def _durations(self, lines: Lines) -> FloatArray:
        return lines.travel / self._risk.speed

    def _bounds(self, lines: Lines, d_a: FloatArray, d_b: FloatArray) -> FloatArray:
        """See ``heuristics``.

        Clearances grow no faster than the way, so after s metres d is at most d_a + s, and s metres
        before the end at most d_b + s: f is at least what it is there, since it falls with d. For
        tau > 0 also ``f^2 + tau^2 f'^2 >= tau |(f^2)'|``.
        """
        risk, far = self._risk, self._risk.avoidance.d0
        d = np.minimum(np.array([d_a, d_b]), far)
        d[:, d.min(axis=0) <= CONTACT] = far
        rise = np.minimum(_stretches(lines.travel, d), far - d)
        f = risk.avoidance(d + STEPS * rise)
        if math.isinf(risk.exponent):
            return f[0].max(axis=0)
        step = rise / ((len(STEPS) - 1) * risk.speed)
        power = (step * f[1:] ** risk.exponent).sum(axis=(0, 1))
        if risk.time_scale > 0.0:
            f_a, f_b = f[0]
            power = np.maximum(power, risk.time_scale * np.abs(f_b * f_b - f_a * f_a))
        return power + risk.weight * self._durations(lines)

    def _together(
        self, answer: Callable[..., NDArray[Any]], out: Any, a: FloatArray, *more: FloatArray
    ) -> Any:
        """Ask about some thousand motions after the other."""
        if any(len(column) != len(a) for column in more):
            sizes = [len(column) for column in more]
            raise ArgumentError("rows of the arguments", [len(a), *sizes], "the same number in all")
        for i in range(0, len(a), MOTIONS):
            rows = slice(i, i + MOTIONS)
            b, *d = (column[rows] for column in more)
            out[rows] = answer(Lines(self._distances, a[rows], b), *d)
        return out


def _stretches(travel: FloatArray, d: FloatArray) -> FloatArray:
    """How far the clearances at either end bound those on a way so long [m], shape (2, n)."""
    split = np.minimum(np.maximum(0.5 * (travel + d[1] - d[0]), 0.0), travel)
    return np.array([split, travel - split])
