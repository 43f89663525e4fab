"""What an array must be to serve as the heights of a terrain."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk.errors import TerrainError, VoidError


def read_only_heights(heights: ArrayLike) -> NDArray[np.float64]:
    """Return a read-only C-contiguous float64 view, a copy only where there is no other way.

    Args:
        heights: heights [m], shape (ny, nx).

    Raises:
        VoidError: posts of a masked array are masked.
        TerrainError: the heights are no real numbers, fewer than 2 x 2, or not all finite.
    """
    mask = np.ma.getmaskarray(heights) if isinstance(heights, np.ma.MaskedArray) else None
    if mask is not None and mask.any():
        row, *column = (int(k[0]) for k in np.nonzero(mask))
        raise VoidError(int(np.count_nonzero(mask)), (row, column[0] if column else 0))
    given = np.asarray(heights)
    if given.dtype.kind not in "iuf":
        raise TerrainError(f"heights are of type {given.dtype}", "pass real numbers, in metres")
    if given.ndim != 2 or min(given.shape) < 2:
        raise TerrainError(f"heights have the shape {given.shape}", "pass at least 2 x 2 posts")
    checked = np.ascontiguousarray(given, dtype=np.float64).view()
    with np.errstate(all="ignore"):
        total = checked.sum()  # finite only if every height is: one pass without a temporary
    if not np.isfinite(total):  # or the sum has overflown
        _refuse_non_finite(checked)
    checked.setflags(write=False)
    return checked


def _refuse_non_finite(heights: NDArray[np.float64]) -> None:
    strange = ~np.isfinite(heights)
    if strange.any():
        row, column = divmod(int(np.argmax(strange)), heights.shape[1])
        raise TerrainError(
            f"{np.count_nonzero(strange)} heights are not finite, the first "
            f"({heights[row, column]}) at row {row}, column {column} from the south-west",
            "fill NaN on purpose with terrains.fill_voids(heights), or leave those posts out",
        )
