import numpy as np
import pytest

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.planners import low_level_flight
from ompl_risk.terrains import Terrain


@pytest.fixture(scope="session")
def wall():
    """A ridge of 300 m across the way, with a pass of 100 m in the south and one in the north."""
    x, y = np.arange(0.0, 3001.0, 50.0), np.arange(0.0, 2001.0, 50.0)
    ridge = 300.0 * np.exp(-(((x - 1500.0) / 250.0) ** 2))
    passes = sum(np.exp(-(((y - place) / 120.0) ** 2)) for place in (500.0, 1500.0))
    return Terrain(ridge * (1.0 - 0.67 * passes[:, None]), spacing=(50.0, 50.0), name="wall")


@pytest.fixture(scope="session")
def clearance(wall):
    return TerrainClearance(wall, radius=5.0, threads=1)


@pytest.fixture(scope="session")
def problem(clearance):
    return low_level_flight(
        clearance,
        (200.0, 1000.0),
        (2800.0, 1000.0),
        ceiling=200.0,
        min_clearance=10.0,
        speed=20.0,
        margin=0.3,
        avoidance=InverseDistance(80.0),
    )
