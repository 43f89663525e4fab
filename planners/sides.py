"""On which side a path passes what is too high to cross."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from ompl_risk._arrays import FloatArray, ReadOnlyArrays, readonly, real_number
from ompl_risk._kernels.sides import crossings
from ompl_risk.clearance.base import as_length
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain

NEIGHBOURS = np.array([[1, 1, 0], [1, 1, 1], [0, 1, 1]])
"""Posts that share an edge of a triangle: cells are split from south-west to north-east."""

Word = tuple[int, ...]
"""Numbers of the rays that a path crosses, from 1, negative where it crosses backwards."""


@dataclass(frozen=True, eq=False)
class Sides(ReadOnlyArrays):
    """Peaks that no path can cross, each with a ray; a path's side is the word of its crossings.

    With the box's ceiling z1, sphere radius a and least clearance c, nothing passes over ::

        O = { (x, y) : h(x, y) + a + c > z1 }

    Two paths with the same ends have the same word if and only if one can be deformed into the
    other within the free corridor:

    - Where a sphere fits at some height it fits at every height above, so every path can be lifted
      to the ceiling, and only the plan view matters. What is blocked there is all that is nearer
      to O than the sphere allows, so every connected part of it contains a component of O.
    - From a point of every component a ray leaves, all in one direction. The plane without the
      rays has no holes, so the sequence of signed crossings, once those there and straight back are
      cancelled, tells which paths deform into each other: not only how often a path winds around
      each peak (homology) but also in which order (homotopy). The words depend on the direction of
      the rays; whether two are equal does not.
    - The surface is linear on every triangle, so the components of O are exactly those of the posts
      above z1 - a - c, joined along the triangles' edges: neither summits nor gaps are lost.
    - A component that reaches the edge of the box or the map is left out: nothing passes beyond
      it, so all paths have it on the same side.

    What it cannot tell: paths are taken as straight between their points, and as free. The width of
    a peak does not matter, one post counts like a massif (see ``min_extent``). Obstacles other
    than the terrain are not seen.

    Args:
        peaks: a point of each component, its highest post [m], shape (k, 2).
        direction: of the rays [rad], counterclockwise from x.

    Reference:
        Bhattacharya, Likhachev & Kumar, Topological constraints in search-based robot path
        planning, Autonomous Robots 33, 2012 (homology); Hatcher, Algebraic Topology, 2002, 1.2.
    """

    peaks: FloatArray
    direction: float = 0.0
    _rays: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        peaks = readonly("peaks", self.peaks, (None, 2), "(k, 2)")
        direction = real_number("direction", self.direction, "a finite angle [rad]")
        if not math.isfinite(direction):
            raise ArgumentError("direction", self.direction, "a finite angle [rad]")
        object.__setattr__(self, "peaks", peaks)
        object.__setattr__(self, "direction", direction)
        turned = self._turned(peaks)
        rays = turned[np.argsort(turned[:, 1], kind="stable")]
        rays.setflags(write=False)
        object.__setattr__(self, "_rays", rays)

    @classmethod
    def of_terrain(
        cls,
        terrain: Terrain,
        low: ArrayLike,
        high: ArrayLike,
        *,
        radius: float = 0.0,
        min_clearance: float = 0.0,
        min_extent: float = 0.0,
        direction: float = 0.0,
    ) -> Sides:
        """The peaks of a terrain within the box that paths may not leave.

        Args:
            terrain: the height field.
            low: least coordinates of paths [m], shape (3,).
            high: greatest coordinates of paths [m], shape (3,); the last is the ceiling.
            radius: of the vehicle's sphere [m].
            min_clearance: least clearance that paths have [m].
            min_extent: leave out peaks whose posts above the ceiling span less than this, in x
                and in y [m]. Different words then still mean different sides, but equal ones no
                longer the same side.
            direction: of the rays [rad].

        Raises:
            ArgumentError: a number out of range, or a box that is empty or misses the terrain.
        """
        box = readonly("low", low, (3,), "(3,)"), readonly("high", high, (3,), "(3,)")
        if not (box[0] < box[1]).all():
            raise ArgumentError("high", box[1].tolist(), f"above low = {box[0].tolist()}")
        margin = as_length(radius, "radius") + as_length(min_clearance, "min_clearance")
        x, y = _window("x", terrain, box, 0), _window("y", terrain, box, 1)
        heights = terrain.heights[y, x]
        labelled: Any = ndimage.label(heights > box[1][2] - margin, NEIGHBOURS)
        spacing = np.array(terrain.spacing)
        corner = np.array(terrain.origin) + spacing * (x.start, y.start)
        posts = _highest(labelled[0], heights, spacing, as_length(min_extent, "min_extent"))
        return cls(corner + spacing * posts, direction)

    @property
    def count(self) -> int:
        """Number of peaks."""
        return len(self.peaks)

    def word(self, points: ArrayLike) -> Word:
        """The side of one path: equal for paths that can be deformed into each other.

        Args:
            points: corners of the path [m], shape (n, 2) or wider; x and y first.

        Raises:
            ArgumentError: another shape, or a number that is not finite.
        """
        corners = readonly("points", points, (None, None), "(n, 2) or wider")
        return self.words(corners, np.array([0, len(corners)]))[0]

    def words(self, points: FloatArray, first: NDArray[np.int64]) -> list[Word]:
        """The sides of many paths.

        Args:
            points: corners of all paths, one path after the other [m], shape (n, 2) or wider.
            first: path p has the corners first[p] to first[p + 1], shape (paths + 1,).
        """
        if points.shape[1] < 2:
            raise ArgumentError("points.shape", points.shape, "(n, 2) or wider")
        letters, begin = crossings(self._turned(points[:, :2]), first, self._rays)
        flat, ends = letters.tolist(), begin.tolist()
        return [tuple(flat[i:j]) for i, j in pairwise(ends)]

    def _turned(self, points: FloatArray) -> FloatArray:
        """Coordinates along the rays and to their left."""
        c, s = math.cos(self.direction), math.sin(self.direction)
        x, y = points[:, 0], points[:, 1]
        return np.column_stack([c * x + s * y, c * y - s * x])


def _window(name: str, terrain: Terrain, box: tuple[FloatArray, FloatArray], axis: int) -> slice:
    """The fewest posts along an axis that cover the box, as far as there are any."""
    start, step, size = terrain.origin[axis], terrain.spacing[axis], terrain.shape[1 - axis]
    low, high = ((float(end[axis]) - start) / step for end in box)
    if high < 0.0 or low > size - 1:
        stop = start + step * (size - 1)
        raise ArgumentError(
            f"low, high in {name}",
            (box[0][axis], box[1][axis]),
            f"a range that meets the terrain's, {start:g} to {stop:g}",
        )
    return slice(max(math.floor(low), 0), min(math.ceil(high), size - 1) + 1)


def _highest(
    labels: NDArray[np.int32], heights: FloatArray, spacing: FloatArray, min_extent: float
) -> FloatArray:
    """Column and row of the highest post of each component that is off the edge, shape (k, 2)."""
    edge = set(np.concatenate([labels[0], labels[-1], labels[:, 0], labels[:, -1]]).tolist())
    found = []
    for k, (rows, columns) in enumerate(ndimage.find_objects(labels), start=1):
        span = (columns.stop - columns.start - 1, rows.stop - rows.start - 1) * spacing
        if k in edge or span.max() < min_extent:
            continue
        inside = np.where(labels[rows, columns] == k, heights[rows, columns], -math.inf)
        row, column = np.unravel_index(int(inside.argmax()), inside.shape)
        found.append((columns.start + column, rows.start + row))
    return np.array(found, dtype=np.float64).reshape(-1, 2)
