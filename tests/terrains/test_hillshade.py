import math

import numpy as np
import pytest
from matplotlib.colors import LightSource

from ompl_risk import terrains
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain


@pytest.mark.parametrize(("azimuth", "altitude"), [(315.0, 45.0), (100.0, 60.0), (0.0, 80.0)])
def test_a_plane_has_the_cosine_between_its_normal_and_the_sun(azimuth, altitude):
    p, q, factor = 0.2, -0.1, 1.5
    x, y = 30.0 * np.arange(5), 20.0 * np.arange(4)[:, None]
    shade = Terrain(p * x + q * y, spacing=(30.0, 20.0)).hillshade(azimuth, altitude, factor)
    normal = np.array([-factor * p, -factor * q, 1.0])
    az, alt = math.radians(azimuth), math.radians(altitude)
    sun = [math.sin(az) * math.cos(alt), math.cos(az) * math.cos(alt), math.sin(alt)]
    np.testing.assert_allclose(shade, normal @ sun / np.linalg.norm(normal), rtol=1e-12)


def test_jacksboro_is_shaded_as_matplotlib_shades_it():
    terrain = terrains.load("jacksboro")
    dx, dy = terrain.spacing
    ours = terrain.hillshade(315.0, 60.0, exaggeration=0.5)
    assert ours.min() > 0.0  # nothing is clipped, so matplotlib's is ours, stretched to [0, 1]
    north_up = terrain.heights[::-1]
    theirs = LightSource(315.0, 60.0).hillshade(north_up, vert_exag=0.5, dx=dx, dy=dy)[::-1]
    stretched = (ours - ours.min()) / (ours.max() - ours.min())
    np.testing.assert_allclose(stretched, theirs, atol=1e-9)


def test_slopes_away_from_the_sun_are_black_and_values_stay_in_0_to_1():
    shade = terrains.load("jacksboro").hillshade(altitude=5.0, exaggeration=20.0)
    assert shade.min() == 0.0
    assert 0.9 < shade.max() <= 1.0


@pytest.mark.parametrize(
    "arguments",
    [{"azimuth": np.nan}, {"altitude": -1.0}, {"altitude": 91.0}, {"exaggeration": 0.0}],
)
def test_bad_arguments_are_named(arguments):
    with pytest.raises(ArgumentError) as caught:
        Terrain(np.zeros((2, 2)), spacing=(1.0, 1.0)).hillshade(**arguments)
    assert caught.value.argument in arguments
