import numpy as np
import pytest

from ompl_risk import InverseDistance, TerrainClearance, Trajectory, collision_probability, rank
from ompl_risk.ranking import DEFAULT_NORMS
from ompl_risk.terrains import Terrain

AVOIDANCE = InverseDistance(60.0)


@pytest.fixture(scope="session")
def hill():
    """One round hill of 200 m in the middle of 2 km by 3 km."""
    x, y = np.arange(0.0, 3001.0, 50.0), np.arange(0.0, 2001.0, 50.0)
    heights = 200.0 * np.exp(-(((x - 1500) / 400) ** 2 + ((y[:, None] - 1000) / 400) ** 2))
    return Terrain(heights, spacing=(50.0, 50.0), name="hill")


def judged(terrain, trajectories):
    """A ranking with its profiles, trajectories in the order given."""
    clearance = TerrainClearance(terrain, 5.0, threads=1)
    sampled = [
        a.trajectory
        for a in rank(trajectories, clearance, AVOIDANCE, duration_tolerance=1).assessments
    ]
    profiles = {t.name: collision_probability(t, terrain, 60.0, max_step=None) for t in sampled}
    ranking = rank(
        sampled, clearance, AVOIDANCE, DEFAULT_NORMS, duration_tolerance=1, probability=profiles
    )
    return ranking, profiles


def passing(name, aside, height=40.0, terrain=None):
    """From west to east past the hill, `aside` [m] of its top, at a constant altitude."""
    corners = [[200, 1000, height], [1500, 1000 + aside, height], [2800, 1000, height]]
    return Trajectory.at_constant_speed(corners, 30.0, name)


@pytest.fixture(scope="session")
def three(hill):
    """Three ways round, from safe to risky."""
    return judged(hill, [passing("A", 800), passing("B", -700), passing("C", 640)])


@pytest.fixture(scope="session")
def crashing(hill):
    """One way round, one through the hill."""
    return judged(hill, [passing("round", 800), passing("through", 0)])
