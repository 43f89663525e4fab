"""Which vertices of a roadmap are connected."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ompl_risk._arrays import FloatArray
from ompl_risk._kernels.graph import neighbour_pairs
from ompl_risk.clearance.threads import thread_count
from ompl_risk.planners.roadmap.region import Region


def neighbour_count(n: int, dimensions: int) -> int:
    """Neighbours that each vertex needs for asymptotic optimality.

        k = ceil(e (1 + 1 / dimensions) log n)

    Reference: Karaman & Frazzoli, Sampling-based algorithms for optimal motion planning, IJRR
    30(7), 2011, section 3.3.
    """
    return min(math.ceil(math.e * (1.0 + 1.0 / dimensions) * math.log(max(n, 2))), max(n - 1, 1))


def new_pairs(
    states: FloatArray, start: int, region: Region, threads: int | None
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Pairs of vertices to connect: the vertices from ``start`` on, and their nearest.

    Args:
        states: of all vertices, shape (n, width).
        start: first of the new vertices.
        region: says how far apart states are.
        threads: at most so many; ``None`` uses all processors.

    Returns:
        Tails, the new vertices, and heads; shape (m,).
    """
    n, new = len(states), len(states) - start
    if n < 2 or new == 0:
        return np.empty(0, np.int32), np.empty(0, np.int32)
    copies = region.copies
    # Those of one place are all neighbours of it or none is, and no neighbours of each other.
    k = min(copies * neighbour_count(n // copies, region.dimensions) + copies - 1, n - 1)
    places = region.places(states)
    if region.posed:  # q and -q are the same orientation
        places = np.vstack([places, np.hstack([places[:, :3], -places[:, 3:]])])
    tree = KDTree(places, balanced_tree=False, compact_nodes=False)
    found = np.full((new, k + 1), -1, dtype=np.int32)
    _, indices = tree.query(places[start:n], k + 1, workers=thread_count(threads))
    found[:] = indices.reshape(new, -1) % n
    return neighbour_pairs(found, start, n)
