"""Clearance of rollouts over any obstacles, with the ground where it truly is."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import terrain_error
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.loop.clearance_parts import grounds, parts


class TrueClearance:
    """Distances of rollouts to the obstacles, each rollout over its own ground.

    Terrains, alone or in a union, are met where the rollout's error of the map puts them:
    d(x, y, z - e(x, y)). Other obstacles are where they are said to be, and those that move are
    asked with the time.

    Args:
        clearance: any clearance of points. One that moves has ``moves = True``, is called with
            points and times, and bounds the speed of its obstacles by ``speed_bound(t0, t1)``.
        disturbances: may have a terrain error.
        amplitudes: of it in each rollout, shape (N, 2 m).

    Raises:
        ArgumentError: the clearance needs orientations, or moves without a bound of its speed.
    """

    def __init__(self, clearance: Any, disturbances: Any, amplitudes: FloatArray) -> None:
        self._grounds, everything = grounds(clearance), parts(clearance)
        self._others = tuple(each for each in everything if each not in self._grounds)
        self._terrain, self._amplitudes = disturbances.terrain, amplitudes
        for part in everything:
            if getattr(part, "uses_orientation", False):
                raise ArgumentError("clearance", part, "of a body without orientation (a sphere)")
            if _moves(part) and not hasattr(part, "speed_bound"):
                raise ArgumentError("clearance", part, "with speed_bound(t0, t1), since it moves")

    def stretches(self) -> NDArray[np.float64]:
        """How much longer ways can be when they are sheared with the ground, shape (N,).

        The greatest singular value of (x, y, z) -> (x, y, z - e) for slopes of e up to L is
        ``(L + sqrt(L^2 + 4)) / 2``.
        """
        if self._terrain is None or not self._grounds:
            return np.ones(len(self._amplitudes))
        slopes = self._terrain.slope_bound(self._amplitudes)
        return 0.5 * (slopes + np.sqrt(slopes**2 + 4.0))

    def __call__(
        self, rollouts: NDArray[np.int64], points: FloatArray, times: FloatArray
    ) -> NDArray[np.float64]:
        """Distances [m].

        Args:
            rollouts: their numbers, increasing, shape (n,).
            points: positions [m], shape (n, 3).
            times: [s], shape (n,).
        """
        d = np.full(len(points), np.inf)
        lowered = self._lowered(rollouts, points) if self._grounds else points
        for ground in self._grounds:
            np.minimum(d, ground(lowered), out=d)
        for other in self._others:
            found = np.asarray(other(points, times) if _moves(other) else other(points))
            if found.shape != d.shape or np.isnan(found).any():
                allowed = f"distances without NaN of shape {d.shape}"
                raise ArgumentError("clearance(points)", found, allowed)
            np.minimum(d, found, out=d)
        return d

    def travels(self, t0: FloatArray, t1: FloatArray) -> NDArray[np.float64]:
        """Bounds for the ways of obstacles between times [m], shape (n,)."""
        fastest = np.zeros(len(t0))
        for other in self._others:
            if _moves(other) and len(t0):
                np.maximum(fastest, other.speed_bound(t0, t1), out=fastest)
        if not np.isfinite(fastest).all():
            raise ArgumentError("clearance.speed_bound(t0, t1)", float(fastest.max()), "finite")
        return fastest * (t1 - t0)

    def heights(self, points: FloatArray, times: FloatArray) -> NDArray[np.float64]:
        """Heights of a plan above the mapped ground [m]; over none, above the nearest obstacle."""
        x, y, z = points.T
        found = [z - ground.terrain.height(x, y) for ground in self._grounds]
        if found:
            return np.min(found, axis=0)
        none = np.zeros(len(points), dtype=np.int64)
        return self(none, points, times)

    def _lowered(self, rollouts: NDArray[np.int64], points: FloatArray) -> NDArray[np.float64]:
        """Points as far below where they are as the true ground is above the map."""
        lowered = np.array(points, dtype=np.float64, order="C")
        if self._terrain is None or len(points) == 0:
            return lowered
        waves, error = np.ascontiguousarray(self._terrain.wave_numbers), np.empty(len(points))
        edges = np.flatnonzero(np.diff(rollouts, prepend=-1, append=-1))
        for first, last in itertools.pairwise(edges):
            terrain_error.errors(
                waves, float(self._terrain.deviation), self._amplitudes[rollouts[first]],
                lowered[first:last, :2], error[first:last],
            )  # fmt: skip
        lowered[:, 2] -= error
        return lowered


def _moves(part: Any) -> bool:
    return bool(getattr(part, "moves", False))
