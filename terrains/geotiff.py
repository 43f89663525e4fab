"""Writing a terrain as GeoTIFF, for other software to open."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ompl_risk.errors import FileError

if TYPE_CHECKING:
    from rasterio.transform import Affine

    from ompl_risk.terrains.terrain import Terrain


def write(terrain: Terrain, path: str | Path) -> None:
    """Write the posts at pixel centres, north up, as float64, see `Terrain.to_geotiff`."""
    import rasterio
    from rasterio.errors import RasterioError

    ny, nx = terrain.shape
    profile = {"driver": "GTiff", "height": ny, "width": nx, "count": 1, "dtype": "float64"}
    lossless = {"compress": "deflate", "predictor": 3, "tiled": True}
    placed = {"crs": terrain.crs, "transform": north_up(terrain)}
    try:
        with rasterio.open(path, "w", **profile, **lossless, **placed) as file:
            file.write(terrain.heights[::-1], 1)
            file.set_band_unit(1, "metre")
            file.update_tags(NAME=terrain.name, SOURCE=terrain.source)
    except (RasterioError, OSError) as error:
        raise FileError(path, f"cannot be written ({error})") from error


def north_up(terrain: Terrain) -> Affine:
    """Return rasterio's transform of the pixels around the posts, first row in the north."""
    from rasterio.transform import Affine

    x, y = terrain.axes
    (x0, y1), (dx, dy) = (x.start, y.stop), terrain.spacing
    if terrain.geo is not None:
        geo = terrain.geo
        dx, dy = dx / geo.metres_per_lon, dy / geo.metres_per_lat
        x0, y1 = (float(part) for part in geo.to_lonlat(x0, y1))
    return Affine(dx, 0.0, x0 - 0.5 * dx, 0.0, -dy, y1 + 0.5 * dy)
