import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib import cbook

from ompl_risk import terrains
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import parametric

PARAMETRIC = ("canyon", "fractal", "hills", "ridge_valley")
SMALL = {"shape": (60, 80), "spacing": (40.0, 50.0)}


def test_names():
    assert terrains.names() == ("canyon", "fractal", "hills", "jacksboro", "ridge_valley")
    for name in terrains.names():
        assert terrains.load(name).name == name


def test_jacksboro_is_matplotlibs_post_by_post():
    with np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False)) as dem:
        theirs = {key: dem[key] for key in dem.files}
    ours = terrains.load("jacksboro")
    assert theirs["ymin"] > theirs["ymax"]  # swapped, as the README of the data says
    np.testing.assert_array_equal(ours.heights, theirs["elevation"][::-1])
    west, step = float(theirs["xmin"]), float(theirs["dx"])
    south = float(theirs["ymax"])
    lon, lat = ours.geo.to_lonlat(*np.reshape(ours.extent, (2, 2)))
    np.testing.assert_allclose(lon, west + step * np.array([0.5, 402.5]), atol=1e-9)
    np.testing.assert_allclose(lat, south + step * np.array([0.5, 343.5]), atol=1e-9)
    seconds = lon * 1200.0  # whole multiples of 3 arc-seconds, where SRTM has its posts
    np.testing.assert_allclose(seconds, np.round(seconds), atol=1e-6)
    assert 0.0015 < ours.scale_error < 0.0025
    assert "SRTM" in ours.source


def test_jacksboro_lies_the_right_way_up():
    # the fault's straight ridge climbs from the middle to the north-east corner of the map
    terrain = terrains.load("jacksboro")
    x = np.linspace(18_000.0, 28_000.0, 50)
    ridge = terrain.height(x, 19_700.0 + 0.85 * (x - 18_000.0))
    mirrored = terrain.height(x, 31_700.0 - (19_700.0 + 0.85 * (x - 18_000.0)))
    assert np.median(ridge) > np.median(mirrored) + 100.0


def test_a_window_of_the_catalogue_in_the_coordinates_of_the_file():
    whole = terrains.load("jacksboro")
    part = terrains.load("jacksboro", bounds=(-84.3, 36.5, -84.2, 36.6))
    assert part.scale_error < whole.scale_error
    lon, lat = part.geo.to_lonlat(0.0, 0.0)
    x, y = whole.geo.from_lonlat(lon, lat)
    assert part.height(0.0, 0.0) == pytest.approx(whole.height(x, y), abs=1e-6)
    hills = terrains.load("hills", bounds=(100.0, 200.0, 1000.0, 1100.0))
    assert hills.extent == (90.0, 1020.0, 180.0, 1110.0)


@pytest.mark.parametrize("name", PARAMETRIC)
def test_the_same_seed_is_the_same_terrain(name):
    one, again, other = (terrains.load(name, seed=seed, **SMALL) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.heights, again.heights)
    assert np.abs(one.heights - other.heights).max() > 1.0
    np.testing.assert_array_equal(one.heights, getattr(parametric, name)(seed=3, **SMALL).heights)
    assert one.shape == (60, 80)
    assert one.spacing == (40.0, 50.0)
    assert one.heights.min() >= 0.0
    assert "seed 3" in one.source


@pytest.mark.parametrize("name", PARAMETRIC)
@pytest.mark.parametrize(
    ("parameter", "value"),
    [
        ("shape", (1, 5)), ("shape", (5, 2.5)), ("shape", 5), ("spacing", (0.0, 1.0)),
        ("spacing", (1.0, math.inf)), ("seed", -1), ("seed", 1.5), ("nonsense", 1),
    ],
)  # fmt: skip
def test_bad_common_parameters_are_named(name, parameter, value):
    with pytest.raises(ArgumentError) as caught:
        terrains.load(name, **{parameter: value})
    assert caught.value.argument.startswith(parameter)


@pytest.mark.parametrize(
    ("name", "parameter", "value"),
    [
        ("hills", "count", 0), ("hills", "height", 0.0), ("hills", "radius", math.nan),
        ("ridge_valley", "wavelength", 0.0), ("ridge_valley", "relief", -1.0),
        ("ridge_valley", "azimuth", math.inf), ("ridge_valley", "meander", -1.0),
        ("ridge_valley", "passes", 1.1), ("canyon", "depth", 0.0), ("canyon", "floor", -1.0),
        ("canyon", "wall", 0.0), ("canyon", "meander", -1.0), ("fractal", "hurst", 0.0),
        ("fractal", "hurst", 1.1), ("fractal", "rms_slope", 0.0),
    ],
)  # fmt: skip
def test_bad_parameters_are_named(name, parameter, value):
    with pytest.raises(ArgumentError) as caught:
        terrains.load(name, **{parameter: value})
    assert caught.value.argument == parameter


def test_file_arguments_are_for_files():
    with pytest.raises(ArgumentError, match="crs"):
        terrains.load("hills", crs="EPSG:4326")
    with pytest.raises(ArgumentError, match="band"):
        terrains.load("hills", band=2)
    with pytest.raises(ArgumentError, match="seed"):
        terrains.load("jacksboro", seed=3)


def test_a_single_hill_is_a_gaussian():
    terrain = terrains.load("hills", count=1, height=100.0, radius=400.0, **SMALL)
    j, i = np.unravel_index(terrain.heights.argmax(), terrain.shape)
    logs = np.log(terrain.heights)
    curvature_x = np.diff(logs[j], 2) / 40.0**2  # of a Gaussian: -1 / r^2 everywhere
    curvature_y = np.diff(logs[:, i], 2) / 50.0**2
    assert 200.0 <= (-curvature_x.mean()) ** -0.5 <= 400.0
    np.testing.assert_allclose(curvature_x, curvature_x[0], rtol=1e-3)
    np.testing.assert_allclose(curvature_y, curvature_x[0], rtol=1e-3)
    assert 20.0 < terrain.heights.max() <= 100.0


@given(azimuth=st.floats(0.0, 180.0), seed=st.integers(0, 100))
@settings(max_examples=20)
def test_ridges_run_along_their_azimuth(azimuth, seed):
    terrain = terrains.load(
        "ridge_valley", azimuth=azimuth, seed=seed, meander=0.0, passes=0.0, relief=400.0, **SMALL
    )
    along = np.radians(azimuth)
    q, p = np.gradient(terrain.heights, 50.0, 40.0)
    slope_along = np.sin(along) * p + np.cos(along) * q
    slope_across = np.cos(along) * p - np.sin(along) * q
    inner = np.s_[1:-1, 1:-1]
    assert np.abs(slope_along[inner]).max() < 0.02 * np.abs(slope_across[inner]).max()
    assert terrain.heights.max() == pytest.approx(400.0, rel=0.01)


def test_passes_and_meanders_stay_within_what_is_asked():
    straight = terrains.load("ridge_valley", passes=0.0, seed=2)
    notched = terrains.load("ridge_valley", passes=0.8, seed=2)
    ratio = notched.heights / np.maximum(straight.heights, 1e-9)
    assert (notched.heights <= straight.heights + 1e-9).all()
    assert ratio[straight.heights > 1.0].min() >= 0.2 - 1e-9


def test_a_straight_canyon_has_its_profile():
    canyon = terrains.load(
        "canyon", meander=0.0, depth=500.0, floor=200.0, wall=400.0, shape=(201, 5),
        spacing=(100.0, 10.0),
    )  # fmt: skip
    y = np.arange(201) * 10.0
    t = np.clip((np.abs(y - 1000.0) - 100.0) / 400.0, 0.0, 1.0)
    np.testing.assert_allclose(canyon.heights, np.tile(500 * (3 * t**2 - 2 * t**3), (5, 1)).T)


def test_a_winding_canyon_stays_within_its_meander():
    canyon = terrains.load("canyon", meander=900.0, seed=5)
    floor = np.argwhere(canyon.heights == 0.0)[:, 0] * 30.0
    assert np.ptp(floor) > 600.0
    assert np.abs(floor - 4500.0).max() <= 900.0 + 150.0


@given(
    hurst=st.floats(0.05, 1.0), slope=st.floats(0.01, 3.0), seed=st.integers(0, 100),
    shape=st.tuples(st.integers(2, 40), st.integers(2, 40)),
)  # fmt: skip
@settings(max_examples=30)
def test_a_fractal_has_the_slope_asked_for(hurst, slope, seed, shape):
    heights = parametric.fractal(
        shape=shape, spacing=(2.0, 3.0), seed=seed, hurst=hurst, rms_slope=slope
    ).heights
    p, q = np.diff(heights, axis=1) / 2.0, np.diff(heights, axis=0) / 3.0
    assert math.sqrt((p**2).mean() + (q**2).mean()) == pytest.approx(slope, rel=1e-9)
    assert heights.min() == 0.0


@pytest.mark.parametrize("hurst", [0.3, 0.8, 1.0])
def test_the_spectrum_of_a_fractal_falls_with_its_exponent(hurst):
    heights = parametric.fractal(shape=(512, 512), spacing=(1.0, 1.0), hurst=hurst, seed=1).heights
    power = np.abs(np.fft.fft2(heights)) ** 2
    k = np.hypot(np.fft.fftfreq(512)[:, None], np.fft.fftfreq(512))
    edges = np.geomspace(0.02, 0.4, 12)
    rings = [(k >= low) & (k < high) for low, high in itertools.pairwise(edges)]
    logs = [(np.log(k[ring]).mean(), np.log(power[ring]).mean()) for ring in rings]
    slope = np.polyfit(*np.transpose(logs), 1)[0]
    assert slope == pytest.approx(-2.0 * (hurst + 1.0), abs=0.08)


def test_the_increments_of_a_fractal_grow_with_its_exponent():
    heights = parametric.fractal(shape=(1024, 1024), spacing=(1.0, 1.0), hurst=0.5, seed=1).heights
    lags = np.array([4, 8, 16, 32])
    squares = [((heights[:, lag:] - heights[:, :-lag]) ** 2).mean() for lag in lags]
    grown = np.polyfit(np.log(lags), np.log(squares), 1)[0]
    assert grown == pytest.approx(2 * 0.5, abs=0.1)
