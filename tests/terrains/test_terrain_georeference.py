import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rasterio.crs import CRS
from rasterio.warp import transform
from scipy.integrate import quad

from ompl_risk.errors import TerrainError
from ompl_risk.terrains.georeference import (
    Georeference,
    check_scale,
    metres_per_degree,
    projection_error,
    utm_zone,
)


@pytest.mark.parametrize("latitude", [-75.0, -30.0, 0.0, 36.6, 45.0, 60.0, 89.0])
def test_a_degree_is_as_long_as_proj_has_it(latitude):
    step = 1e-3  # [degree], central differences of PROJ's geocentric positions
    lon = [10.0 - step, 10.0 + step, 10.0, 10.0]
    lat = [latitude, latitude, latitude - step, latitude + step]
    at = np.array(transform("EPSG:4979", "EPSG:4978", lon, lat, zs=[0.0] * 4))
    expected = np.linalg.norm(at[:, [1, 3]] - at[:, [0, 2]], axis=0) / (2 * step)
    np.testing.assert_allclose(metres_per_degree(latitude), expected, rtol=1e-8)


def test_a_quarter_meridian_is_as_long_as_it_is():
    length, _ = quad(lambda latitude: float(metres_per_degree(latitude)[1]), 0.0, 90.0)
    assert length == pytest.approx(10_001_965.729, abs=0.01)


@given(st.floats(-70.0, 70.0), st.floats(-180.0, 180.0), st.floats(-1e5, 1e5), st.floats(-1e5, 1e5))
def test_there_and_back(latitude, longitude, x, y):
    geo = Georeference.about(latitude, lon0=longitude, lat0=latitude)
    back = geo.from_lonlat(*geo.to_lonlat(x, y))
    np.testing.assert_allclose(back, [x, y], atol=1e-6)


def test_the_scale_error_is_the_worst_in_between():
    geo = Georeference.about(36.0, lon0=-85.0, lat0=35.5)
    latitudes = np.linspace(35.5, 36.5, 1001)
    per_lon, per_lat = metres_per_degree(latitudes)
    worst = max(
        np.abs(geo.metres_per_lon / per_lon - 1).max(),
        np.abs(geo.metres_per_lat / per_lat - 1).max(),
    )
    assert geo.scale_error(35.5, 36.5) == pytest.approx(worst, rel=1e-12)
    assert worst == pytest.approx(math.tan(math.radians(36.0)) * math.radians(0.5), rel=0.02)


def test_across_the_equator_the_worst_may_lie_on_it():
    geo = Georeference.about(5.0, lon0=0.0, lat0=-1.0)
    per_lon, _ = metres_per_degree(0.0)
    assert geo.scale_error(-1.0, 6.0) == pytest.approx(1 - geo.metres_per_lon / per_lon)


def test_utm_is_true_to_scale_and_web_mercator_is_not():
    utm = CRS.from_epsg(32616)
    assert projection_error(utm, (499_000.0, 4e6, 501_000.0, 4.01e6)) == pytest.approx(
        0.0004, abs=1e-6
    )
    latitude = math.radians(60.0)
    y = 6_378_137.0 * math.log(math.tan(math.pi / 4 + latitude / 2))
    # the ellipsoid's own Mercator scale factor, w / cos(phi) eastwards
    e2 = 0.0066943799901413165
    eastwards = math.sqrt(1 - e2 * math.sin(latitude) ** 2) / math.cos(latitude)
    error = projection_error(CRS.from_epsg(3857), (0.0, y - 10.0, 20.0, y + 10.0))
    northwards = eastwards**3 * math.cos(latitude) ** 2 / (1 - e2)  # 1 / (M cos) against a
    assert error == pytest.approx(max(eastwards, northwards) - 1, rel=1e-4)


def test_the_date_line_does_no_harm():
    utm = CRS.from_epsg(32601)
    (x,), (y,) = transform("EPSG:4326", utm, [180.0], [54.0])
    lon, _ = transform(utm, "EPSG:4326", [x - 50.0, x + 50.0], [y, y])
    assert lon[0] > 179.0  # the difference quotient does step across it
    assert lon[1] < -179.0
    assert projection_error(utm, (x - 10.0, y - 10.0, x + 10.0, y + 10.0)) < 0.001


def test_more_than_one_percent_is_refused_with_a_way_out():
    assert check_scale(0.01, "f", "EPSG:1") == 0.01
    with pytest.raises(TerrainError, match=r"1\.10%.*bounds=.*reproject_max\('f', \"EPSG:1\"\)"):
        check_scale(0.011, "f", "EPSG:1")


@pytest.mark.parametrize(
    ("lon", "lat", "zone"),
    [(-84.2, 36.6, 32616), (15.0, -30.0, 32733), (180.0, 1.0, 32601), (-180.0, 1.0, 32601)],
)
def test_zones(lon, lat, zone):
    assert utm_zone(lon, lat) == f"EPSG:{zone}"
