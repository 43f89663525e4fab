"""What every peer promises that answers distances to a terrain."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]


class Ground(ABC):
    """A terrain's mesh in somebody else's library.

    Duties of an implementer:

    1. The search structure is built once, over the triangles of ``terrain.surface()``.
    2. ``distances`` and ``distances_threaded`` return unsigned distances [m] as float64, and take
       points [m], shape (n, 3), as a user has them: what the library wants converted counts.
    3. ``interface`` and ``threading`` say how the library was asked, as its best interface allows.

    Attributes:
        interface: what one thread calls.
        threading: what all threads call, or why it is the same.
        tolerance: error that its arithmetic explains [m].
        batched: whether it takes many points in one call.
    """

    interface: str
    threading: str
    tolerance: float = 1e-6
    batched: bool = True

    @abstractmethod
    def distances(self, points: Floats) -> Floats:
        """Distances [m], shape (n,), with as few threads as the library allows."""

    def distances_threaded(self, points: Floats) -> Floats:
        """The same with all threads."""
        return self.distances(points)


class Single(Ground):
    """A library that computes in single precision, about the middle of the map for what it helps.

    Args:
        terrain: the ground.
    """

    def __init__(self, terrain: Terrain) -> None:
        mesh = terrain.surface()
        xmin, xmax, ymin, ymax = terrain.extent
        self.middle = np.array([0.5 * (xmin + xmax), 0.5 * (ymin + ymax), terrain.heights.mean()])
        self.corners = self.single(np.asarray(mesh.vertices))
        self.faces = np.asarray(mesh.faces)
        # coordinates are off by half a unit in the last place, of a point and of the surface
        self.tolerance = 2.0 * float(np.spacing(np.abs(self.corners).max()))

    def single(self, points: Floats) -> NDArray[np.float32]:
        """Points from the middle of the map, in single precision."""
        return (points - self.middle).astype(np.float32)
