"""`ompl-risk plan`, end to end, with everything that it writes recomputed from the files."""

import filecmp
import json
import math
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from run_files import QUICK, read_columns, read_ranking, without_notice

from ompl_risk import (
    InverseDistance,
    Lp,
    Sobolev,
    TerrainClearance,
    Trajectory,
    collision_probability,
    frechet_distance,
)
from ompl_risk.cli import main
from ompl_risk.planners import Candidate, Length, Status, Task

NORMS = {"L1": Lp(1), "L2": Lp(2), "L∞": Lp(math.inf), "H1": Sobolev(1)}


def columns_of(folder):
    return {
        path.stem: read_columns(path) for path in sorted((folder / "trajectories").glob("*.csv"))
    }


def test_all_files_are_written(planned):
    names = {path.name for path in planned.iterdir()}
    assert names == {
        "figure.png", "ranking.json", "trajectories", "config.toml", "provenance.json"
    }  # fmt: skip
    assert (planned / "figure.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert list(columns_of(planned)) == ["A", "B", "C"]


def test_the_norms_follow_from_the_files(planned):
    columns = columns_of(planned)
    for trajectory in read_ranking(planned)["trajectories"]:
        c = columns[trajectory["name"]]
        for label, norm in NORMS.items():
            assert norm(c["t"], c["f"]) == pytest.approx(trajectory["norms"][label], rel=1e-9)
            assert norm(c["t"], c["pc"]) == pytest.approx(trajectory["pc_norms"][label], rel=1e-9)
        assert c["d"].min() == pytest.approx(trajectory["min_clearance"], rel=1e-12)


def test_the_columns_follow_from_the_positions(planned, wall):
    clearance, avoidance = TerrainClearance(wall, 5.0), InverseDistance(80.0)
    for c in columns_of(planned).values():
        points = np.column_stack([c["x"], c["y"], c["z"]])
        np.testing.assert_allclose(c["d"], clearance(points), rtol=1e-12)
        np.testing.assert_allclose(c["f"], avoidance(c["d"]), rtol=1e-12)
        profile = collision_probability(Trajectory(c["t"], points), wall, 70.0, max_step=None)
        np.testing.assert_allclose(c["pc"], profile.p, rtol=1e-9, atol=1e-15)
        speeds = np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(c["t"])
        np.testing.assert_allclose(speeds, 30.0, rtol=1e-6)
        np.testing.assert_allclose(points[0], [200, 1000, wall.height(200, 1000) + 60])
        np.testing.assert_allclose(points[-1], [2800, 1000, wall.height(2800, 1000) + 60])
        assert c["d"].min() > 10.0 - 1e-9
        assert c["z"].max() <= 200.0 + 1e-9


def test_letters_are_in_order_of_the_probability_of_collision(planned):
    columns = columns_of(planned)
    risks = [Lp(2)(c["t"], c["pc"]) for c in columns.values()]
    assert risks == sorted(risks)


def test_paths_take_the_same_time_and_differ(planned):
    columns = list(columns_of(planned).values())
    durations = [c["t"][-1] for c in columns]
    assert max(durations) <= 1.3 * min(durations)
    paths = [np.column_stack([c["x"], c["y"], c["z"]])[::20] for c in columns]
    distance = math.dist((200, 1000), (2800, 1000))
    for k, path in enumerate(paths):
        for other in paths[:k]:
            assert frechet_distance(path, other) > 0.02 * distance - 20.0


def test_provenance_says_where_each_path_comes_from(planned):
    facts = json.loads((planned / "provenance.json").read_text(encoding="utf-8"))
    assert facts["seed"] == 1
    assert {"ompl", "numpy", "numba", "ompl-risk", "python"} <= set(facts["versions"])
    assert list(facts["paths"]) == ["A", "B", "C"]
    tasks = [c["task"] for c in facts["candidates"]]
    assert len(tasks) == 8
    assert set(facts["paths"].values()) <= set(tasks)
    assert facts["selection"].startswith("3 of 8 candidates chosen")
    duration = read_ranking(planned)["trajectories"][0]["duration"]
    lengths = {c["task"]: c["length"] for c in facts["candidates"]}
    assert lengths[facts["paths"]["A"]] == pytest.approx(30.0 * duration, rel=1e-9)


def test_the_written_configuration_repeats_the_run(planned, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # paths in it are absolute
    again = tmp_path / "again"
    config = str(planned / "config.toml")
    assert main(["plan", "--config", config, "--output", str(again)]) == 0
    for name in ("ranking.json", "config.toml"):
        assert filecmp.cmp(planned / name, again / name, shallow=False), name


def test_the_command_line_wins_over_the_configuration(planned, tmp_path):
    out = tmp_path / "two"
    config = str(planned / "config.toml")
    arguments = ["--count", "2", "--norms", "H1", "--output", str(out)]
    assert main(["plan", "--config", config, *arguments]) == 0
    ranking = read_ranking(out)
    assert [t["name"] for t in ranking["trajectories"]] == ["A", "B"]
    assert list(ranking["orders"]) == ["H1"]
    text = (out / "config.toml").read_text(encoding="utf-8")
    assert 'norms = ["H1"]' in text
    assert "count = 2\n" in text


def test_worker_processes_give_the_same(planned, tmp_path):
    out = tmp_path / "workers"
    config = str(planned / "config.toml")
    assert main(["plan", "--config", config, "--workers", "2", "--output", str(out)]) == 0
    assert filecmp.cmp(planned / "ranking.json", out / "ranking.json", shallow=False)


def test_fewer_paths_than_wanted_are_ranked_and_told(wall_file, tmp_path, capsys):
    arguments = ["plan", "--terrain", wall_file, *QUICK, "--runs", "1", "--separation", "0.2"]
    assert main([*arguments, "--output", str(tmp_path / "few")]) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert "2 of 4 candidates chosen (2 too like a chosen one) instead of 3." in output


def test_no_path_is_an_error_that_says_why(wall_file, tmp_path, refused):
    arguments = ["plan", "--terrain", wall_file, *QUICK, "--output", tmp_path / "none"]
    arguments[arguments.index("--ceiling") + 1] = "90"
    line = refused(*arguments)
    assert "0 of 8 candidates chosen (8 without a path)" in line
    assert "--ceiling" in line


def test_one_path_is_nothing_to_compare(wall_file, tmp_path, refused):
    arguments = ["plan", "--terrain", wall_file, *QUICK, "--output", tmp_path / "one"]
    line = refused(*arguments, "--separation", "1")
    assert "1 of 8 candidates chosen" in line
    assert "--separation" in line


def test_failed_runs_are_told(wall_file, tmp_path, refused, monkeypatch):
    def failing(problem, tasks, **_):
        return [Candidate(t, Status.FAILED, reason="it broke") for t in tasks]

    monkeypatch.setattr("ompl_risk.planners.candidates", failing)
    line = refused("plan", "--terrain", wall_file, *QUICK, "--output", tmp_path / "failed")
    assert "BITstar length seed 1: it broke" in line


def test_ctrl_c_keeps_what_was_found(wall_file, tmp_path, capsys, monkeypatch):
    def interrupted(problem, tasks, *, workers, on_done):
        on_done(Candidate(Task("BITstar", Length(), 4), Status.SOLVED, np.eye(3), 1.0))
        on_done(Candidate(Task("BITstar", Length(), 5), Status.NO_PATH))
        raise KeyboardInterrupt

    monkeypatch.setattr("ompl_risk.planners.candidates", interrupted)
    out = tmp_path / "stopped"
    assert main(["plan", "--terrain", wall_file, *QUICK, "--output", str(out)]) == 130
    assert without_notice(capsys.readouterr().err) == ["stopped; what had been written is kept"]
    (kept,) = (out / "candidates").iterdir()
    assert kept.name == "BITstar-length-seed-4.csv"
    c = read_columns(kept)
    np.testing.assert_array_equal(np.column_stack([c["x"], c["y"], c["z"]]), np.eye(3))


@pytest.mark.skipif(os.name != "posix", reason="process groups")
def test_ctrl_c_stops_real_workers_with_one_line(tmp_path):
    out = tmp_path / "stopped"
    command = [
        sys.executable,
        "-m",
        "ompl_risk",
        "plan",
        "--planner",
        "portfolio",
        "--effort",
        "100",
    ]
    run = subprocess.Popen(
        [*command, "--output", str(out)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # as a terminal does, the signal goes to the whole group
    )
    try:
        for _ in range(600):
            if (out / "config.toml").exists():
                break
            time.sleep(0.1)
        time.sleep(2.0)
        os.killpg(run.pid, signal.SIGINT)
        _, errors = run.communicate(timeout=30)
    finally:
        if run.poll() is None:
            os.killpg(run.pid, signal.SIGKILL)
    assert run.returncode == 130
    assert without_notice(errors) == ["stopped; what had been written is kept"]


def test_runs_without_an_output_folder_get_one_by_the_time(wall_file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    arguments = ["plan", "--terrain", wall_file, *QUICK, "--runs", "1", "--norms", "L1"]
    assert main(arguments) == 0
    assert main(arguments) == 0
    runs = sorted((tmp_path / "runs").iterdir())
    assert len(runs) == 2
    assert filecmp.cmp(runs[0] / "ranking.json", runs[1] / "ranking.json", shallow=False)
