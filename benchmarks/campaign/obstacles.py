"""Obstacles of the scenes without terrain: upright columns, as formulas and as meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk import MeshClearance
from ompl_risk.clearance.base import Clearance, as_queries

Floats = NDArray[np.float64]


class Columns(Clearance):
    """Upright columns without end: circles of the plane, lifted to three dimensions.

    ::

        d(x) = min_k (||(x, y) - c_k|| - r_k) - radius

    exact outside the circles; inside overlapping ones it is the usual bound.

    Args:
        circles: x, y, r of each [m], shape (n, 3).
        radius: of the vehicle's sphere [m].
    """

    def __init__(self, circles: ArrayLike, radius: float = 0.0) -> None:
        self.circles = np.array(circles, dtype=np.float64)
        self.radius = float(radius)

    def __call__(self, points: ArrayLike) -> Floats:
        """Distances d [m], shape (n,)."""
        x, y = as_queries(points, 3)[:, :2].T
        cx, cy, r = self.circles.T
        return (np.hypot(x[:, None] - cx, y[:, None] - cy) - r).min(axis=1) - self.radius

    def of_point(self) -> Columns:
        """The same columns for a body that is a single point."""
        return Columns(self.circles)


class Forest(Clearance):
    """Upright cylinders as closed triangle meshes, by `MeshClearance`.

    The same numbers as those of a plain `MeshClearance` of the cylinders, some ten times sooner:
    most of its time goes into telling inside from outside, and a point outside of all circles is
    outside of all cylinders. So these points take the distance to the bare surfaces.

    Args:
        circles: x, y, r of each cylinder [m], shape (n, 3).
        height: of the cylinders, which stand on z = 0 [m].
        sections: number of sides of each mesh.
        radius: of the vehicle's sphere [m].
    """

    def __init__(
        self, circles: ArrayLike, height: float, sections: int, radius: float = 0.0
    ) -> None:
        self.circles = np.array(circles, dtype=np.float64)
        self._shape = float(height), int(sections)
        meshes = cylinders(self.circles, height, sections)
        self.solid = MeshClearance(meshes, radius)
        self._surface = MeshClearance(meshes, radius, surfaces=True)

    def __reduce__(self) -> tuple[Any, ...]:
        return Forest, (self.circles, *self._shape, self.solid.radius)

    def __call__(self, points: ArrayLike) -> Floats:
        """Distances d [m], shape (n,)."""
        points = as_queries(points, 3)
        outside = Columns(self.circles)(points) > 0.0
        d = np.empty(len(points))
        d[outside], d[~outside] = self._surface(points[outside]), self.solid(points[~outside])
        return d

    def of_point(self) -> Forest:
        """The same cylinders for a body that is a single point."""
        return Forest(self.circles, *self._shape)


def scattered(
    count: int,
    size: float,
    radii: tuple[float, float],
    seed: int,
    *,
    gap: float,
    clear: ArrayLike,
    clear_radius: float,
) -> Floats:
    """Circles at random places of a square.

    Args:
        count: how many.
        size: side of the square [m].
        radii: least and greatest radius [m].
        seed: of the random numbers.
        gap: least distance between two circles [m]; negative lets them overlap.
        clear: places that stay free, shape (m, 2) [m].
        clear_radius: how far around each of them no circle reaches [m].

    Returns:
        x, y, r [m], shape (count, 3).
    """
    rng = np.random.default_rng(seed)
    kept = np.column_stack([np.array(clear, dtype=np.float64), np.full(len(clear), clear_radius)])  # pyright: ignore[reportArgumentType]
    free, circles = kept, np.empty((0, 3))
    while len(circles) < count:
        r = rng.uniform(*radii)
        x, y = rng.uniform(0.0, size, 2)
        far = np.hypot(*(free[:, :2] - (x, y)).T) > free[:, 2] + r
        apart = np.hypot(*(circles[:, :2] - (x, y)).T) > circles[:, 2] + r + gap
        if far.all() and apart.all():
            circles = np.vstack([circles, (x, y, r)])
    return circles


def cylinders(circles: Floats, height: float, sections: int) -> list[Any]:
    """Closed prisms that stand on z = 0, a mesh for each circle.

    Args:
        circles: x, y, r [m], shape (n, 3).
        height: of the prisms [m].
        sections: number of their sides.
    """
    import trimesh

    meshes = []
    for x, y, r in circles:
        mesh = trimesh.creation.cylinder(r, height, sections=sections)
        mesh.apply_translation((x, y, height / 2.0))
        meshes.append(mesh)
    return meshes
