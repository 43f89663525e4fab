"""The height field that every distance, probability and figure is computed from."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ompl_risk._kernels import surface as kernels
from ompl_risk.errors import ArgumentError, ExtentError
from ompl_risk.terrains import meshes, shading
from ompl_risk.terrains.axis import Axis
from ompl_risk.terrains.checks import Box, Pair, box, number, pair
from ompl_risk.terrains.georeference import Georeference
from ompl_risk.terrains.heights import read_only_heights

if TYPE_CHECKING:
    import trimesh


@dataclass(frozen=True, eq=False, repr=False)
class Terrain:
    """Heights on a regular grid of posts, and the triangulated surface through them.

    Post [j, i] stands at (x0 + i dx, y0 + j dy): row 0 is the SOUTH edge, column 0 the west edge.
    Each cell is split by the diagonal from its south-west to its north-east post into the
    triangles (SW, SE, NE), where fx >= fy, and (SW, NE, NW), where fx < fy; fx, fy in [0, 1] is
    the offset within the cell. The terrain is the solid below this surface, and it ends at the
    outermost posts.

    The array is read-only here and is not copied when it is C-contiguous float64: whoever keeps
    a writable reference to it must not write to it any more.

    Args:
        heights: heights of the posts [m], shape (ny, nx), at least 2 x 2, finite.
        spacing: distance of neighbouring posts (dx, dy) [m].
        origin: position (x0, y0) of post [0, 0] [m].
        crs: coordinate reference system of the source; x and y are its coordinates if it is
            projected, and local metres that `geo` turns into its degrees if it is geographic.
        name: short name for tables and figures.
        source: where the heights come from.
        scale_error: worst relative error of a horizontal distance, against the ground; 0 where
            nothing is known about it.
        geo: conversion to longitude and latitude for a terrain given in degrees, else None.

    Raises:
        TerrainError: the heights are too few, not finite or no numbers.
        VoidError: a masked array has masked posts.
        ArgumentError: another argument has a value that is not allowed.

    Example:
        >>> plane = Terrain([[0.0, 1.0], [1.0, 2.0]], spacing=(10.0, 10.0))
        >>> plane.height(5.0, 5.0)
        1.0
    """

    heights: NDArray[np.float64]
    _: KW_ONLY
    spacing: Pair
    origin: Pair = (0.0, 0.0)
    crs: str | None = None
    name: str = "terrain"
    source: str = ""
    scale_error: float = 0.0
    geo: Georeference | None = None

    if TYPE_CHECKING:  # the generated constructor, except that it takes anything like an array

        def __init__(
            self,
            heights: ArrayLike,
            *,
            spacing: Pair,
            origin: Pair = (0.0, 0.0),
            crs: str | None = None,
            name: str = "terrain",
            source: str = "",
            scale_error: float = 0.0,
            geo: Georeference | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        checked = {
            "heights": read_only_heights(self.heights),
            "spacing": pair("spacing", self.spacing, above=0.0),
            "origin": pair("origin", self.origin),
            "scale_error": number("scale_error", self.scale_error, least=0.0),
        }
        for attribute, value in checked.items():
            object.__setattr__(self, attribute, value)

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.heights.setflags(write=False)  # pickling, so a worker process, forgets it

    def __repr__(self) -> str:
        ny, nx = self.heights.shape
        (dx, dy), (xmin, xmax, ymin, ymax) = self.spacing, self.extent
        return (
            f"Terrain({self.name!r}: {ny} x {nx} posts of {dx:.4g} x {dy:.4g} m, "
            f"x {xmin:.7g} to {xmax:.7g} m, y {ymin:.7g} to {ymax:.7g} m, "
            f"z {self.heights.min():.6g} to {self.heights.max():.6g} m, {self.crs or 'no CRS'})"
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Number of posts (ny, nx): northwards, eastwards."""
        ny, nx = self.heights.shape
        return ny, nx

    @property
    def axes(self) -> tuple[Axis, Axis]:
        """Positions of the columns (x) and of the rows (y) [m]."""
        (ny, nx), (x0, y0), (dx, dy) = self.shape, self.origin, self.spacing
        return Axis(x0, dx, nx), Axis(y0, dy, ny)

    @property
    def extent(self) -> Box:
        """(xmin, xmax, ymin, ymax) [m] of the posts, in the order that matplotlib uses."""
        x, y = self.axes
        return x.start, x.stop, y.start, y.stop

    def height(self, x: ArrayLike, y: ArrayLike) -> Any:
        """Height of the triangulated surface.

        Args:
            x: eastward positions [m], any shape that broadcasts against y.
            y: northward positions [m].

        Returns:
            Heights [m] in the broadcast shape; a float if x and y are both numbers.

        Raises:
            ArgumentError: a position is not finite, or the shapes do not broadcast.
            ExtentError: a position lies outside the outermost posts.
        """
        xs, ys = self._queries(x, y)
        out = np.empty(xs.shape)
        args = (self.heights, *self.origin, *self.spacing)
        kernels.heights_at(*args, xs.reshape(-1), ys.reshape(-1), out.reshape(-1))
        return float(out[()]) if out.ndim == 0 else out

    def surface(self) -> trimesh.Trimesh:
        """Return the triangulated surface as an open mesh, its normals upwards.

        Vertex j nx + i is post [j, i]; the faces are those of the class docstring.
        """
        return meshes.surface(self.heights, self.spacing, self.origin)

    def solid(self, base: float | None = None) -> trimesh.Trimesh:
        """Return the ground down to a horizontal base as a watertight mesh, normals outwards.

        Args:
            base: height of the base [m], below the lowest post; by default the relief or one
                spacing below it, whichever is more.

        Raises:
            ArgumentError: the base is not below the lowest post.
        """
        return meshes.solid(self.heights, self.spacing, self.origin, base)

    def hillshade(
        self, azimuth: float = 315.0, altitude: float = 45.0, exaggeration: float = 2.0
    ) -> NDArray[np.float64]:
        """Return the brightness of each post under a distant sun, for figures.

        Show it with `imshow(..., origin="lower", extent=terrain.extent)`.

        Args:
            azimuth: direction of the sun [degree], clockwise from north.
            altitude: height of the sun above the horizon [degree].
            exaggeration: factor on the heights; posts of 30 to 90 m flatten the ground, and 2
                gives it its relief back.

        Returns:
            Cosine between normal and sun, 0 where the ground faces away; shape (ny, nx).

        Raises:
            ArgumentError: an angle is not finite, the sun below the horizon, or exaggeration <= 0.
        """
        return shading.hillshade(self.heights, self.spacing, azimuth, altitude, exaggeration)

    def window(self, bounds: Box) -> Terrain:
        """Return the smallest block of posts that covers `bounds`, at the same positions.

        Args:
            bounds: (xmin, ymin, xmax, ymax) [m] within the extent; mind the order.

        Raises:
            ArgumentError: the bounds are empty or leave the extent.
        """
        (xmin, ymin, xmax, ymax), (x, y) = box("bounds", bounds), self.axes
        columns = x.covering(xmin, xmax, 0.0, "bounds, x [m]")
        rows = y.covering(ymin, ymax, 0.0, "bounds, y [m]")
        part = np.ascontiguousarray(self.heights[rows, columns])
        return replace(self, heights=part, origin=(x.part(columns).start, y.part(rows).start))

    def to_npz(self, path: str | Path) -> None:
        """Write everything to an NPZ file that `load` reads back unchanged.

        Raises:
            ArgumentError: the path does not end in .npz.
            FileError: the file cannot be written.
        """
        from ompl_risk.terrains import npz

        npz.write(self, path)

    def to_geotiff(self, path: str | Path) -> None:
        """Write the posts to a lossless GeoTIFF, in degrees if they came in degrees.

        Raises:
            FileError: the file cannot be written.
        """
        from ompl_risk.terrains import geotiff

        geotiff.write(self, path)

    def _queries(
        self, x: ArrayLike, y: ArrayLike
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        given_x, given_y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        try:
            shape = np.broadcast_shapes(given_x.shape, given_y.shape)
        except ValueError:
            raise ArgumentError(
                "y",
                f"shape {given_y.shape}",
                f"of a shape that broadcasts against x {given_x.shape}",
            ) from None
        xs, ys = (_contiguous(part, shape) for part in (given_x, given_y))
        xmin, xmax, ymin, ymax = self.extent
        inside = (xs >= xmin) & (xs <= xmax) & (ys >= ymin) & (ys <= ymax)  # False for NaN
        if not inside.all():
            self._refuse(xs, ys, ~inside)
        return xs, ys

    def _refuse(
        self, xs: NDArray[np.float64], ys: NDArray[np.float64], outside: NDArray[np.bool_]
    ) -> None:
        for argument, values in (("x", xs), ("y", ys)):
            strange = values[~np.isfinite(values)]
            if strange.size:
                raise ArgumentError(argument, float(strange[0]), "finite")
        first = float(xs[outside][0]), float(ys[outside][0])
        raise ExtentError(int(np.count_nonzero(outside)), first, self.extent)


def _contiguous(values: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return a read-only contiguous view in `shape`: one compiled kernel serves all callers."""
    result = np.ascontiguousarray(np.broadcast_to(values, shape)).reshape(shape).view()
    result.setflags(write=False)
    return result
