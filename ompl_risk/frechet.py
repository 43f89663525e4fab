"""How far apart two trajectories are as curves."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ompl_risk._arrays import FloatArray, readonly
from ompl_risk._kernels.frechet import discrete_frechet
from ompl_risk.errors import ArgumentError
from ompl_risk.trajectory import Trajectory


def frechet_distance(a: Trajectory | ArrayLike, b: Trajectory | ArrayLike) -> float:
    """Discrete Frechet distance between the samples of two curves [m]; time plays no part.

    The shortest leash with which two walkers can step through the samples of both curves, neither
    ever going back. It exceeds the distance of the continuous curves by at most the longest step
    of the two: densify coarse ones first. Work grows with the product of the sample counts,
    memory with their sum.

    Args:
        a: a trajectory, or points [m], shape (n, k), n >= 1.
        b: a trajectory, or points [m], shape (m, k), m >= 1.

    Returns:
        The distance [m].

    Raises:
        ArgumentError: not points, or of different dimensions.

    Reference:
        Eiter & Mannila, Computing discrete Frechet distance, TU Wien CD-TR 94/64, 1994.

    Example:
        >>> frechet_distance([[0, 0], [1, 0]], [[0, 2], [1, 2]])
        2.0
    """
    a, b = _points("a", a), _points("b", b)
    if a.shape[1] != b.shape[1]:
        raise ArgumentError("b.shape", b.shape, f"(m, {a.shape[1]}), points of the dimension of a")
    return float(discrete_frechet(a, b))


def _points(argument: str, curve: Trajectory | ArrayLike) -> FloatArray:
    points = curve.positions if isinstance(curve, Trajectory) else curve
    points = readonly(argument, points, (None, None), "(n, k), n >= 1 and k >= 1")
    if points.size == 0:
        raise ArgumentError(f"{argument}.shape", points.shape, "(n, k), n >= 1 and k >= 1")
    return np.ascontiguousarray(points)
