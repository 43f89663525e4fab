"""Terrain read from GeoTIFF, SRTM and ASCII grids: rows, registration, voids, units and windows."""

import warnings

import numpy as np
import pytest
import rasterio
from rasterio.transform import Affine, from_origin
from written_posts import HEIGHTS, NX, NY, SOUTH, STEP, UTM, WEST, same

from ompl_risk import terrains
from ompl_risk.errors import ArgumentError, FileError, TerrainError, VoidError
from ompl_risk.terrains.georeference import metres_per_degree


def write(path, rows, transform, *, crs=UTM, driver="GTiff", unit=None, scale=None, **profile):
    rows = np.asarray(rows)
    bands = rows if rows.ndim == 3 else rows[None]
    profile |= {"driver": driver, "count": len(bands), "dtype": rows.dtype, "crs": crs}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
        with rasterio.open(
            path, "w", height=bands.shape[1], width=bands.shape[2], transform=transform, **profile
        ) as file:
            file.write(bands)
            if unit:
                file.set_band_unit(1, unit)
            if scale:
                file.scales, file.offsets = [scale[0]], [scale[1]]
    return path


def north_up(x0=WEST, y0=SOUTH, step=STEP, ny=NY):
    return from_origin(x0 - step / 2, y0 + (ny - 0.5) * step, step, step)


@pytest.fixture
def tif(tmp_path):
    return write(tmp_path / "north_up.tif", HEIGHTS[::-1], north_up())


def test_a_projected_file_is_used_as_it_is(tif):
    terrain = terrains.load(tif)
    same(terrain)
    assert (terrain.crs, terrain.geo, terrain.name) == (UTM, None, "north_up")
    assert terrain.source == str(tif)
    assert terrain.scale_error == pytest.approx(0.0004, abs=1e-5)


@pytest.mark.parametrize("flip_x", [False, True])
@pytest.mark.parametrize("flip_y", [False, True])
def test_rows_run_north_and_columns_east_whatever_the_file_does(tmp_path, flip_x, flip_y):
    rows = HEIGHTS[:: -1 if flip_y else 1, :: -1 if flip_x else 1]
    a, c = (-STEP, WEST + (NX - 0.5) * STEP) if flip_x else (STEP, WEST - STEP / 2)
    e, f = (-STEP, SOUTH + (NY - 0.5) * STEP) if flip_y else (STEP, SOUTH - STEP / 2)
    path = write(tmp_path / "turned.tif", rows, Affine(a, 0.0, c, 0.0, e, f))
    same(terrains.load(path))
    bounds = (WEST + 2 * STEP, SOUTH + STEP, WEST + 4 * STEP, SOUTH + 4 * STEP)
    part = terrains.load(path, bounds=bounds)
    same(part, HEIGHTS[1:5, 2:5], (WEST + 2 * STEP, SOUTH + STEP))


def test_a_point_registered_file_means_the_same_posts(tmp_path, tif):
    path = tmp_path / "point.tif"
    with rasterio.open(tif) as area, rasterio.open(path, "w", **area.profile) as point:
        point.update_tags(AREA_OR_POINT="Point")
        point.write(area.read())
    same(terrains.load(path))


def test_an_ascii_grid_lies_at_its_cell_centres(tmp_path):
    path = tmp_path / "grid.asc"
    rows = "\n".join(" ".join(f"{h:.6f}" for h in row) for row in HEIGHTS[::-1])
    header = f"ncols {NX}\nnrows {NY}\nxllcorner 1000\nyllcorner 2000\ncellsize 10\n"
    path.write_text(header + "NODATA_value -1\n" + rows + "\n")
    terrain = terrains.load(path)
    np.testing.assert_allclose(terrain.heights, HEIGHTS, rtol=1e-6)
    assert terrain.origin == (1005.0, 2005.0)
    assert terrain.spacing == (10.0, 10.0)
    assert terrain.crs is None
    centred = tmp_path / "centred.asc"
    centred.write_text(path.read_text().replace("corner", "center"))
    assert terrains.load(centred).origin == (1000.0, 2000.0)


def hgt(tmp_path, holes=()):
    rows = np.add.outer(np.arange(1201), 2 * np.arange(1201)).astype(">i2")  # row 0 north
    for row, column in holes:
        rows[row, column] = -32768
    path = tmp_path / "N36W085.hgt"
    rows.tofile(path)
    return path, rows


def test_an_srtm_tile_has_its_corner_posts_on_whole_degrees(tmp_path):
    path, rows = hgt(tmp_path)
    terrain = terrains.load(path)
    np.testing.assert_array_equal(terrain.heights, rows[::-1])
    lon, lat = terrain.geo.to_lonlat(*np.reshape(terrain.extent, (2, 2)))
    np.testing.assert_allclose(lon, [-85.0, -84.0], atol=1e-9)
    np.testing.assert_allclose(lat, [36.0, 37.0], atol=1e-9)
    per_lon, per_lat = metres_per_degree(36.5)
    np.testing.assert_allclose(terrain.spacing, (per_lon / 1200, per_lat / 1200), rtol=1e-9)
    assert terrain.origin == (0.0, 0.0)
    worst = abs(metres_per_degree(36.5)[0] / metres_per_degree(37.0)[0] - 1)
    assert terrain.scale_error == pytest.approx(worst, rel=1e-6)


def test_a_void_is_never_a_height(tmp_path):
    path, _ = hgt(tmp_path, holes=[(1000, 7), (1200, 9)])
    with pytest.raises(VoidError) as caught:
        terrains.load(path)
    assert (caught.value.count, caught.value.first) == (2, (0, 9))
    filled = terrains.load(path, fill="interpolate").heights
    assert filled[200, 7] == pytest.approx(1000 + 14)
    assert filled.min() >= 0.0
    assert terrains.load(path, bounds=(-84.9, 36.0, -84.8, 36.1)).heights.min() >= 0.0
    with pytest.raises(ArgumentError, match="fill"):
        terrains.load(path, fill="zero")


@pytest.mark.parametrize(
    ("value", "nodata"), [(-9999.0, None), (-32767.0, None), (np.nan, None), (0.0, 0.0), (3e38, 1)]
)
def test_voids_declared_or_not(tmp_path, value, nodata):
    rows = HEIGHTS[::-1].copy()
    rows[0, 3] = value
    path = write(tmp_path / "void.tif", rows, north_up(), nodata=nodata)
    with pytest.raises(VoidError) as caught:
        terrains.load(path)
    assert (caught.value.count, caught.value.first) == (1, (NY - 1, 3))


def test_a_window_is_all_that_is_read(tif):
    # from within a cell to within another: the posts around them
    bounds = (WEST + 1.2 * STEP, SOUTH + 2.5 * STEP, WEST + 2.9 * STEP, SOUTH + 3.1 * STEP)
    same(terrains.load(tif, bounds=bounds), HEIGHTS[2:5, 1:4], (WEST + STEP, SOUTH + 2 * STEP))
    with rasterio.open(tif) as file:  # what other software calls the bounds: the pixels' edges
        edges = tuple(file.bounds)
    same(terrains.load(tif, bounds=edges))


@pytest.mark.parametrize(
    "shift", [(-STEP, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, STEP), (1e6, 1e6, 1e6, 1e6)]
)
def test_bounds_outside_the_file_are_refused(tif, shift):
    whole = np.array([WEST, SOUTH, WEST + (NX - 1) * STEP, SOUTH + (NY - 1) * STEP])
    with pytest.raises(ArgumentError, match=f"bounds.*{UTM}"):
        terrains.load(tif, bounds=tuple(whole + shift))
    with pytest.raises(ArgumentError, match="xmin < xmax"):
        terrains.load(tif, bounds=(WEST, SOUTH, WEST, SOUTH))


def test_a_window_rescues_a_file_that_is_too_large_for_one_scale(tmp_path):
    rows = np.zeros((61, 21), np.float32)
    path = write(tmp_path / "tall.tif", rows, from_origin(9.95, 63.05, 0.1, 0.1), crs="EPSG:4326")
    with pytest.raises(TerrainError, match=r"bounds=.*reproject_max.*EPSG:32632"):
        terrains.load(path)
    part = terrains.load(path, bounds=(10.0, 60.0, 11.0, 60.4))
    assert 0.005 < part.scale_error < 0.01
    np.testing.assert_allclose(part.geo.to_lonlat(0.0, 0.0), (10.0, 60.0))
    assert part.geo.metres_per_lon == pytest.approx(float(metres_per_degree(60.2)[0]), rel=1e-9)


def test_web_mercator_is_not_metric_on_the_ground(tmp_path):
    path = write(tmp_path / "web.tif", HEIGHTS, north_up(0.0, 4.3e6), crs="EPSG:3857")
    with pytest.raises(TerrainError, match="reproject_max"):
        terrains.load(path)


def test_coordinates_in_feet_and_heights_in_feet_are_refused(tmp_path):
    path = write(tmp_path / "feet.tif", HEIGHTS, north_up(2e6, 5e5), crs="EPSG:2274")
    with pytest.raises(TerrainError, match=r"US survey foot.*reproject_max.*EPSG:32616"):
        terrains.load(path)
    path = write(tmp_path / "tall.tif", HEIGHTS, north_up(), unit="ft")
    with pytest.raises(TerrainError, match="heights are in 'ft'"):
        terrains.load(path)


def test_stored_scale_and_offset_are_applied_and_voids_are_found_before(tmp_path):
    decimetres = np.round(10 * HEIGHTS[::-1]).astype(np.int32)
    path = write(tmp_path / "dm.tif", decimetres, north_up(), scale=(0.1, 50.0))
    np.testing.assert_allclose(terrains.load(path).heights, decimetres[::-1] * 0.1 + 50.0)
    decimetres[0, 0] = -9999
    path = write(tmp_path / "dm_void.tif", decimetres, north_up(), scale=(0.1, 50.0))
    with pytest.raises(VoidError):
        terrains.load(path)


def test_bands_are_chosen_by_number(tmp_path):
    path = write(tmp_path / "two.tif", np.stack([HEIGHTS, HEIGHTS + 7])[:, ::-1], north_up())
    same(terrains.load(path))
    same(terrains.load(path, band=2), HEIGHTS + 7)
    for band in (0, 3, 1.5, True):
        with pytest.raises(ArgumentError, match="band"):
            terrains.load(path, band=band)


def test_degrees_without_a_crs_are_refused_until_it_is_given(tmp_path):
    path = write(tmp_path / "deg.tif", HEIGHTS, from_origin(-84.0, 36.0, 0.001, 0.001), crs=None)
    with pytest.raises(TerrainError, match=r'states no CRS.*crs="EPSG:4326"'):
        terrains.load(path)
    assert terrains.load(path, crs="EPSG:4326").geo is not None
    with pytest.raises(ArgumentError, match="crs"):
        terrains.load(path, crs="EPSG:nonsense")


def test_metres_without_a_crs_are_taken_as_metres(tmp_path):
    for name, origin in (("near", (10.0, 20.0)), ("far", (4e5, 4e6))):
        path = write(tmp_path / f"{name}.tif", HEIGHTS[::-1], north_up(*origin), crs=None)
        same(terrains.load(path), origin=origin)


def test_a_crs_that_contradicts_the_file_is_refused(tif):
    same(terrains.load(tif, crs=UTM))
    with pytest.raises(ArgumentError, match="says EPSG:32616 itself"):
        terrains.load(tif, crs="EPSG:4326")


def test_rotated_and_unplaced_grids_are_refused(tmp_path):
    turned = north_up() * Affine.rotation(10.0)
    with pytest.raises(TerrainError, match="rotated"):
        terrains.load(write(tmp_path / "turned.tif", HEIGHTS, turned))
    unplaced = write(tmp_path / "unplaced.tif", HEIGHTS, None, crs=None)
    with pytest.raises(FileError, match="neither where"):
        terrains.load(unplaced)


def test_fewer_than_two_by_two_posts_are_refused(tmp_path):
    path = write(tmp_path / "line.tif", HEIGHTS[:1], north_up(ny=1))
    with pytest.raises(TerrainError, match="1 x 8 posts"):
        terrains.load(path)


def test_complex_numbers_are_no_heights(tmp_path):
    path = write(tmp_path / "complex.tif", HEIGHTS.astype(np.complex64), north_up())
    with pytest.raises(TerrainError, match="complex"):
        terrains.load(path)


def test_missing_and_unreadable_files(tmp_path, tif):
    with pytest.raises(FileError, match=r"nowhere.*catalogue has .*jacksboro"):
        terrains.load("nowhere")
    with pytest.raises(FileError, match="directory"):
        terrains.load(tmp_path)
    junk = tmp_path / "junk.tif"
    junk.write_bytes(b"not a raster at all")
    with pytest.raises(FileError, match="GeoTIFF, ESRI ASCII"):
        terrains.load(junk)
    cut = tmp_path / "cut.tif"
    big = write(tmp_path / "big.tif", np.random.default_rng(0).random((300, 300)), north_up())
    cut.write_bytes(big.read_bytes()[:4000])
    with pytest.raises(FileError, match="cannot be read"):
        terrains.load(cut)
    with pytest.raises(ArgumentError, match="name_or_path"):
        terrains.load(3)
    with pytest.raises(ArgumentError, match="seed"):
        terrains.load(tif, seed=3)


def test_geotiff_there_and_back(tmp_path, tif):
    path = tmp_path / "back.tif"
    for terrain in (terrains.load("jacksboro"), terrains.load(tif)):
        terrain.to_geotiff(path)
        back = terrains.load(path)
        np.testing.assert_array_equal(back.heights, terrain.heights)
        np.testing.assert_allclose(back.extent, terrain.extent, rtol=1e-9, atol=1e-4)
        assert back.crs == terrain.crs
    with pytest.raises(FileError, match="cannot be written"):
        terrain.to_geotiff(tmp_path / "no" / "such.tif")
