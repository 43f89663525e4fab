"""Make jacksboro_fault.tif from the sample data that matplotlib ships.

    python terrains/data/make_jacksboro.py

README.md beside this file says where the data come from and what is assumed about them.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rasterio
from matplotlib import cbook
from rasterio.transform import from_origin

TARGET = Path(__file__).with_name("jacksboro_fault.tif")
TAGS = {
    "TIFFTAG_IMAGEDESCRIPTION": "Jacksboro fault and Cumberland Mountain, Tennessee: heights [m]",
    "PROVENANCE": "SRTM 3 arc-seconds (NASA/USGS), by way of jacksboro_fault_dem.npz in "
    "matplotlib's sample data (matplotlib pull request 3291); values unchanged",
    "LICENCE": "public domain",
    "VERTICAL_DATUM": "EGM96 geoid, as SRTM",
}


def main() -> None:
    """Write the GeoTIFF."""
    with np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as dem:
        heights = np.asarray(dem["elevation"])  # row 0 is the north edge
        step_x, step_y = float(dem["dx"]), float(dem["dy"])
        west, north = float(dem["xmin"]), max(float(dem["ymin"]), float(dem["ymax"]))
    profile = {
        "driver": "GTiff",
        "height": heights.shape[0],
        "width": heights.shape[1],
        "count": 1,
        "dtype": "int16",
        "nodata": -32768,
        "crs": "EPSG:4326",
        "transform": from_origin(west, north, step_x, step_y),
        "compress": "deflate",
        "predictor": 2,
        "zlevel": 9,
    }
    with rasterio.open(TARGET, "w", **profile) as file:
        file.write(heights, 1)
        file.set_band_unit(1, "metre")
        file.update_tags(**TAGS)


if __name__ == "__main__":
    main()
