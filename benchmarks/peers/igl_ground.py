"""A terrain as a mesh in libigl."""

from __future__ import annotations

from typing import Any

import igl  # pyright: ignore[reportMissingImports]
import numpy as np

from benchmarks.peers.ground import Floats, Ground
from ompl_risk.terrains import Terrain

_igl: Any = igl

SERIAL = 9_000
"""Points that libigl answers in one thread; from 10,000 on it starts several."""


class IglGround(Ground):
    """``AABB.squared_distance`` on a batch.

    Args:
        terrain: the ground.
    """

    interface = f"AABB.squared_distance(batches of {SERIAL})"
    threading = "AABB.squared_distance(batch)"

    def __init__(self, terrain: Terrain) -> None:
        mesh = terrain.surface()
        self._mesh = np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64)
        self._tree = _igl.AABB()
        self._tree.init(*self._mesh)

    def distances(self, points: Floats) -> Floats:
        """Distances [m], shape (n,), by one thread."""
        parts = np.array_split(points, -(-len(points) // SERIAL))
        return np.concatenate([self.distances_threaded(part) for part in parts])

    def distances_threaded(self, points: Floats) -> Floats:
        """The same by as many threads as libigl chooses."""
        squared, _, _ = self._tree.squared_distance(*self._mesh, points)
        return np.sqrt(squared)
