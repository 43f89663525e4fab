"""Posts from raster files through rasterio: orientation, window, voids and units settled."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ompl_risk.errors import ArgumentError, FileError, TerrainError
from ompl_risk.terrains.axis import Axis
from ompl_risk.terrains.checks import Box, box, whole
from ompl_risk.terrains.voids import find_voids, settle_voids

if TYPE_CHECKING:
    from rasterio.crs import CRS

_METRE = {"", "m", "metre", "metres", "meter", "meters"}


@dataclass(frozen=True, eq=False)
class Posts:
    """Heights as a file has them, south to north and west to east, nothing resampled.

    Attributes:
        heights: heights [m], shape (ny, nx), row 0 in the south.
        x: positions of the columns, in the units of the CRS.
        y: positions of the rows, in the units of the CRS.
        crs: coordinate reference system, or None.
        path: the file.
    """

    heights: NDArray[np.float64]
    x: Axis
    y: Axis
    crs: CRS | None
    path: Path


def read_posts(
    path: Path, *, bounds: Box | None, fill: str | None, crs: str | None, band: int
) -> Posts:
    """Read the posts of a raster file, or of the part of it that covers `bounds`.

    A post lies at the centre of its pixel, as GDAL reports pixels (so also for .hgt files, and
    for GeoTIFF files of either registration).

    Raises:
        FileError: the file cannot be read, or has no georeference.
        TerrainError: the grid is rotated, too small, or its heights are not in metres.
        VoidError: posts have no height and `fill` is None.
        ArgumentError: an argument has a value that is not allowed.
    """
    import rasterio
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    limits = None if bounds is None else box("bounds", bounds)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)  # an error below
            with rasterio.open(path) as file:
                return _posts(file, path, limits, fill, crs, band)
    except RasterioError as error:
        raise FileError(
            path,
            f"cannot be read ({str(error).replace(str(path), 'the file')})",
            "GeoTIFF, ESRI ASCII grids, SRTM tiles named like N36W085.hgt and NPZ are understood",
        ) from error


def _posts(
    file: Any, path: Path, bounds: Box | None, fill: str | None, crs: str | None, band: int
) -> Posts:
    if whole("band", band, least=1) > file.count:
        raise ArgumentError("band", band, f"1 to {file.count}, as many as {path} has")
    reference = _reference(file, path, crs)
    x, y = _axes(file, path)
    columns, rows = _window(x, y, bounds, reference)
    x, y = x.part(columns), y.part(rows)
    if min(x.count, y.count) < 2:
        raise TerrainError(f"{path}: {y.count} x {x.count} posts", "at least 2 x 2 are needed")
    heights, voids = _read(
        file,
        path,
        band,
        _in_file(columns, file.width, x.flipped),
        _in_file(rows, file.height, y.flipped),
    )
    steps = slice(None, None, -1 if y.flipped else 1), slice(None, None, -1 if x.flipped else 1)
    heights = np.ascontiguousarray(heights[steps])
    return Posts(settle_voids(heights, voids[steps], fill), x, y, reference, path)


def _axes(file: Any, path: Path) -> tuple[Axis, Axis]:
    a, b, c, d, e, f = file.transform[:6]
    if file.transform.is_identity:
        raise FileError(
            path,
            "says neither where its pixels lie nor how large they are",
            "read the heights yourself and pass Terrain(heights, spacing=(dx, dy))",
        )
    if max(abs(b), abs(d)) > 1e-9 * max(abs(a), abs(e)):
        raise TerrainError(
            f"{path}: its grid is rotated or sheared (geotransform {a, b, c, d, e, f})",
            "warp it to north-up first, keeping the summits: gdalwarp -r max in.tif out.tif",
        )
    if a == 0.0 or e == 0.0 or not np.isfinite([a, c, e, f]).all():
        raise TerrainError(f"{path}: posts are {a:g} x {e:g} apart", "both must differ from 0")
    return Axis.from_pixels(c, a, file.width), Axis.from_pixels(f, e, file.height)


def _reference(file: Any, path: Path, crs: str | None) -> CRS | None:
    """Return the file's CRS, or the caller's where the file has none."""
    from rasterio.crs import CRS

    if crs is None:
        return file.crs
    try:
        given = CRS.from_user_input(crs)
    except ValueError:  # rasterio's CRSError is one, and it lets int()'s through
        raise ArgumentError("crs", crs, 'a CRS such as "EPSG:4326"') from None
    if file.crs is not None and file.crs != given:
        raise ArgumentError("crs", crs, f"left out, as {path} says {file.crs.to_string()} itself")
    return given


def _window(x: Axis, y: Axis, bounds: Box | None, crs: CRS | None) -> tuple[slice, slice]:
    if bounds is None:
        return slice(0, x.count), slice(0, y.count)
    xmin, ymin, xmax, ymax = bounds
    system = "the file's coordinates" if crs is None else crs.to_string()
    half = 0.5  # bounds may reach the pixels' edges, which is what other software reports
    return (
        x.covering(xmin, xmax, half, f"bounds, x in {system}"),
        y.covering(ymin, ymax, half, f"bounds, y in {system}"),
    )


def _in_file(part: slice, count: int, flipped: bool) -> tuple[int, int]:
    return (count - part.stop, count - part.start) if flipped else (part.start, part.stop)


def _read(
    file: Any, path: Path, band: int, columns: tuple[int, int], rows: tuple[int, int]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Read one window in the file's order: heights [m] and voids."""
    unit = (file.units[band - 1] or "").strip().lower()
    if unit not in _METRE:
        raise TerrainError(f"{path}: heights are in {unit!r}", "convert them to metres first")
    data = file.read(band, window=(rows, columns), masked=True)
    if data.dtype.kind not in "iuf":
        raise TerrainError(f"{path}: heights are of type {data.dtype}", "real numbers are needed")
    raw = np.ma.getdata(data)
    voids = np.ma.getmaskarray(data) | find_voids(raw)
    scale, offset = file.scales[band - 1], file.offsets[band - 1]
    heights = raw.astype(np.float64)
    if (scale, offset) != (1.0, 0.0):
        heights = heights * scale + offset
    return heights, voids
