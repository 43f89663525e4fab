"""A small scene for the benchmarks."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))  # they are no part of the installed package

from benchmarks.planning import Problem
from ompl_risk import terrains


@pytest.fixture(scope="session")
def terrain_file(tmp_path_factory):
    """Hills of 3 km x 3 km in a file, as benchmarks take terrains by name or path."""
    path = tmp_path_factory.mktemp("terrain") / "small.npz"
    hills = terrains.load("hills", shape=(76, 76), spacing=(40.0, 40.0), radius=400.0, count=15)
    hills.to_npz(path)
    return str(path)


@pytest.fixture(scope="session")
def problem(terrain_file):
    return Problem(
        terrain=terrain_file, start=(400.0, 400.0), goal=(2600.0, 2500.0), headroom=100.0
    )
