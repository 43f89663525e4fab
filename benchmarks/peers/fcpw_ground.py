"""A terrain as a mesh in FCPW."""

from __future__ import annotations

from typing import Any

import fcpw  # pyright: ignore[reportMissingImports]
import numpy as np

from benchmarks.peers.ground import Floats, Single
from ompl_risk.terrains import Terrain

_fcpw: Any = fcpw


class FcpwGround(Single):
    """``scene_3D.find_closest_points`` on a batch, over a vectorised tree.

    Args:
        terrain: the ground.
    """

    interface = "scene_3D.find_closest_points(batch), single precision; threads cannot be limited"
    threading = "the same"

    def __init__(self, terrain: Terrain) -> None:
        super().__init__(terrain)
        self._scene = _fcpw.scene_3D()
        self._scene.set_object_count(1)
        self._scene.set_object_vertices(np.asfortranarray(self.corners), 0)
        self._scene.set_object_triangles(np.asfortranarray(self.faces.astype(np.int32)), 0)
        vectorised = True
        self._scene.build(_fcpw.aggregate_type.bvh_surface_area, vectorised)

    def distances(self, points: Floats) -> Floats:
        """Distances [m], shape (n,)."""
        found = _fcpw.interaction_3D_list()
        farthest = np.full(len(points), np.inf, dtype=np.float32)
        self._scene.find_closest_points(np.asfortranarray(self.single(points)), farthest, found)
        return np.fromiter((each.d for each in found), dtype=np.float64, count=len(points))
