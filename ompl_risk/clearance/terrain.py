"""Exact distance to a terrain's triangulated surface."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._kernels import height_field, nearest
from ompl_risk.clearance.base import Clearance, as_length, as_queries
from ompl_risk.clearance.threads import in_chunks, thread_count
from ompl_risk.errors import ArgumentError

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain


class TerrainClearance(Clearance):
    """Signed distance from a sphere to a terrain, exact to rounding.

    ::

        d(x) = +- min { ||x - x'|| : x' on the surface } - radius

    positive above the surface, negative below it. The terrain is the solid under its triangulated
    surface (``Terrain`` says how cells are split). Outside the map's extent nothing is known of
    the ground, so such positions are never free: ``d = -inf``. Within the extent only the mapped
    surface counts; the map's edge is no obstacle.

    Args:
        terrain: the height field.
        radius: of the vehicle's sphere [m].
        threads: for large batches; ``None`` uses all processors.

    Raises:
        ArgumentError: negative or non-finite radius, or a bad thread count.

    Example:
        >>> import numpy as np
        >>> from ompl_risk import terrains
        >>> flat = terrains.Terrain(np.zeros((3, 3)), spacing=(10.0, 10.0))
        >>> TerrainClearance(flat, radius=2.0)([[10.0, 10.0, 7.0]])
        array([5.])

    Reference: Nair and Kobilarov, eq. (1), with the spherical body of section IV-B.
    """

    def __init__(
        self, terrain: Terrain, radius: float = 0.0, *, threads: int | None = None
    ) -> None:
        if not hasattr(terrain, "heights"):
            raise ArgumentError(
                "terrain", terrain, "a Terrain, as from ompl_risk.terrains.load(...)"
            )
        self.terrain = terrain
        self.radius = as_length(radius, "radius")
        self.threads = thread_count(threads)
        self.field = build_field(terrain, self.threads)
        self.handle = height_field.handle(self.field)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (type(self), self.terrain, self.radius, self.threads)

    def __repr__(self) -> str:
        return f"TerrainClearance({self.terrain!r}, radius={self.radius:g})"

    def with_radius(self, radius: float) -> TerrainClearance:
        """The same terrain for a sphere of another radius [m]; the search structure is shared."""
        other = object.__new__(type(self))  # not copy.copy: that pickles, and would build anew
        vars(other).update(vars(self))
        other.radius = as_length(radius, "radius")
        return other

    def of_point(self) -> TerrainClearance:
        """The same terrain for a body that is a single point."""
        return self.with_radius(0.0)

    def __call__(self, points: ArrayLike, *, bound: float = math.inf) -> NDArray[np.float64]:
        """Distances d [m].

        Args:
            points: centres of the sphere [m], shape (n, 3).
            bound: where the distance is at least this [m], ``bound`` itself is returned, which
                can be far quicker than the exact distance.

        Returns:
            min(d, bound), shape (n,).

        Raises:
            ArgumentError: wrong shape, a number that is not finite, or a bound of 0 or less.
        """
        queries = as_queries(points, 3)
        if not isinstance(bound, int | float) or not bound > 0.0:
            raise ArgumentError("bound", bound, "above 0")
        d = np.empty(len(queries))
        in_chunks(
            lambda first, last: nearest.signed_distances(
                self.handle, queries[first:last], self.radius, bound, d[first:last]
            ),
            len(queries),
            self.threads,
        )
        return d

    def nearest(self, points: ArrayLike) -> NDArray[np.float64]:
        """Nearest points on the surface [m], shape (n, 3); NaN outside the extent."""
        queries = as_queries(points, 3)
        found = np.empty_like(queries)
        in_chunks(
            lambda first, last: nearest.nearest_points(
                self.handle, queries[first:last], found[first:last]
            ),
            len(queries),
            self.threads,
        )
        return found

    def gradient(self, points: ArrayLike) -> NDArray[np.float64]:
        """Gradient of d: the unit vector away from the nearest surface point.

        Where several surface points are equally near, d has a kink and the gradient of one of them
        is returned. On the surface itself it is the upward normal there.

        Args:
            points: positions [m], shape (n, 3).

        Returns:
            Unit vectors, shape (n, 3); NaN outside the extent.
        """
        queries = as_queries(points, 3)
        away = queries - self.nearest(queries)
        length = np.linalg.norm(away, axis=1)
        above = self(queries) + self.radius >= 0.0
        scale = 1e-12 * (1.0 + np.abs(queries).max(axis=1, initial=0.0))
        touching = length <= scale
        away[touching] = self._normals(queries[touching])
        away[~above & ~touching] *= -1.0
        return away / np.linalg.norm(away, axis=1, keepdims=True)

    def _normals(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Upward normals (not of unit length) of the triangles under the points."""
        (x0, y0), (dx, dy) = self.terrain.origin, self.terrain.spacing
        heights = self.terrain.heights
        fx, fy = (points[:, 0] - x0) / dx, (points[:, 1] - y0) / dy
        j = np.clip(fx.astype(int), 0, heights.shape[1] - 2)
        i = np.clip(fy.astype(int), 0, heights.shape[0] - 2)
        lower = fx - j >= fy - i
        sw, ne = heights[i, j], heights[i + 1, j + 1]
        se, nw = heights[i, j + 1], heights[i + 1, j]
        gx = np.where(lower, se - sw, ne - nw) / dx
        gy = np.where(lower, ne - se, nw - sw) / dy
        return np.column_stack([-gx, -gy, np.ones_like(gx)])


def _rebuild(
    kind: type[TerrainClearance], terrain: Terrain, radius: float, threads: int
) -> TerrainClearance:
    """Unpickle: the search structure is made anew, it is quicker than sending it."""
    return kind(terrain, radius, threads=threads)


def build_field(terrain: Terrain, threads: int) -> height_field.HeightField:
    """The terrain with the search pyramid that the kernels use."""
    heights = terrain.heights
    (x0, y0), (dx, dy) = terrain.origin, terrain.spacing
    levels = height_field.pyramid_shape(*heights.shape)
    rows, columns, first, families = levels.T
    blocks = np.empty((first[-1] + 1, 16), dtype=np.float32)  # not zeros: those get small pages
    blocks.fill(0.0)
    for level in range(len(levels)):
        plane = blocks[first[level] :]
        in_chunks(
            lambda south, north, level=level, plane=plane: height_field.fit_blocks(
                heights, dx, dy, height_field.BASE << level, columns[level], families[level],
                plane, south, north,
            ),
            int(rows[level]),
            threads,
            least=max(1, 2**16 // (heights.shape[1] * height_field.BASE << level)),
        )  # fmt: skip
    grid = np.array([x0, y0, dx, dy], dtype=np.float64)
    for array in (blocks, levels, grid):
        array.setflags(write=False)
    return height_field.HeightField(heights, blocks, levels, grid)
