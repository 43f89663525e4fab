import numpy as np
import pytest
import rasterio
from rasterio.transform import from_origin
from rasterio.warp import transform

from ompl_risk import terrains
from ompl_risk.errors import ArgumentError, FileError, TerrainError, VoidError
from ompl_risk.terrains.catalogue import FILES

JACKSBORO = FILES["jacksboro"].path


def write(path, rows, placed, crs):
    profile = {"driver": "GTiff", "count": 1, "dtype": rows.dtype, "crs": crs, "transform": placed}
    with rasterio.open(path, "w", height=rows.shape[0], width=rows.shape[1], **profile) as file:
        file.write(rows, 1)
    return path


def on_the_new(source, target):
    """Heights of the source's posts, and of the new surface at their place, where it reaches."""
    xmin, xmax, ymin, ymax = source.extent
    x, y = np.meshgrid(
        np.linspace(xmin, xmax, source.shape[1]), np.linspace(ymin, ymax, source.shape[0])
    )
    lon, lat = source.geo.to_lonlat(x.ravel(), y.ravel())
    east, north = np.array(transform(source.crs, target.crs, lon, lat)[:2])
    west_end, east_end, south_end, north_end = target.extent
    within = (east >= west_end) & (east <= east_end) & (north >= south_end) & (north <= north_end)
    assert within.mean() > 0.9
    return source.heights.ravel()[within], target.height(east[within], north[within])


@pytest.mark.parametrize("spacing", [None, 45.0, 90.0, 250.0])
def test_no_post_and_so_no_summit_ends_above_the_new_surface(spacing):
    source = terrains.load("jacksboro")
    target = terrains.reproject_max(JACKSBORO, "EPSG:32616", spacing=spacing)
    before, after = on_the_new(source, target)
    assert (after >= before - 1e-9).all()
    assert target.heights.max() == source.heights.max()
    assert target.crs == "EPSG:32616"
    assert "maxima" in target.source
    if spacing is not None:
        assert target.spacing == (spacing, spacing)


def test_it_is_not_raised_more_than_its_neighbourhood_allows():
    source = terrains.load("jacksboro")
    target = terrains.reproject_max(JACKSBORO, "EPSG:32616")
    before, after = on_the_new(source, target)
    assert np.median(after - before) < 30.0
    assert target.heights.min() >= source.heights.min()


@pytest.mark.parametrize("spacing", [None, 25.0])
def test_every_new_post_is_at_least_as_high_as_the_pixel_it_lies_in(spacing):
    source = terrains.load("jacksboro")
    target = terrains.reproject_max(JACKSBORO, "EPSG:32616", spacing=spacing)
    (x, y), (ny, nx) = target.axes, target.shape
    east, north = np.meshgrid(x.start + x.step * np.arange(nx), y.start + y.step * np.arange(ny))
    lonlat = transform(target.crs, source.crs, east.ravel(), north.ravel())[:2]
    dx, dy = source.spacing
    at = source.geo.from_lonlat(*lonlat)
    i, j = np.rint(at[0] / dx).astype(int), np.rint(at[1] / dy).astype(int)
    within = (i >= 0) & (i < source.shape[1]) & (j >= 0) & (j < source.shape[0])
    assert within.mean() > 0.99  # the others lie beside the source, and only touch it
    assert (target.heights.ravel()[within] >= source.heights[j[within], i[within]]).all()


def test_a_file_too_large_for_one_scale_is_loaded_this_way(tmp_path):
    rows = np.zeros((201, 41), np.float32)
    rows[77, 20] = 1234.0
    path = write(tmp_path / "tall.tif", rows, from_origin(14.8, 61.0, 0.01, 0.01), "EPSG:4326")
    with pytest.raises(TerrainError, match=r'reproject_max.*"EPSG:32633"'):
        terrains.load(path)
    target = terrains.reproject_max(path, "EPSG:32633")
    lon, lat = 14.8 + 0.205, 61.0 - 0.775
    (east,), (north,) = transform("EPSG:4326", target.crs, [lon], [lat])[:2]
    assert target.height(east, north) == pytest.approx(1234.0)
    assert target.scale_error < 0.01


def test_feet_become_metres(tmp_path):
    rows = np.arange(400, dtype=np.float32).reshape(20, 20)
    path = write(tmp_path / "feet.tif", rows, from_origin(2e6, 5e5, 100.0, 100.0), "EPSG:2274")
    target = terrains.reproject_max(path, "EPSG:32616")
    assert target.spacing[0] == pytest.approx(30.48, rel=0.03)


def test_a_window_is_enough():
    bounds = (-84.3, 36.5, -84.25, 36.55)
    part = terrains.reproject_max(JACKSBORO, "EPSG:32616", bounds=bounds)
    before, after = on_the_new(terrains.load("jacksboro", bounds=bounds), part)
    assert (after >= before - 1e-9).all()


def test_what_cannot_be_reprojected(tmp_path):
    for crs in ("EPSG:4326", "nonsense"):
        with pytest.raises(ArgumentError, match="crs"):
            terrains.reproject_max(JACKSBORO, crs)
    with pytest.raises(ArgumentError, match="spacing"):
        terrains.reproject_max(JACKSBORO, "EPSG:32616", spacing=0.0)
    with pytest.raises(TerrainError, match="1%"):  # no better than before
        terrains.reproject_max(JACKSBORO, "EPSG:3857")
    with pytest.raises(FileError):
        terrains.reproject_max(tmp_path / "missing.tif", "EPSG:32616")
    rows = np.zeros((9, 9), np.float32)
    path = write(tmp_path / "none.tif", rows, from_origin(15.0, 40.0, 0.001, 0.001), None)
    with pytest.raises(TerrainError, match="source_crs"):
        terrains.reproject_max(path, "EPSG:32633")
    assert terrains.reproject_max(path, "EPSG:32633", source_crs="EPSG:4326").heights.max() == 0.0
    rows[4, 4] = np.nan
    path = write(tmp_path / "void.tif", rows, from_origin(15.0, 40.0, 0.001, 0.001), "EPSG:4326")
    with pytest.raises(VoidError):
        terrains.reproject_max(path, "EPSG:32633")
    with pytest.raises(TerrainError, match="nothing is left"):
        terrains.reproject_max(path, "EPSG:32633", fill="interpolate", spacing=5000.0)
