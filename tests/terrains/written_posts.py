"""A grid of heights that no two posts share, and where it lies."""

import numpy as np

NY, NX = 6, 8
HEIGHTS = 100.0 + np.arange(NY * NX, dtype=np.float64).reshape(NY, NX) ** 1.5  # row 0 south
UTM = "EPSG:32616"
WEST, SOUTH, STEP = 500_000.0, 4_000_000.0, 30.0  # of the south-west post


def same(terrain, heights=HEIGHTS, origin=(WEST, SOUTH), spacing=(STEP, STEP)):
    np.testing.assert_array_equal(terrain.heights, heights)
    np.testing.assert_allclose(terrain.origin, origin, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(terrain.spacing, spacing, rtol=1e-12)
