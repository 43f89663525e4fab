"""The one way to resample a terrain, on request, that never lowers a summit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ompl_risk.errors import ArgumentError, TerrainError
from ompl_risk.terrains.axis import Axis
from ompl_risk.terrains.checks import Box, number
from ompl_risk.terrains.loading import terrain_of
from ompl_risk.terrains.raster import Posts, read_posts
from ompl_risk.terrains.terrain import Terrain

if TYPE_CHECKING:
    from rasterio.crs import CRS


def reproject_max(
    path: str | Path,
    crs: str,
    *,
    spacing: float | None = None,
    bounds: Box | None = None,
    fill: str | None = None,
    source_crs: str | None = None,
    band: int = 1,
) -> Terrain:
    """Resample a raster file to another CRS by maxima, so that no summit is lowered.

    A new post takes the highest source pixel that its own pixel touches, and then the four posts
    around each source post are raised to that post. So the new surface passes below no source
    post, wherever between the new posts that one falls. Summits become wider and valleys
    narrower: a risk estimate turns out pessimistic. Edges that the turned source does not fill
    are cut off; elsewhere the result may reach one post beyond the source.

    Args:
        path: the raster file.
        crs: where to, a projected CRS in metres such as "EPSG:32616".
        spacing: distance of the new posts [m]; by default about that of the source.
        bounds: (xmin, ymin, xmax, ymax) of the source to use, in its own coordinates.
        fill: as for `load`.
        source_crs: CRS of a source that states none.
        band: band of the source, counted from 1.

    Returns:
        The terrain; `Terrain.to_geotiff` keeps it for the next time.

    Raises:
        FileError: the file cannot be read.
        TerrainError: its grid cannot be used, or the new CRS is off by more than 1 % as well.
        ArgumentError: an argument has a value that is not allowed.
    """
    target = _target(crs)
    posts = read_posts(Path(path), bounds=bounds, fill=fill, crs=source_crs, band=band)
    if posts.crs is None:
        raise TerrainError(f"{path}: states no CRS", 'pass source_crs=, such as "EPSG:4326"')
    step = None if spacing is None else number("spacing", spacing, above=0.0)
    heights, x, y = _warp(posts, target, step)
    if min(heights.shape) >= 2:
        _lift(heights, x, y, posts, target)
    rows, columns = _filled_part(np.isfinite(heights))
    part = np.ascontiguousarray(heights[rows, columns])
    terrain = terrain_of(Posts(part, x.part(columns), y.part(rows), target, posts.path))
    return replace(terrain, source=f"{path}, reprojected to {target.to_string()} by maxima")


def _target(crs: str) -> CRS:
    from rasterio.crs import CRS

    try:
        target = CRS.from_user_input(crs)
    except ValueError:  # rasterio's CRSError is one, and it lets int()'s through
        target = None
    if target is None or not target.is_projected:
        raise ArgumentError("crs", crs, 'a projected CRS in metres such as "EPSG:32616"')
    return target


def _warp(
    posts: Posts, target: CRS, spacing: float | None
) -> tuple[NDArray[np.float64], Axis, Axis]:
    """Return the highest heights in the new pixels, row 0 in the south, NaN where none; x; y."""
    from rasterio.transform import Affine
    from rasterio.warp import Resampling, calculate_default_transform, reproject

    x, y = posts.x, posts.y
    west, north = x.start - 0.5 * x.step, y.stop + 0.5 * y.step
    east, south = x.stop + 0.5 * x.step, y.start - 0.5 * y.step
    resolution = {} if spacing is None else {"resolution": spacing}
    transform, width, height = calculate_default_transform(
        posts.crs, target, x.count, y.count, west, south, east, north, **resolution
    )
    heights = np.full((height, width), np.nan)
    reproject(
        posts.heights[::-1].copy(),
        heights,
        src_transform=Affine(x.step, 0.0, west, 0.0, -y.step, north),
        src_crs=posts.crs,
        src_nodata=np.nan,
        dst_transform=transform,
        dst_crs=target,
        dst_nodata=np.nan,
        resampling=Resampling.max,
    )
    new_x = Axis.from_pixels(transform.c, transform.a, width)
    new_y = Axis.from_pixels(transform.f, transform.e, height)
    return heights[::-1].copy(), new_x, new_y


def _lift(heights: NDArray[np.float64], x: Axis, y: Axis, posts: Posts, target: CRS) -> None:
    """Raise, in place, the four posts around each source post to at least its height.

    The surface over a cell lies between the heights of its posts, so it cannot pass below.
    """
    from rasterio.warp import transform

    source_x = posts.x.start + posts.x.step * np.arange(posts.x.count)
    for row, values in enumerate(posts.heights):  # one at a time: rasterio returns lists
        source_y = np.full_like(source_x, posts.y.start + posts.y.step * row)
        east, north = np.array(transform(posts.crs, target, source_x, source_y)[:2])
        u, v = (east - x.start) / x.step, (north - y.start) / y.step
        within = (u >= 0.0) & (u <= x.count - 1) & (v >= 0.0) & (v <= y.count - 1)
        i = np.minimum(u[within].astype(np.int64), x.count - 2)
        j = np.minimum(v[within].astype(np.int64), y.count - 2)
        for corner in ((j, i), (j, i + 1), (j + 1, i), (j + 1, i + 1)):
            np.maximum.at(heights, corner, values[within])  # a void (NaN) stays one


def _filled_part(filled: NDArray[np.bool_]) -> tuple[slice, slice]:
    """Cut the edge row or column with the largest void share until no void is left."""
    top, bottom, left, right = 0, filled.shape[0], 0, filled.shape[1]
    while not filled[top:bottom, left:right].all():
        part = filled[top:bottom, left:right]
        shares = [part[0].mean(), part[-1].mean(), part[:, 0].mean(), part[:, -1].mean()]
        worst = int(np.argmin(shares))
        top, bottom = top + (worst == 0), bottom - (worst == 1)
        left, right = left + (worst == 2), right - (worst == 3)
    if bottom - top < 2 or right - left < 2:
        raise TerrainError("nothing is left after the reprojection", "use a smaller spacing")
    return slice(top, bottom), slice(left, right)
