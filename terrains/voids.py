"""Posts without a height: found, reported, and filled on request only."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ompl_risk.errors import ArgumentError, TerrainError, VoidError

UNDECLARED = (-32768.0, -32767.0, -9999.0)
"""Values that elevation files use for "no height", whether or not they say so."""

_EIGHT = np.ones((3, 3), dtype=bool)


def find_voids(raw: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Return which raw values of a file are no heights: non-finite, beyond 1e30, or UNDECLARED."""
    if raw.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            voids = ~(np.abs(raw) < 1e30)  # also NaN
    else:
        voids = np.zeros(raw.shape, dtype=bool)
    for value in UNDECLARED:
        voids |= raw == value
    return voids


def check_fill(fill: str | None) -> None:
    """Refuse any `fill` but None and "interpolate"."""
    if fill not in (None, "interpolate"):
        raise ArgumentError("fill", fill, 'None or "interpolate"')


def settle_voids(
    heights: NDArray[np.float64], voids: NDArray[np.bool_], fill: str | None
) -> NDArray[np.float64]:
    """Return heights without voids: unchanged, filled on request, or not at all.

    Raises:
        VoidError: there are voids and `fill` is None.
        ArgumentError: `fill` is unknown.
    """
    check_fill(fill)
    if not voids.any():
        return heights
    if fill is None:
        row, column = divmod(int(np.argmax(voids)), voids.shape[1])
        raise VoidError(int(np.count_nonzero(voids)), (row, column))
    heights = heights.copy()
    heights[voids] = np.nan
    return fill_voids(heights)


def fill_voids(heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a copy of `heights` with each group of NaN interpolated from the posts around it.

    Each connected group is filled by itself: linearly over the Delaunay triangulation (in grid
    steps) of the valid posts that touch it, and from the nearest of them outside their convex
    hull, as happens at the edge of the grid. Filled ground is a guess: a summit inside a void
    stays unseen.

    Args:
        heights: heights [m], shape (ny, nx), NaN where there is none.

    Raises:
        TerrainError: no post has a height.
    """
    from scipy import ndimage

    filled = np.array(heights, dtype=np.float64)
    voids = np.isnan(filled)
    if voids.all():
        raise TerrainError("no post has a height", "there is nothing to interpolate from")
    labels = np.empty(voids.shape, dtype=np.int32)
    ndimage.label(voids, structure=_EIGHT, output=labels)
    for label, found in enumerate(ndimage.find_objects(labels), start=1):
        rows, columns = (slice(max(s.start - 1, 0), s.stop + 1) for s in found)
        group = labels[rows, columns] == label
        rim = ndimage.binary_dilation(group, structure=_EIGHT) & ~group
        filled[rows, columns][group] = _interpolate(filled[rows, columns], group, rim)
    return filled


def _interpolate(
    heights: NDArray[np.float64], group: NDArray[np.bool_], rim: NDArray[np.bool_]
) -> NDArray[np.float64]:
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import KDTree, QhullError

    known, wanted = np.argwhere(rim).astype(np.float64), np.argwhere(group).astype(np.float64)
    values = heights[rim]
    nearest = values[KDTree(known).query(wanted)[1]]
    try:
        linear = LinearNDInterpolator(known, values)(wanted)
    except QhullError:  # all known posts on one line: a void row or column at the edge
        return nearest
    return np.where(np.isnan(linear), nearest, linear)
