"""The triangulated surface, and the solid below it, as triangle meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ompl_risk.errors import ArgumentError
from ompl_risk.terrains.checks import Pair, number

if TYPE_CHECKING:
    import trimesh


def surface(heights: NDArray[np.float64], spacing: Pair, origin: Pair) -> trimesh.Trimesh:
    """Open mesh of a height field, see `Terrain.surface`."""
    import trimesh

    vertices = _vertices(heights, spacing, origin)
    return trimesh.Trimesh(vertices, _faces(heights.shape), process=False)


def solid(
    heights: NDArray[np.float64], spacing: Pair, origin: Pair, base: float | None
) -> trimesh.Trimesh:
    """Watertight mesh of a height field down to a base, see `Terrain.solid`.

    The walls hang from the ring of outermost posts; the base is a fan from its centre to the
    ring's feet, so it adds few triangles and leaves no vertex in the middle of an edge.
    """
    import trimesh

    bottom = _base(heights, spacing, base)
    top = _vertices(heights, spacing, origin)
    ring = _ring(heights.shape)
    feet = top[ring]
    feet[:, 2] = bottom
    centre = np.append(0.5 * (top[0, :2] + top[-1, :2]), bottom)
    foot = len(top) + np.arange(len(ring))
    after, foot_after = np.roll(ring, -1), np.roll(foot, -1)
    hub = np.full_like(ring, len(top) + len(ring))
    faces = np.concatenate(
        [
            _faces(heights.shape),
            np.stack([ring, foot, foot_after], axis=1),
            np.stack([ring, foot_after, after], axis=1),
            np.stack([hub, foot_after, foot], axis=1),
        ]
    )
    return trimesh.Trimesh(np.vstack([top, feet, centre]), faces, process=False)


def _vertices(heights: NDArray[np.float64], spacing: Pair, origin: Pair) -> NDArray[np.float64]:
    ny, nx = heights.shape
    vertices = np.empty((ny, nx, 3))
    vertices[..., 0] = origin[0] + spacing[0] * np.arange(nx)
    vertices[..., 1] = (origin[1] + spacing[1] * np.arange(ny))[:, None]
    vertices[..., 2] = heights
    return vertices.reshape(-1, 3)


def _faces(shape: tuple[int, ...]) -> NDArray[np.int64]:
    """Two triangles a cell, counter-clockwise from above: (SW, SE, NE) and (SW, NE, NW)."""
    posts = np.arange(shape[0] * shape[1]).reshape(shape)
    sw, se, nw, ne = posts[:-1, :-1], posts[:-1, 1:], posts[1:, :-1], posts[1:, 1:]
    return np.stack([sw, se, ne, sw, ne, nw], axis=-1).reshape(-1, 3)


def _ring(shape: tuple[int, ...]) -> NDArray[np.int64]:
    """Outermost posts, each once, counter-clockwise from above, from the south-west corner."""
    posts = np.arange(shape[0] * shape[1]).reshape(shape)
    south, east = posts[0, :-1], posts[:-1, -1]
    north, west = posts[-1, :0:-1], posts[:0:-1, 0]
    return np.concatenate([south, east, north, west])


def _base(heights: NDArray[np.float64], spacing: Pair, base: float | None) -> float:
    lowest = float(heights.min())
    if base is None:
        return lowest - max(float(heights.max()) - lowest, *spacing)
    if number("base", base) >= lowest:
        raise ArgumentError("base", base, f"below the lowest post, at {lowest:g} m")
    return float(base)
