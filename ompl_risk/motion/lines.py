"""Straight motions, many at a time: where they lead, and what a clearance says on the way."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError

BLOCK = 16_384
"""Most queries that a clearance is asked at a time: bounds the memory that its answer takes."""


class Distances:
    """A clearance whose answers are checked, asked about states of a certain width.

    Args:
        clearance: callable with points (n, 3) [m], or poses (n, 7) if it ``uses_orientation``.
        width: numbers in a state.

    Raises:
        ArgumentError: states without the position or the orientation that the clearance needs.

    Attributes:
        columns: how many of a state's numbers the clearance is asked with, 3 or 7.
        reach: farthest point of the body from its origin [m]; 0 if the orientation is not used.
    """

    def __init__(self, clearance: Any, width: int) -> None:
        posed = bool(getattr(clearance, "uses_orientation", False))
        if isinstance(width, bool) or not isinstance(width, int) or width < 3:
            raise ArgumentError("width", width, "a whole number from 3")
        if posed and width < 7:
            raise ArgumentError(
                "clearance", clearance, "one that does not use the orientation: states have none"
            )
        self.columns = 7 if posed else 3
        self.reach = float(getattr(clearance, "reach", 0.0)) if posed else 0.0
        self._clearance, self._width = clearance, width

    def states(self, name: str, states: FloatArray) -> FloatArray:
        """What the clearance uses of states (n, width): a contiguous copy, (n, columns).

        Raises:
            ArgumentError: another shape, or a number that is not finite.
        """
        array = np.asarray(states, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != self._width:
            raise ArgumentError(f"{name}.shape", array.shape, f"(n, {self._width})")
        array = np.array(array[:, : self.columns], order="C")
        if not np.isfinite(array).all():
            row = int(np.argmin(np.isfinite(array).all(axis=1)))
            raise ArgumentError(f"{name}[{row}]", array[row].tolist(), "finite")
        return array

    def __call__(self, queries: FloatArray) -> FloatArray:
        """Distances [m], shape (n,).

        Raises:
            ArgumentError: the clearance answers with NaN, or with another shape.
        """
        if not len(queries):
            return np.empty(0)
        d = np.asarray(self._clearance(queries), dtype=np.float64)
        if d.shape != (len(queries),):
            raise ArgumentError("clearance(points).shape", d.shape, f"({len(queries)},)")
        if np.isnan(d).any():
            row = int(np.flatnonzero(np.isnan(d))[0])
            raise ArgumentError(
                "clearance(points)", math.nan, f"a distance, also at {queries[row].tolist()}"
            )
        return d


class Lines:
    """Motions from a[k] to b[k], straight, and turning at a constant rate by the shorter arc.

    Args:
        distances: the clearance.
        a: states, shape (n, width).
        b: likewise.

    Attributes:
        travel: what the farthest point of the body can travel [m], shape (n,).
    """

    def __init__(self, distances: Distances, a: FloatArray, b: FloatArray) -> None:
        self._distances = distances
        self._a, b = distances.states("a", a), distances.states("b", b)
        if len(self._a) != len(b):
            raise ArgumentError("b.shape", (len(b), *np.shape(a)[1:]), f"{np.shape(a)}, as a")
        if distances.columns == 7:
            for name, states in (("a", self._a), ("b", b)):
                states[:, 3:] = _unit(name, states[:, 3:])
        self._b, self._along = b, b[:, :3] - self._a[:, :3]
        self.travel = travelled(self._a, b, distances.reach)

    def __len__(self) -> int:
        return len(self.travel)

    def clearances(self, k: NDArray[np.intp], s: FloatArray) -> FloatArray:
        """Clearances [m] at fractions s of the motions k, 0 in collision, shape (m,)."""
        states = self._a[k]
        states[:, :3] += s[:, None] * self._along[k]
        if states.shape[1] == 7:
            states[:, 3:] = turned(states[:, 3:], self._b[k, 3:], s)
        return np.maximum(self._distances(states), 0.0)  # none is -inf: sums of two are no NaN


def travelled(a: FloatArray, b: FloatArray, reach: float) -> FloatArray:
    """What the farthest point of a body can travel from the states a to b [m], shape (n,).

    Args:
        a: positions or poses, the quaternions of unit length, shape (n, width).
        b: likewise.
        reach: distance of that point from the body's origin [m]; 0 leaves out the turning.
    """
    way = b[:, :3] - a[:, :3]
    travel = np.sqrt((way * way).sum(axis=1))
    if reach > 0.0:
        travel += reach * 2.0 * _half_angle(a[:, 3:7], b[:, 3:7])[1]
    return travel


def turned(q0: FloatArray, q1: FloatArray, s: FloatArray) -> FloatArray:
    """The quaternions at fractions s of the shorter arc from q0 to q1.

    ::

        q = (sin((1 - s) w) q0 + sin(s w) q1) / sin(w),    w = half the angle of the rotation

    Args:
        q0: unit quaternions, shape (n, 4).
        q1: likewise.
        s: fractions, shape (n,).
    """
    q1, w = _half_angle(q0, q1)
    sine = np.where(w > 1e-8, np.sin(w), 1.0)
    share0 = np.where(w > 1e-8, np.sin((1.0 - s) * w) / sine, 1.0 - s)
    share1 = np.where(w > 1e-8, np.sin(s * w) / sine, s)
    q = share0[:, None] * q0 + share1[:, None] * q1
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def _half_angle(q0: FloatArray, q1: FloatArray) -> tuple[FloatArray, FloatArray]:
    """q1 or -q1, whichever is nearer to q0, and the angle between the two [rad]."""
    q1 = np.where((q0 * q1).sum(axis=1, keepdims=True) < 0.0, -q1, q1)
    # The arc cosine of the product would be off by 1e-8 at small angles.
    apart, together = np.linalg.norm(q1 - q0, axis=1), np.linalg.norm(q1 + q0, axis=1)
    return q1, 2.0 * np.arctan2(apart, together)


def _unit(name: str, quaternions: FloatArray) -> FloatArray:
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    if (length == 0.0).any():
        row = int(np.flatnonzero(length == 0.0)[0])
        raise ArgumentError(f"{name}[{row}][3:7]", quaternions[row].tolist(), "a unit quaternion")
    return quaternions / length
