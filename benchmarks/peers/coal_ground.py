"""A terrain as a mesh in coal (once hpp-fcl)."""

from __future__ import annotations

from typing import Any

import coal  # pyright: ignore[reportMissingImports]
import numpy as np

from benchmarks.peers.ground import Floats, Ground
from ompl_risk.terrains import Terrain

_coal: Any = coal


class CoalGround(Ground):
    """A point's distance to a ``BVHModelOBBRSS``, the only tree for which coal has distances.

    coal's own height field has none. Functor, request and result are made once.

    Args:
        terrain: the ground.
    """

    interface = "ComputeDistance, one search a call, called in a loop"
    threading = "none of its own, and it holds Python's lock: the same"
    batched = False

    def __init__(self, terrain: Terrain) -> None:
        mesh = terrain.surface()
        corners, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64)
        self._model = _coal.BVHModelOBBRSS()
        self._model.beginModel(len(faces), len(corners))
        self._model.addVertices(corners)
        self._model.addTriangles(faces)
        self._model.endModel()
        self._point = _coal.Sphere(0.0)
        self._distance = _coal.ComputeDistance(self._point, self._model)
        self._request, self._result = _coal.DistanceRequest(), _coal.DistanceResult()
        self._request.enable_signed_distance = False

    def distances(self, points: Floats) -> Floats:
        """Distances [m], shape (n,)."""
        distance, request, result = self._distance, self._request, self._result
        place, still = _coal.Transform3s.Identity(), _coal.Transform3s.Identity()
        move, clear = place.setTranslation, result.clear
        found = np.empty(len(points))
        for k, point in enumerate(points):
            move(point)
            clear()
            found[k] = distance(place, still, request, result)
        return found
