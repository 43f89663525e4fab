import re

import numpy as np
import pytest
from run_files import QUICK, without_notice

from ompl_risk.cli import main
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory
from ompl_risk.trajectory_files import write_csv


@pytest.fixture(scope="session")
def wall():
    """A ridge of 300 m across the way, with a pass of 100 m in the south and one in the north."""
    x, y = np.arange(0.0, 3001.0, 50.0), np.arange(0.0, 2001.0, 50.0)
    ridge = 300.0 * np.exp(-(((x - 1500.0) / 250.0) ** 2))
    passes = sum(np.exp(-(((y - place) / 120.0) ** 2)) for place in (500.0, 1500.0))
    return Terrain(ridge * (1.0 - 0.67 * passes[:, None]), spacing=(50.0, 50.0), name="wall")


@pytest.fixture(scope="session")
def wall_file(wall, tmp_path_factory):
    path = tmp_path_factory.mktemp("terrain") / "wall.npz"
    wall.to_npz(path)
    return str(path)


@pytest.fixture(scope="session")
def planned(wall_file, tmp_path_factory):
    """The folder of one quick plan."""
    folder = tmp_path_factory.mktemp("plan") / "run"
    assert main(["plan", "--terrain", wall_file, *QUICK, "--output", str(folder)]) == 0
    return folder


@pytest.fixture
def files(tmp_path):
    """Two trajectories through the wall's passes, as CSV files."""
    paths = []
    for name, y, z in (("south", 500.0, 190.0), ("north", 1500.0, 160.0)):
        corners = [[200, 1000, 60], [1500, y, z], [2800, 1000, 60]]
        path = tmp_path / f"{name}.csv"
        write_csv(path, Trajectory.at_constant_speed(corners, 20.0))
        paths.append(str(path))
    return paths


@pytest.fixture
def refused(capsys):
    """Runs a command that must fail: exit code 1 and one line, which is returned."""

    def run(*arguments):
        assert main([str(a) for a in arguments]) == 1
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err + captured.out
        line, *rest = without_notice(captured.err)
        assert rest == []
        assert line.startswith("ompl-risk: ")
        return re.sub(r"\x1b\[[0-9;]*m", "", line)

    return run
