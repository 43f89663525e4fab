"""Where along a trajectory the distance to obstacles is evaluated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, as_floats
from ompl_risk.avoidance import Avoidance
from ompl_risk.errors import ArgumentError
from ompl_risk.trajectory import Trajectory

Clearance = Callable[..., ArrayLike]
"""points [m], shape (n, 3), to signed distances [m], shape (n,); if the attribute
`uses_orientation` is true, poses (n, 7): x, y, z, qx, qy, qz, qw; if `moves` is true, the times
[s], shape (n,), follow as a second argument."""

RELATIVE_STEP = 0.1
"""Longest step near obstacles, as a part of the distance to them."""
STEADY_STEP, NEAR_STEP = 0.05, 0.25
"""The same where f is bounded, as a part of the length over which it changes, but no more than this
part of the distance: the least distance is then found within 1 %."""
FLOOR = 1e-3
"""Distances below this part of d0 refine the steps no further."""
_MAX_ROUNDS = 30
_MAX_PARTS = 8


@dataclass(frozen=True, eq=False)
class Samples(ReadOnlyArrays):
    """A trajectory, the distance to obstacles along it and the avoidance function.

    Args:
        trajectory: the samples' times and positions, n of them.
        d: signed distances [m], shape (n,).
        f: values of the avoidance function, shape (n,).
    """

    trajectory: Trajectory
    d: FloatArray
    f: FloatArray


def sample(
    trajectory: Trajectory, clearance: Clearance, avoidance: Avoidance, max_step: float | None
) -> Samples:
    """Distances at samples dense enough for the norms of f.

    No step is longer than max_step, nor, where d < d0, than a tenth of d at its ends (of
    d0 / 1000 if d is less): f = 1/d changes on the scale of d. A bounded f changes on the scale of
    its `steady` length, however small d is, and steps may then have a twentieth of that, up to a
    quarter of d. Where d crosses d0, f has a kink: that step is at most d0 / 1000. As d changes at
    most by the length moved, d is then positive between samples at which it is more than
    d0 / 10,000. Where obstacles move, a step is as long as the vehicle moves against any obstacle
    that may come within d0 in that time.

    Args:
        trajectory: the trajectory.
        clearance: distance to obstacles.
        avoidance: the avoidance function.
        max_step: longest step [m]; None takes the trajectory's samples as they are.

    Raises:
        ArgumentError: clearance returns another shape, or NaN.
    """
    if max_step is None:
        d = distances(clearance, trajectory)
        return _samples(trajectory, d, avoidance)
    trajectory = trajectory.densify(max_step)
    d = distances(clearance, trajectory)
    for _ in range(_MAX_ROUNDS):
        parts = _parts_of(trajectory, clearance, d, avoidance, max_step)
        if (parts == 1).all():
            break
        trajectory = trajectory.subdivide(parts)
        old = np.zeros(len(trajectory), dtype=bool)
        old[np.concatenate([[0], np.cumsum(parts)])] = True
        finer = np.empty(len(trajectory))
        finer[old], finer[~old] = d, distances(clearance, trajectory, ~old)
        d = finer
    return _samples(trajectory, d, avoidance)


def sample_uniformly(
    trajectory: Trajectory, clearance: Clearance, avoidance: Avoidance, count: int
) -> Samples:
    """Distances at `count` samples in equal time steps.

    Raises:
        ArgumentError: clearance returns another shape, or NaN.
    """
    times = np.linspace(trajectory.t[0], trajectory.t[-1], count)
    trajectory = trajectory.resample(times)
    return _samples(trajectory, distances(clearance, trajectory), avoidance)


def distances(
    clearance: Clearance, trajectory: Trajectory, chosen: Any = slice(None)
) -> FloatArray:
    """Signed distances [m] at the chosen samples.

    Raises:
        ArgumentError: clearance returns another shape, or NaN.
    """
    by_pose = getattr(clearance, "uses_orientation", False)
    points = np.ascontiguousarray((trajectory.poses if by_pose else trajectory.positions)[chosen])
    when = (trajectory.t[chosen],) if getattr(clearance, "moves", False) else ()
    d = as_floats("clearance(points)", clearance(points, *when))
    if d.shape != (len(points),):
        raise ArgumentError(
            "clearance(points).shape", d.shape, f"({len(points)},), a distance for each point"
        )
    if np.isnan(d).any():
        point = points[int(np.flatnonzero(np.isnan(d))[0])]
        raise ArgumentError(
            f"clearance at {_metres(point)} on {trajectory.name!r}", math.nan, "a distance [m]"
        )
    return d


def _samples(trajectory: Trajectory, d: FloatArray, avoidance: Avoidance) -> Samples:
    d = np.array(d)  # a copy: the clearance may keep its own
    f = np.array(as_floats("avoidance(d)", avoidance(d)))
    for array in (d, f):
        array.setflags(write=False)
    return Samples(trajectory, d, f)


def _steps(positions: FloatArray) -> FloatArray:
    """``Trajectory.steps`` to the last digit, in a fifth of the time."""
    squares = np.diff(positions, axis=0)
    squares *= squares
    return np.sqrt(squares[:, 0] + squares[:, 1] + squares[:, 2])


def _parts_of(
    trajectory: Trajectory, clearance: Any, d: FloatArray, avoidance: Avoidance, max_step: float
) -> NDArray[np.int64]:
    """Into how many parts each step of a trajectory is to be divided, whole numbers."""
    if not getattr(clearance, "moves", False):
        return _parts(_steps(trajectory.positions), d, avoidance)
    t, x, d0 = trajectory.t, trajectory.positions, avoidance.d0
    steps = clearance.travels(x[:-1], t[:-1], x[1:], t[1:], far=d0)
    # What is beyond d0 at both ends may have been so until just before it came near: d0 is all that
    # is known. Steps are rounded more than positions, by the rounding of times. A long wait may be
    # near an obstacle for a moment, so it is not divided into many equal parts at once.
    steps *= 1.0 - 1e-9
    longest = np.ceil(steps / max_step).astype(np.int64)
    parts = np.maximum(_parts(steps, np.minimum(d, d0), avoidance), longest)
    return np.minimum(parts, _MAX_PARTS)


def _parts(steps: FloatArray, d: FloatArray, avoidance: Avoidance) -> NDArray[np.int64]:
    """Into how many parts each step is to be divided, whole numbers."""
    d0, near = avoidance.d0, np.minimum(d[:-1], d[1:])
    # Beyond this f is 0 on the whole step, as d is 1-Lipschitz; at or below 0 it is infinite.
    matters = (near - steps / 2 < d0) & (near > 0)
    longest = RELATIVE_STEP * np.maximum(near, FLOOR * d0)
    if avoidance.steady is not None:
        bounded = np.minimum(STEADY_STEP * avoidance.steady, NEAR_STEP * near)
        longest = np.maximum(longest, bounded)
    enters = (d[:-1] < d0) != (d[1:] < d0)
    longest = np.where(enters, FLOOR * d0, longest)
    parts = np.where(matters, np.ceil(steps / longest * (1 - 1e-12)), 1)
    return np.maximum(parts, 1).astype(np.int64)


def _metres(point: FloatArray) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g}, {point[2]:.6g}) m"
