"""Distance to triangle meshes, through the Flexible Collision Library."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk.clearance.base import Clearance, as_length, as_queries
from ompl_risk.clearance.solids import SignedSurface
from ompl_risk.errors import ArgumentError

if TYPE_CHECKING:
    import trimesh


class MeshClearance(Clearance):
    """Signed distance from a sphere or a mesh to obstacles that are meshes.

    Closed obstacles are solids: d is negative inside them. For a sphere ``|d + radius|`` is the
    exact distance from its centre to the nearest surface. A mesh body that overlaps an obstacle,
    lies inside it or encloses it has ``d < 0``, of the size of the deepest vertex: a measure of
    how bad it is, not the shortest way out.

    Queries run one at a time in python-fcl, some 10 us each and more, where ``TerrainClearance``
    takes a fraction of a microsecond.

    Args:
        obstacles: one mesh or several.
        radius: of the vehicle's sphere [m]; not together with ``body``.
        body: the vehicle as a closed mesh about its origin [m]; queries are then poses.
        surfaces: take open meshes as bare surfaces, which have no inside; else they are refused.

    Raises:
        ArgumentError: no obstacle, something that is not a mesh, an open mesh without
            ``surfaces=True``, faces wound inwards, a bad radius, or radius and body together.

    Example:
        >>> import trimesh
        >>> box = trimesh.creation.box((2.0, 2.0, 2.0))
        >>> MeshClearance(box, radius=0.5)([[3.0, 0.0, 0.0], [0.0, 0.0, 0.75]])
        array([ 1.5 , -0.75])

    Reference: Nair and Kobilarov, eq. (1).
    """

    def __init__(
        self,
        obstacles: trimesh.Trimesh | Sequence[trimesh.Trimesh],
        radius: float = 0.0,
        *,
        body: trimesh.Trimesh | None = None,
        surfaces: bool = False,
    ) -> None:
        meshes = _as_meshes(obstacles)
        for k, mesh in enumerate(meshes):
            _check_mesh(mesh, f"obstacles[{k}]", surfaces)
        self.radius = as_length(radius, "radius")
        self.surfaces = surfaces
        self._groups = [
            SignedSurface(group, solid=not surfaces) for group in disjoint_groups(meshes)
        ]
        self._body: SignedSurface | None = None
        if body is not None:
            if self.radius > 0.0:
                raise ArgumentError("radius", radius, "0 (left out) when a body mesh is given")
            _check_mesh(body, "body", False)
            self._body = SignedSurface([body], solid=True)
            self.reach = float(np.linalg.norm(body.vertices, axis=1).max())
            self.uses_orientation = True

    def __call__(self, points: ArrayLike) -> NDArray[np.float64]:
        """Distances d [m], shape (n,).

        Args:
            points: centres [m], shape (n, 3); with a body mesh poses (x, y, z, qx, qy, qz, qw),
                shape (n, 7), quaternions of unit length.
        """
        if self._body is None:
            queries = as_queries(points, 3)
            d = np.array([group.signed_distances(queries) for group in self._groups])
            return d.min(axis=0) - self.radius
        poses = as_queries(points, 7, name="poses")
        _check_unit(poses[:, 3:])
        return np.array([self._body_distance(pose, self._body) for pose in poses])

    def of_point(self) -> MeshClearance:
        """The same obstacles for a body that is a single point."""
        other = object.__new__(type(self))
        vars(other).update(vars(self))
        other.radius, other.reach, other.uses_orientation, other._body = 0.0, 0.0, False, None
        return other

    def _body_distance(self, pose: NDArray[np.float64], body: SignedSurface) -> float:
        """d of the body mesh at one pose."""
        body.place(pose)
        return min(group.distance_to(body) for group in self._groups)


def disjoint_groups(meshes: list[Any]) -> list[list[Any]]:
    """Meshes sorted into as few groups as it takes for boxes within a group not to touch.

    In a group of disjoint solids the nearest surface of all tells inside from outside; among
    overlapping solids it does not.
    """
    groups: list[list[Any]] = []
    for mesh in meshes:
        low, high = mesh.bounds
        for group in groups:
            others = np.array([other.bounds for other in group])
            apart = (others[:, 0] > high).any(axis=1) | (others[:, 1] < low).any(axis=1)
            if apart.all():
                group.append(mesh)
                break
        else:
            groups.append([mesh])
    return groups


def _as_meshes(obstacles: Any) -> list[Any]:
    meshes = list(obstacles) if isinstance(obstacles, list | tuple) else [obstacles]
    if not meshes:
        raise ArgumentError("obstacles", obstacles, "at least one trimesh.Trimesh")
    return meshes


def _check_mesh(mesh: Any, name: str, surfaces: bool) -> None:
    if not all(hasattr(mesh, field) for field in ("vertices", "faces", "is_volume")):
        raise ArgumentError(name, type(mesh).__name__, "a trimesh.Trimesh")
    if len(mesh.faces) == 0 or not np.isfinite(mesh.vertices).all():
        raise ArgumentError(
            name, f"{len(mesh.faces)} faces", "a mesh with faces and finite vertices"
        )
    if surfaces:
        return
    if not mesh.is_watertight:
        raise ArgumentError(
            name, "an open mesh", "closed (watertight), or pass surfaces=True: no inside then"
        )
    if not mesh.is_volume:
        raise ArgumentError(
            name, "faces wound inwards or both ways", "wound outwards: see mesh.fix_normals()"
        )


def _check_unit(quaternions: NDArray[np.float64]) -> None:
    off = np.abs(np.linalg.norm(quaternions, axis=1) - 1.0)
    if len(off) and off.max() > 1e-6:
        row = int(np.argmax(off))
        raise ArgumentError(
            f"poses[{row}][3:]", quaternions[row].tolist(), "a unit quaternion (x, y, z, w)"
        )
