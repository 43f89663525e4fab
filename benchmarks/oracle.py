"""Distance to a terrain by trying every triangle: slow, short, and independent of the library."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]


def distance(terrain: Terrain, point: Floats) -> float:
    """Distance [m] from a point to all triangles of the surface."""
    rows, columns = terrain.shape
    return _to_triangles(terrain, point, slice(0, rows), slice(0, columns))


def distance_in_window(terrain: Terrain, point: Floats) -> float:
    """The same, trying only triangles that can matter.

    The surface straight below is at the vertical distance v, so the nearest point is not farther
    than v, least of all horizontally: it lies in the square of half width v about the point.
    """
    x, y, z = (float(value) for value in point)
    v = abs(z - float(terrain.height(x, y)))
    (rows, columns), (x0, y0), (dx, dy) = terrain.shape, terrain.origin, terrain.spacing
    south_north = _span(y - v - y0, y + v - y0, dy, rows)
    west_east = _span(x - v - x0, x + v - x0, dx, columns)
    return _to_triangles(terrain, point, south_north, west_east)


def _span(low: float, high: float, step: float, posts: int) -> slice:
    """Posts that enclose an interval, two of them at least, one to spare on either side."""
    first = max(math.floor(low / step) - 1, 0)
    last = min(math.ceil(high / step) + 1, posts - 1)
    return slice(first, last + 1)


def _to_triangles(terrain: Terrain, point: Floats, rows: slice, columns: slice) -> float:
    """Distance to the triangles (SW, SE, NE) and (SW, NE, NW) of the cells between some posts."""
    y = terrain.origin[1] + terrain.spacing[1] * np.arange(rows.start, rows.stop) - point[1]
    x = terrain.origin[0] + terrain.spacing[0] * np.arange(columns.start, columns.stop) - point[0]
    z = terrain.heights[rows, columns] - point[2]
    posts = np.stack([*np.broadcast_arrays(x, y[:, None]), z], axis=-1)  # seen from the point
    sw, se, nw, ne = posts[:-1, :-1], posts[:-1, 1:], posts[1:, :-1], posts[1:, 1:]
    nearest = min(_from_origin(sw, se, ne), _from_origin(sw, ne, nw))
    return math.sqrt(nearest)


def _from_origin(a: Floats, b: Floats, c: Floats) -> float:
    """Least squared distance from the origin to triangles: to their edges, or within a face."""
    edges = min(_squared_to_segments(a, b), _squared_to_segments(b, c), _squared_to_segments(c, a))
    normal = np.cross(b - a, c - a)
    squared = np.einsum("...i,...i", normal, normal)
    height = np.einsum("...i,...i", a, normal)
    foot = normal * (height / squared)[..., None]
    within = np.ones(a.shape[:-1], dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        within &= np.einsum("...i,...i", np.cross(end - start, foot - start), normal) >= 0.0
    faces = (height**2 / squared)[within]
    return min(edges, float(faces.min(initial=math.inf)))


def _squared_to_segments(a: Floats, b: Floats) -> float:
    along = b - a
    s = -np.einsum("...i,...i", a, along) / np.einsum("...i,...i", along, along)
    nearest = a + np.clip(s, 0.0, 1.0)[..., None] * along
    return float(np.einsum("...i,...i", nearest, nearest).min())
