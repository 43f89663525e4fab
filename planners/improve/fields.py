"""Clearances with their gradients, at thousands of points at a time."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, TypeGuard

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels import refine as kernels
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError

Gradient = Callable[[FloatArray], FloatArray]
"""Maps points (n, 3) [m] to gradients of d, shape (n, 3)."""


class Field(ABC):
    """d and its gradient.

    The implementer's duties:

    1. d may stop at `bound`: what lies farther is told as `bound` or more.
    2. The gradient is zero where d is not below `bound`; it has no NaN.
    3. At kinks of d it is the gradient on one of the sides.
    """

    @abstractmethod
    def __call__(self, points: FloatArray, bound: float) -> tuple[FloatArray, FloatArray]:
        """Distances [m], shape (n,), and gradients, shape (n, 3), at points (n, 3) [m]."""


class TerrainField(Field):
    """Compiled, from the nearest point of the surface: the unit vector away from it.

    Args:
        clearance: over a terrain.
    """

    def __init__(self, clearance: TerrainClearance) -> None:
        self._clearance = clearance

    def __call__(self, points: FloatArray, bound: float) -> tuple[FloatArray, FloatArray]:
        """See `Field`."""
        d, normals = np.empty(len(points)), np.empty((len(points), 3))
        kernels.distances_and_normals(
            self._clearance.handle, points, self._clearance.radius, bound, d, normals
        )
        return d, normals


class SampledField(Field):
    """For any callable: the gradient is given, or taken by central differences.

    Args:
        clearance: callable with points (n, 3) [m].
        gradient: of the clearance; six more distances are asked for at each point if left out.
        step: half the distance over which differences are taken [m].

    Raises:
        ArgumentError: later, an answer of another shape or with NaN.
    """

    def __init__(self, clearance: Any, gradient: Gradient | None, step: float) -> None:
        self._clearance, self._gradient, self._step = clearance, gradient, step

    def __call__(self, points: FloatArray, bound: float) -> tuple[FloatArray, FloatArray]:
        """See `Field`."""
        d, normals = self._distances(points), np.zeros((len(points), 3))
        near = np.flatnonzero((d < bound) & np.isfinite(d))
        if len(near):
            normals[near] = self._slopes(points[near])
        return d, normals

    def _slopes(self, points: FloatArray) -> FloatArray:
        if self._gradient is not None:
            return _checked("gradient(points)", self._gradient(points), points.shape)
        aside = self._step * np.vstack([np.eye(3), -np.eye(3)])
        d = self._distances((points[:, None, :] + aside).reshape(-1, 3)).reshape(-1, 6)
        slopes = (d[:, :3] - d[:, 3:]) / (2.0 * self._step)
        return np.where(np.isfinite(slopes), slopes, 0.0)  # at the edge of what is known

    def _distances(self, points: FloatArray) -> FloatArray:
        return _checked("clearance(points)", self._clearance(points), (len(points),))


def clearance_field(clearance: Any, *, gradient: Gradient | None, step: float) -> Field:
    """The quickest field of a clearance; subclasses that change d are asked, not bypassed."""
    if gradient is None and is_plain(clearance):
        return TerrainField(clearance)
    return SampledField(clearance, gradient, step)


def is_plain(clearance: Any) -> TypeGuard[TerrainClearance]:
    """Whether a clearance is that over terrain, as it stands."""
    return isinstance(clearance, TerrainClearance) and (
        type(clearance).__call__ is TerrainClearance.__call__
    )


def _checked(name: str, answer: Any, shape: tuple[int, ...]) -> FloatArray:
    values = np.asarray(answer, dtype=np.float64)
    if values.shape != shape:
        raise ArgumentError(f"{name}.shape", values.shape, f"{shape}")
    if np.isnan(values).any():
        raise ArgumentError(name, float("nan"), "numbers without NaN")
    return values
