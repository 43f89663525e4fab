"""`ompl-risk plan` and `rank` with closed-loop probabilities, and within a risk budget."""

import json

import numpy as np
import pytest
from run_files import read_columns, read_ranking

from ompl_risk import TerrainClearance, simulation
from ompl_risk.cli import main
from ompl_risk.trajectory_files import read_trajectory

SCENE = (
    "--start", "200", "1000", "--goal", "2800", "1000", "--ceiling", "200", "--min-clearance", "10",
    "--margin", "0.3", "--uncertainty", "70", "--samples", "1500", "--workers", "1",
    "--duration-tolerance", "0.3", "--alternatives", "3", "--seed", "2",
)  # fmt: skip


@pytest.fixture(scope="module")
def budgeted(wall_file, tmp_path_factory):
    folder = tmp_path_factory.mktemp("budget") / "run"
    extra = ["--rollouts", "200", "--avoidance", "tail(10)", "--max-collision-probability", "0.2"]
    assert main(["plan", "--terrain", wall_file, *SCENE, *extra, "--output", str(folder)]) == 0
    return folder


def test_ranking_has_the_share_that_collides(budgeted):
    ranking = read_ranking(budgeted)
    flown = json.loads((budgeted / "closed_loop.json").read_text(encoding="utf-8"))
    assert ranking["avoidance"].startswith("GaussianTail(")
    assert ranking["units"]["norms"]["L1"] == "s"
    shares = sorted(one["hits"] / one["rollouts"] for one in flown["paths"])
    ranked = sorted(t["probability"]["probability"] for t in ranking["trajectories"])
    assert ranked == shares
    assert {one["rollouts"] for one in flown["paths"]} == {200}
    assert [one["name"] for one in flown["paths"]] == [t["name"] for t in ranking["trajectories"]]
    assert flown["disturbances"]["terrain"]["deviation"] == pytest.approx(16 / 1.645)


def test_chosen_path_keeps_to_the_budget_in_other_disturbances_too(budgeted, wall):
    said = json.loads((budgeted / "budget.json").read_text(encoding="utf-8"))
    chosen = next(one for one in said["tried"] if one["path"] == said["chosen"])
    assert chosen["upper_bound"] <= 0.2
    faster = [one for one in said["tried"] if one["duration"] < chosen["duration"] - 1e-9]
    assert all(one["upper_bound"] > 0.2 for one in faster)
    alternatives = [one["duration"] for one in read_ranking(budgeted)["trajectories"]]
    assert min(one["duration"] for one in said["tried"]) <= min(alternatives) + 1e-9
    path = read_trajectory(budgeted / "chosen.csv")
    assert path.duration == pytest.approx(chosen["duration"])
    (again,) = simulation.closed_loop_probability(
        path, TerrainClearance(wall, 5.0), simulation.Disturbances.level("moderate"),
        rollouts=2000, seed=12345,
    )  # fmt: skip
    assert again.low <= 0.2


def test_no_path_is_safe_enough(wall_file, tmp_path, refused):
    low = [*SCENE]
    low[low.index("--ceiling") + 1] = "130"
    line = refused(
        "plan", "--terrain", wall_file, *low, "--disturbances", "severe",
        "--max-collision-probability", "0.02", "--output", tmp_path / "run",
    )  # fmt: skip
    assert "no path with a probability of collision of at most 0.02" in line
    assert "least upper bound" in line
    said = json.loads((tmp_path / "run" / "budget.json").read_text(encoding="utf-8"))
    assert said["chosen"] is None
    assert not (tmp_path / "run" / "chosen.csv").exists()
    assert read_ranking(tmp_path / "run")["orders"]


def test_rank_flies_trajectories_from_files(wall_file, files, tmp_path):
    arguments = ["rank", wall_file, *files, "--duration-tolerance", "0.3", "--rollouts", "100"]
    assert main([*arguments, "--output", str(tmp_path / "run")]) == 0
    ranking = read_ranking(tmp_path / "run")
    assert sorted(ranking["probability_order"]) == ["north", "south"]
    assert (tmp_path / "run" / "closed_loop.png").stat().st_size > 10_000
    d = read_columns(tmp_path / "run" / "trajectories" / "north.csv")["d"]
    assert np.isfinite(d).all()
