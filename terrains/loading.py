"""`load`: a terrain from the catalogue or from a file, with nothing resampled on the way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ompl_risk.errors import ArgumentError, FileError, TerrainError
from ompl_risk.terrains import catalogue, npz
from ompl_risk.terrains.checks import Box
from ompl_risk.terrains.georeference import (
    Georeference,
    check_scale,
    projection_error,
    utm_zone,
)
from ompl_risk.terrains.raster import Posts, read_posts
from ompl_risk.terrains.terrain import Terrain
from ompl_risk.terrains.voids import check_fill

if TYPE_CHECKING:
    from rasterio.crs import CRS


def load(
    name_or_path: str | Path,
    *,
    bounds: Box | None = None,
    fill: str | None = None,
    crs: str | None = None,
    band: int = 1,
    **parameters: object,
) -> Terrain:
    """Load a terrain of the catalogue (`names()`) or from a file.

    Files are GeoTIFF, ESRI ASCII grids, SRTM .hgt, whatever else rasterio opens, and NPZ.
    Heights are never resampled, only reordered to run from south to north. Metres stay as they
    are; degrees are scaled to local metres as at the centre latitude, with (0, 0) at the
    south-west post (`Terrain.geo` converts back). The worst error, `Terrain.scale_error`, is at
    most 1 %. Voids (declared or masked, NaN, -32768, -32767, -9999) are never read as heights.

    Args:
        name_or_path: a name of the catalogue, or a path; write "./name" for a file that is
            called like a name of the catalogue.
        bounds: (xmin, ymin, xmax, ymax) in the coordinates of the file (metres for NPZ and
            parametric terrains): only the smallest block of posts that covers it is read.
        fill: None refuses voids, "interpolate" fills them as `fill_voids` describes.
        crs: coordinate reference system of a raster file that states none.
        band: band of a raster file, counted from 1.
        **parameters: of a parametric terrain, such as seed=3; see `terrains.parametric`.

    Raises:
        FileError: there is no such file or name, or the file cannot be read.
        VoidError: posts have no height and `fill` is None.
        TerrainError: the file's grid or coordinates cannot serve as a terrain.
        ArgumentError: an argument has a value that is not allowed.

    Example:
        >>> load("jacksboro").shape
        (344, 403)
    """
    check_fill(fill)
    name = name_or_path if isinstance(name_or_path, str) else ""
    if name in catalogue.PARAMETRIC:
        _refuse_file_arguments(name, crs, band)
        terrain = catalogue.make(name, parameters)
        return terrain if bounds is None else terrain.window(bounds)
    for unknown, value in parameters.items():
        raise ArgumentError(unknown, value, f"left out for {str(name_or_path)!r}")
    if name in catalogue.FILES:
        entry = catalogue.FILES[name]
        terrain = _load_file(entry.path, bounds, fill, crs, band)
        return replace(terrain, name=name, source=entry.source)
    return _load_file(_existing(name_or_path), bounds, fill, crs, band)


def _existing(name_or_path: str | Path) -> Path:
    if not isinstance(name_or_path, str | Path):
        raise ArgumentError("name_or_path", name_or_path, "a name of the catalogue or a path")
    path = Path(name_or_path).expanduser()
    if path.is_dir():
        raise FileError(path, "is a directory", "pass the file in it")
    if not path.exists():
        raise FileError(
            name_or_path,
            "no such file, and no terrain of the catalogue",
            f"the catalogue has {', '.join(catalogue.names())}",
        )
    return path


def _load_file(
    path: Path, bounds: Box | None, fill: str | None, crs: str | None, band: int
) -> Terrain:
    if path.suffix.lower() == ".npz":
        _refuse_file_arguments(str(path), crs, band)
        arguments = {"name": path.stem, "source": str(path), **npz.read(path, fill)}
        terrain = Terrain(**arguments)
        return terrain if bounds is None else terrain.window(bounds)
    return terrain_of(read_posts(path, bounds=bounds, fill=fill, crs=crs, band=band))


def _refuse_file_arguments(name: str, crs: str | None, band: int) -> None:
    if crs is not None:
        raise ArgumentError("crs", crs, f"left out for {name!r}, it is for raster files")
    if band != 1:
        raise ArgumentError("band", band, f"left out for {name!r}, it is for raster files")


def terrain_of(posts: Posts) -> Terrain:
    """Return the terrain of a file's posts: checks its units and turns degrees into metres.

    Raises:
        TerrainError: coordinates are not metres on the ground to within 1 %.
    """
    if posts.crs is None:
        _refuse_unnamed_degrees(posts)
    if posts.crs is not None and posts.crs.is_geographic:
        return _from_degrees(posts, posts.crs)
    return Terrain(
        posts.heights,
        spacing=(posts.x.step, posts.y.step),
        origin=(posts.x.start, posts.y.start),
        crs=None if posts.crs is None else posts.crs.to_string(),
        name=posts.path.stem,
        source=str(posts.path),
        scale_error=0.0 if posts.crs is None else _map_error(posts, posts.crs),
    )


def _refuse_unnamed_degrees(posts: Posts) -> None:
    x, y = posts.x, posts.y
    within = min(x.start, y.start + 90.0) >= -180.0 and max(x.stop, y.stop + 90.0) <= 180.0
    if within and y.start >= -90.0 and max(x.step, y.step) < 0.1:
        raise TerrainError(
            f"{posts.path}: states no CRS, and its coordinates (x {x.start:g} to {x.stop:g}, "
            f"y {y.start:g} to {y.stop:g}, steps of {x.step:.3g}) look like degrees",
            'pass crs="EPSG:4326" if they are; if they are metres, read the heights yourself '
            "and pass Terrain(heights, spacing=(dx, dy))",
        )


def _from_degrees(posts: Posts, crs: CRS) -> Terrain:
    unit, _ = crs.units_factor
    if unit.lower() != "degree":
        raise TerrainError(f"{posts.path}: angles are in {unit}", "reproject it to degrees")
    west, south, north = posts.x.start, posts.y.start, posts.y.stop
    centre = 0.5 * (south + north)
    geo = Georeference.about(centre, lon0=west, lat0=south)
    suggested = utm_zone(0.5 * (west + posts.x.stop), centre)
    return Terrain(
        posts.heights,
        spacing=(posts.x.step * geo.metres_per_lon, posts.y.step * geo.metres_per_lat),
        crs=crs.to_string(),
        name=posts.path.stem,
        source=str(posts.path),
        scale_error=check_scale(geo.scale_error(south, north), posts.path, suggested),
        geo=geo,
    )


def _map_error(posts: Posts, crs: CRS) -> float:
    unit, metres = crs.units_factor
    suggested = _suggested(posts, crs)
    if abs(metres - 1.0) > 1e-9:
        raise TerrainError(
            f"{posts.path}: horizontal coordinates are in {unit}",
            f'reproject to metres: terrains.reproject_max({str(posts.path)!r}, "{suggested}")',
        )
    if not crs.is_projected:  # a local engineering system: nothing ties it to the ground
        return 0.0
    bounds = (posts.x.start, posts.y.start, posts.x.stop, posts.y.stop)
    return check_scale(projection_error(crs, bounds), posts.path, suggested)


def _suggested(posts: Posts, crs: CRS) -> str:
    from rasterio.warp import transform

    if not crs.is_projected:
        return "EPSG:..."
    centre = [0.5 * (posts.x.start + posts.x.stop)], [0.5 * (posts.y.start + posts.y.stop)]
    lon, lat, *_ = transform(crs, "EPSG:4326", *centre)
    return utm_zone(lon[0], lat[0])
