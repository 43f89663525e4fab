"""Triangle surfaces that know their inside."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


class SignedSurface:
    """Disjoint closed meshes as one collision object with a signed distance.

    The sign comes from the angle-weighted pseudonormal at the nearest point, which is exact for
    closed meshes wound outwards wherever that point lies: in a face, on an edge or at a vertex.

    Args:
        meshes: trimesh objects; closed, disjoint and wound outwards if ``solid``.
        solid: whether they have an inside.

    Reference: Baerentzen and Aanaes, Signed distance computation using the angle weighted
    pseudonormal, IEEE TVCG 11 (2005).
    """

    def __init__(self, meshes: list[Any], *, solid: bool) -> None:
        import fcl

        self._fcl, self._solid, self._meshes = fcl, solid, meshes
        offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
        self.vertices = np.ascontiguousarray(np.vstack([mesh.vertices for mesh in meshes]))
        self._faces = np.vstack([m.faces + k for m, k in zip(meshes, offsets, strict=False)])
        model = fcl.BVHModel()
        model.beginModel(len(self.vertices), len(self._faces))
        model.addSubModel(self.vertices, self._faces)
        model.endModel()
        self._object = fcl.CollisionObject(model, fcl.Transform())
        self._point = fcl.CollisionObject(fcl.Sphere(0.0), fcl.Transform())
        self._request = fcl.DistanceRequest(enable_nearest_points=True)
        self._boxes = [mesh.bounds for mesh in meshes]
        self._rotation, self._position = np.eye(3), np.zeros(3)
        if solid:
            self._prepare_normals()

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self._meshes, self._solid)

    def place(self, pose: NDArray[np.float64]) -> None:
        """Move to a pose (x, y, z, qx, qy, qz, qw)."""
        from scipy.spatial.transform import Rotation

        self._rotation = Rotation.from_quat(pose[3:]).as_matrix()
        self._position = pose[:3]
        self._object.setTransform(self._fcl.Transform(self._rotation, self._position))

    def signed_distances(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distances from points (n, 3) [m] to the surface, negative inside, shape (n,).

        Python finds the sign, FCL the distance, which is by far the quicker: so only points within
        the box of a solid are asked for their sign.
        """
        local = (points - self._position) @ self._rotation
        inside = np.zeros(len(points), np.bool_)
        if self._solid:
            for low, high in self._boxes:
                inside |= ((local >= low) & (local <= high)).all(axis=1)
        rows = zip(points, local, inside.tolist(), strict=True)
        return np.array([self._signed_distance(*row) for row in rows], dtype=np.float64)

    def _signed_distance(
        self, point: NDArray[np.float64], local: NDArray[np.float64], may_be_inside: bool
    ) -> float:
        self._point.setTranslation(point)
        result = self._fcl.DistanceResult()
        distance = self._fcl.distance(self._point, self._object, self._request, result)
        if distance < 1e-300:  # touching: FCL reports no usable nearest point
            return 0.0
        if not may_be_inside:
            return distance
        nearest = _nearest_on_triangle(local, self.vertices[self._faces[result.b1]])
        outward = self._pseudonormal(result.b1, nearest)
        return distance if (local - nearest) @ outward >= 0.0 else -distance

    def distance_to(self, body: SignedSurface) -> float:
        """Distance between the two surfaces, negative if the solids overlap."""
        result = self._fcl.DistanceResult()
        apart = self._fcl.distance(body._object, self._object, self._request, result)
        crossing = apart < 1e-300
        if not self._solid:
            return 0.0 if crossing else apart
        world = body.vertices @ body._rotation.T + body._position
        samples = world if crossing else world[body._first_of_pieces]
        deepest = float(self.signed_distances(np.asarray(samples)).min())
        samples = self.vertices if crossing else self.vertices[self._first_of_pieces]
        deepest = min(deepest, float(body.signed_distances(np.asarray(samples)).min()))
        if crossing:
            return min(deepest, -np.finfo(np.float64).tiny)
        return deepest if deepest < 0.0 else apart

    def _prepare_normals(self) -> None:
        """Pseudonormals of faces, edges and vertices; one vertex of each connected piece."""
        import trimesh

        mesh = trimesh.Trimesh(self.vertices, self._faces, process=False)
        corners = self.vertices[self._faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self._normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        at_vertices = np.zeros_like(self.vertices)
        weighted = self._normals[:, None, :] * mesh.face_angles[:, :, None]
        np.add.at(at_vertices, self._faces, weighted)
        self._at_vertices = at_vertices
        self._at_edges: dict[tuple[int, int], NDArray[np.float64]] = {}
        for face, normal in zip(self._faces, self._normals, strict=True):
            for a, b in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0])):
                edge = (int(min(a, b)), int(max(a, b)))
                self._at_edges[edge] = self._at_edges.get(edge, 0.0) + normal
        pieces = trimesh.graph.connected_components(mesh.edges, nodes=np.arange(len(mesh.vertices)))
        self._first_of_pieces = [int(piece[0]) for piece in pieces]

    def _pseudonormal(self, face: int, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pseudonormal of the face, edge or vertex on which the point lies."""
        corners = self._faces[face]
        weights = _barycentric(point, self.vertices[corners])
        on = weights > 1e-9
        if on.sum() == 1:
            return self._at_vertices[corners[on][0]]
        if on.sum() == 2:
            a, b = sorted(int(v) for v in corners[on])
            return self._at_edges[a, b]
        return self._normals[face]


def _rebuild(meshes: list[Any], solid: bool) -> SignedSurface:
    """Unpickle: collision objects cannot be sent, so they are made anew."""
    return SignedSurface(meshes, solid=solid)


def _barycentric(point: NDArray[np.float64], triangle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Barycentric coordinates of a point of the triangle's plane."""
    u, v = triangle[1] - triangle[0], triangle[2] - triangle[0]
    w = point - triangle[0]
    normal = np.cross(u, v)
    area = normal @ normal
    beta, gamma = np.cross(w, v) @ normal / area, np.cross(u, w) @ normal / area
    return np.array([1.0 - beta - gamma, beta, gamma])


def _nearest_on_triangle(
    point: NDArray[np.float64], triangle: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Nearest point of a triangle (3, 3): the foot on its plane, or on the nearest edge."""
    weights = _barycentric(point, triangle)
    if (weights >= 0.0).all():
        return weights @ triangle
    starts, ends = triangle, triangle[[1, 2, 0]]
    along = ends - starts
    t = np.einsum("ij,ij->i", point - starts, along) / np.einsum("ij,ij->i", along, along)
    feet = starts + np.clip(t, 0.0, 1.0)[:, None] * along
    return feet[np.argmin(((feet - point) ** 2).sum(axis=1))]
