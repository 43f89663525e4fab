"""Moving obstacles as the arrays that kernels read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats
from ompl_risk._kernels.moving import (
    CENTRE,
    CORNER,
    HALF,
    REACH,
    ROUND,
    SIZES,
    Tracks,
    greatest_speeds,
)
from ompl_risk.errors import ArgumentError


class Body(Protocol):
    """What is packed of an obstacle; see ``MovingObstacle``."""

    times: FloatArray
    positions: FloatArray
    orientations: FloatArray
    rounding: float

    @property
    def box(self) -> FloatArray:
        """A box about the body."""
        ...

    @property
    def reach(self) -> float:
        """Farthest point of the body from its origin."""
        ...


def packed(obstacles: Sequence[Body]) -> Tracks:
    """The obstacles as arrays, which are read-only."""
    counts = [len(obstacle.times) + 1 for obstacle in obstacles]
    times, places, turned, velocities, axes, rates = (
        np.concatenate(columns) for columns in zip(*map(_rows, obstacles), strict=True)
    )
    tracks = Tracks(
        first=np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        times=times,
        places=places,
        turned=turned,
        velocities=velocities,
        axes=axes,
        rates=rates,
        sizes=np.array([_sizes(obstacle) for obstacle in obstacles]),
        swept=np.array([_swept(obstacle) for obstacle in obstacles]),
    )
    for array in tracks:
        array.setflags(write=False)
    return tracks


def _rows(obstacle: Body) -> tuple[FloatArray, ...]:
    """Rows of the arrays of ``Tracks``, in their order; the first row stands still."""
    from scipy.spatial.transform import Rotation

    t, p, q = obstacle.times, obstacle.positions, obstacle.orientations
    dt = np.diff(t)
    rotation = Rotation.from_quat(q)
    turns = (rotation[:-1].inv() * rotation[1:]).as_rotvec()
    angles = np.linalg.norm(turns, axis=1)
    axes = np.divide(turns, angles[:, None], where=angles[:, None] > 0.0, out=np.zeros_like(turns))
    still = np.zeros((1, 3))
    held = np.concatenate([[0], np.arange(len(t))])
    return (
        np.concatenate([[-np.inf], t]),
        p[held],
        rotation.as_quat()[held],
        np.vstack([still, np.diff(p, axis=0) / dt[:, None], still]),
        np.vstack([still, axes, still]),
        np.concatenate([[0.0], angles / dt, [0.0]]),
    )


def _sizes(obstacle: Body) -> FloatArray:
    sizes, (low, high) = np.zeros(SIZES), obstacle.box
    sizes[HALF : HALF + 3], sizes[CENTRE : CENTRE + 3] = 0.5 * (high - low), 0.5 * (high + low)
    sizes[ROUND], sizes[REACH] = obstacle.rounding, obstacle.reach
    sizes[CORNER] = np.linalg.norm(np.maximum(np.abs(low), np.abs(high)))
    return sizes


def _swept(obstacle: Body) -> FloatArray:
    """A box that holds the body at all times: least and greatest corner, shape (6,)."""
    margin = float(np.linalg.norm(np.abs(obstacle.box).max(axis=0))) + obstacle.rounding
    p = obstacle.positions
    return np.concatenate([p.min(axis=0) - margin, p.max(axis=0) + margin])


def as_times(name: str, times: ArrayLike, n: int) -> FloatArray:
    """Times [s], one for each of n rows; a single one serves all.

    Raises:
        ArgumentError: another shape, or a number that is not finite.
    """
    array = as_floats(name, times)
    if array.shape not in ((), (n,)):
        raise ArgumentError(f"{name}.shape", array.shape, f"() or ({n},): a time for each point")
    if not np.isfinite(array).all():
        raise ArgumentError(name, float(array[~np.isfinite(array)].flat[0]), "finite times [s]")
    return np.ascontiguousarray(np.broadcast_to(array, (n,)))


def greatest_speed(tracks: Tracks, t0: ArrayLike, t1: ArrayLike) -> Any:
    """Greatest speed [m/s] of any point of any obstacle from t0 to t1; shape as theirs.

    Raises:
        ArgumentError: a time that is NaN, or t1 before t0.
    """
    begin, end = span(t0, t1)
    out = np.empty(len(begin))
    greatest_speeds(tracks, begin, end, out)
    return float(out[0]) if np.ndim(t0) == np.ndim(t1) == 0 else out


def span(t0: ArrayLike, t1: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Begins and ends of spans of time [s], of one length; infinite ones are allowed.

    Raises:
        ArgumentError: shapes that do not fit each other, NaN, or an end before its begin.
    """
    begin, end = np.atleast_1d(as_floats("t0", t0), as_floats("t1", t1))
    counts = (begin.size, end.size)
    if begin.ndim != 1 or end.ndim != 1 or (counts[0] != counts[1] and 1 not in counts):
        raise ArgumentError("t1.shape", end.shape, f"{begin.shape}, as t0, or a single time")
    begin, end = (np.ascontiguousarray(part) for part in np.broadcast_arrays(begin, end))
    wrong = np.flatnonzero(~(begin <= end))
    if len(wrong):
        i = int(wrong[0])
        raise ArgumentError(
            "(t0, t1)", (float(begin[i]), float(end[i])), "in order of time, no NaN"
        )
    return begin, end
