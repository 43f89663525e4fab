"""The box that a path has to stay in."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, as_floats
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError


def path_box(
    low: ArrayLike | None, high: ArrayLike | None, path: FloatArray, clearance: Any
) -> tuple[FloatArray, FloatArray]:
    """Least and greatest coordinates [m], within the map of a terrain.

    Args:
        low: least coordinates, shape (3,), infinity allowed; None for no limit.
        high: likewise the greatest.
        path: corners that have to lie inside, shape (n, 3).
        clearance: over a terrain or not.

    Raises:
        ArgumentError: another shape, NaN, low not below high, or a corner outside.
    """
    least = _side("low", low, -np.inf)
    most = _side("high", high, np.inf)
    if not (least < most).all():
        raise ArgumentError("high", most.tolist(), f"above low = {least.tolist()}")
    outside = ((path < least) | (path > most)).any(axis=1)
    if outside.any():
        k = int(np.argmax(outside))
        box = f"between low = {least.tolist()} and high = {most.tolist()}"
        raise ArgumentError(f"positions[{k}]", path[k].tolist(), box)
    if isinstance(clearance, TerrainClearance):
        xmin, xmax, ymin, ymax = clearance.terrain.extent
        least = np.maximum(least, [xmin, ymin, -np.inf])
        most = np.minimum(most, [xmax, ymax, np.inf])
    return least, most


def _side(name: str, value: ArrayLike | None, default: float) -> FloatArray:
    if value is None:
        return np.full(3, default)
    side = as_floats(name, value)
    if side.shape != (3,):
        raise ArgumentError(f"{name}.shape", side.shape, "(3,)")
    if np.isnan(side).any():
        raise ArgumentError(name, side.tolist(), "three numbers, infinity allowed")
    return side
