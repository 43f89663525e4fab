"""What every clearance promises, and the checks that all share."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk.errors import ArgumentError


class ClearanceFunction(Protocol):
    """Anything that maps positions (n, 3) [m] to distances (n,) [m] serves as a clearance."""

    def __call__(self, points: NDArray[np.float64], /) -> NDArray[np.float64]:
        """Distances d(q) [m] of shape (n,)."""
        ...


class Clearance(ABC):
    """Distance d(q) from the vehicle's body to the obstacles.

    ::

        d(q) = min { ||x - x'|| : x in A(q), x' in O }

    Duties of an implementer:

    1. ``d`` is signed: positive when free, 0 when touching, negative in collision, ``-inf`` where
       nothing is known. It is never NaN for a finite query.
    2. ``d`` is 1-Lipschitz in the position: moving the body by s metres changes d by at most s.
       The motion validator and the objective rely on it.
    3. ``d`` may depend on the orientation only if ``uses_orientation`` is true; queries are then
       poses (n, 7), and turning the body by an angle a [rad] changes d by at most ``reach * a``.

    Attributes:
        uses_orientation: whether queries are poses (x, y, z, qx, qy, qz, qw) rather than points.
        reach: farthest point of the body from its origin [m]; 0 where orientation is not used.

    Reference: Nair and Kobilarov, eq. (1).
    """

    uses_orientation: bool = False
    reach: float = 0.0

    @abstractmethod
    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distances d [m], shape (n,).

        Args:
            points: positions [m], shape (n, 3), or poses, shape (n, 7).
        """

    @abstractmethod
    def of_point(self) -> ClearanceFunction:
        """The same obstacles for a body that is a single point."""


def as_queries(points: ArrayLike, columns: int, *, name: str = "points") -> NDArray[np.float64]:
    """Queries as a contiguous (n, columns) array.

    Raises:
        ArgumentError: wrong shape, or a number that is not finite.
    """
    try:
        array = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArgumentError(name, points, f"numbers of shape (n, {columns})") from None
    if array.ndim != 2 or array.shape[1] != columns:
        raise ArgumentError(f"{name}.shape", array.shape, f"(n, {columns})")
    if not np.isfinite(array).all():
        row = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise ArgumentError(f"{name}[{row}]", array[row].tolist(), "finite")
    return array


def as_length(value: float, name: str, *, positive: bool = False) -> float:
    """A finite length [m] that is not negative.

    Raises:
        ArgumentError: otherwise.
    """
    allowed = "a finite length in metres, " + ("above 0" if positive else "0 or more")
    try:
        length = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(name, value, allowed) from None
    if not math.isfinite(length) or length < 0.0 or (positive and length == 0.0):
        raise ArgumentError(name, value, allowed)
    return length
