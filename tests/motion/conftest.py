"""Ground that motions fly over."""

import numpy as np
import pytest

from ompl_risk import TerrainClearance
from ompl_risk.terrains import Terrain


def waves(**options):
    y, x = np.mgrid[0:40, 0:40] / 40
    heights = 20 * np.sin(7 * x) * np.cos(9 * y) + 8 * np.sin(23 * x + 17 * y)
    return TerrainClearance(Terrain(heights, spacing=(10.0, 10.0)), radius=2.0, **options)


@pytest.fixture(scope="module")
def hills():
    return waves()


@pytest.fixture(scope="module")
def hills_for_one():
    """For one thread."""
    return waves(threads=1)
