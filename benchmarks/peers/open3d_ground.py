"""A terrain as a mesh in Open3D, whose distances are Embree's."""

from __future__ import annotations

from typing import Any

import numpy as np
import open3d  # pyright: ignore[reportMissingImports]

from benchmarks.peers.ground import Floats, Single
from ompl_risk.terrains import Terrain

_open3d: Any = open3d


class Open3dGround(Single):
    """``RaycastingScene.compute_distance`` on a batch.

    Args:
        terrain: the ground.
    """

    interface = "RaycastingScene.compute_distance(batch, nthreads=1), single precision"
    threading = "RaycastingScene.compute_distance(batch)"

    def __init__(self, terrain: Terrain) -> None:
        super().__init__(terrain)
        tensor = _open3d.core.Tensor
        self._scene = _open3d.t.geometry.RaycastingScene()
        self._scene.add_triangles(tensor(self.corners), tensor(self.faces.astype(np.uint32)))

    def distances(self, points: Floats) -> Floats:
        """Distances [m], shape (n,), by one thread."""
        return self._batch(points, 1)

    def distances_threaded(self, points: Floats) -> Floats:
        """The same by as many threads as Open3D chooses."""
        return self._batch(points, 0)

    def _batch(self, points: Floats, threads: int) -> Floats:
        queries = _open3d.core.Tensor(self.single(points))
        return self._scene.compute_distance(queries, nthreads=threads).numpy().astype(np.float64)
