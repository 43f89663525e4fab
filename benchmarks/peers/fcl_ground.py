"""A terrain as a mesh in python-fcl, used as sparingly as python-fcl allows."""

from __future__ import annotations

import fcl
import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.ground import Ground
from ompl_risk.terrains import Terrain


class FclGround(Ground):
    """Distance and collision of a sphere with a terrain's mesh.

    Tree, bodies and requests are made once. A call pays for moving the sphere and for the search;
    no nearest points are asked for, and the result object is reused: started at a distance of 0,
    python-fcl copies nothing into it.

    Args:
        terrain: the ground.
        radius: of the sphere [m].
    """

    interface = "fcl.distance, one search a call, called in a loop"
    threading = "none of its own, and it holds Python's lock: the same"
    batched = False

    def __init__(self, terrain: Terrain, radius: float = 0.0) -> None:
        mesh = terrain.surface()
        self.triangles = len(mesh.faces)
        model = fcl.BVHModel()
        model.beginModel(len(mesh.vertices), len(mesh.faces))
        model.addSubModel(np.asarray(mesh.vertices), np.asarray(mesh.faces))
        model.endModel()
        self._ground = fcl.CollisionObject(model, fcl.Transform())
        self._sphere = fcl.CollisionObject(fcl.Sphere(radius), fcl.Transform())
        self._point = fcl.CollisionObject(fcl.Sphere(0.0), fcl.Transform())
        self._radius = radius
        self._distance = fcl.DistanceRequest(), fcl.DistanceResult(0.0)
        self._collision = fcl.CollisionRequest()

    def distances(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance [m] from the sphere to the surface, unsigned before the radius is taken off."""
        request, result = self._distance
        point, ground, distance = self._point, self._ground, fcl.distance
        move = point.setTranslation
        found = np.empty(len(points))
        for k, centre in enumerate(points):
            move(centre)
            found[k] = distance(point, ground, request, result)
        return found - self._radius

    def touches(self, centre: NDArray[np.float64]) -> bool:
        """Whether the sphere meets the surface; a good deal quicker than a distance."""
        self._sphere.setTranslation(centre)
        # a result keeps the contacts of all calls, so each call gets its own
        return fcl.collide(self._sphere, self._ground, self._collision, fcl.CollisionResult()) > 0
