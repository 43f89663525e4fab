"""`ompl-risk plan --vehicle helicopter`: flights of equal time, with everything to replay them."""

import filecmp
import json

import numpy as np
import pytest
from PIL import Image
from run_files import read_columns, read_ranking

from ompl_risk import TerrainClearance, read_trajectory
from ompl_risk.cli import main
from ompl_risk.helicopter import Helicopter, Limits
from ompl_risk.helicopter.flight_file import read_flight

SCENE = (
    "--vehicle", "helicopter", "--start", "300", "1000", "--goal", "2700", "1000",
    "--ceiling", "200", "--min-clearance", "10", "--margin", "0.3", "--d0", "80",
    "--uncertainty", "70", "--samples", "400", "--workers", "1", "--duration-tolerance", "0.3",
    "--count", "3",
)  # fmt: skip


@pytest.fixture(scope="module")
def flown(wall_file, tmp_path_factory):
    folder = tmp_path_factory.mktemp("plan") / "run"
    assert main(["plan", "--terrain", wall_file, *SCENE, "--output", str(folder)]) == 0
    return folder


def test_flights_replay_exactly_beside_their_plan_and_within_the_limits(flown):
    files = sorted((flown / "flights").glob("*.npz"))
    assert [file.stem for file in files] == ["A", "B", "C"]
    for file in files:
        flight = read_flight(file)
        np.testing.assert_array_equal(flight.replay(Helicopter()), flight.states)
        assert flight.deviation.distance <= 0.5
        assert flight.deviation.degrees <= 1.0
        flight.check_limits(Limits())


def test_flights_keep_clear_and_begin_and_end_in_hover(flown, wall):
    clearance = TerrainClearance(wall, 5.0)
    for file in (flown / "flights").glob("*.npz"):
        states = read_flight(file).states
        assert clearance(np.ascontiguousarray(states[:, :3])).min() > 10.0 - 0.5
        for state, (x, y) in ((states[0], (300.0, 1000.0)), (states[-1], (2700.0, 1000.0))):
            place = [x, y, wall.height(x, y) + 60.0]
            np.testing.assert_allclose(state[:3], place, atol=0.3)
            np.testing.assert_allclose(state[7:], 0.0, atol=0.1)


def test_trajectories_have_attitude_velocity_and_inputs(flown):
    for name in "ABC":
        columns = read_columns(flown / "trajectories" / f"{name}.csv")
        wanted = ["qx", "qw", "vx", "vz", "u_c", "u_psi", "gamma_p", "gamma_r", "d", "f", "pc"]
        assert set(wanted) <= set(columns)
        trajectory = read_trajectory(flown / "trajectories" / f"{name}.csv")
        flight = read_flight(flown / "flights" / f"{name}.npz")
        assert trajectory.duration == pytest.approx(flight.duration, abs=1e-9)
        at = np.column_stack(
            [np.interp(trajectory.t, flight.t, flight.states[:, k]) for k in range(3)]
        )
        np.testing.assert_allclose(trajectory.positions, at, atol=0.05)
        steps = np.diff(trajectory.positions, axis=0) / np.diff(trajectory.t)[:, None]
        between = 0.5 * (trajectory.velocities[1:] + trajectory.velocities[:-1])
        # samples are 0.1 s apart: at 1 g the velocity is within 0.5 m/s of the mean between two
        np.testing.assert_allclose(steps, between, atol=0.5)


def test_flights_rank_as_they_were_planned(flown, wall_file, tmp_path):
    judged = ["--d0", "80", "--uncertainty", "70", "--duration-tolerance", "0.3"]
    kinds = {"flights": "*.npz", "trajectories": "*.csv"}
    for folder, pattern in kinds.items():
        files = [str(file) for file in sorted((flown / folder).glob(pattern), reverse=True)]
        out = tmp_path / folder
        assert main(["rank", wall_file, *files, *judged, "--output", str(out)]) == 0
        assert read_ranking(out) == read_ranking(flown), folder


def test_durations_are_equal_within_the_tolerance(flown):
    durations = [t["duration"] for t in read_ranking(flown)["trajectories"]]
    assert max(durations) <= 1.301 * min(durations)
    facts = json.loads((flown / "provenance.json").read_text(encoding="utf-8"))
    assert sorted(one["seconds"] for one in facts["flights"]) == pytest.approx(sorted(durations))
    assert facts["roadmap"]["vertices"] > 100
    assert facts["primitives"]["file"] == "xcell60.npz"
    assert len(facts["primitives"]["sha256"]) == 64


def test_views_of_the_flights_are_drawn(flown):
    with Image.open(flown / "flights.png") as image:
        assert image.width >= 1200


def test_the_written_configuration_repeats_the_run(flown, tmp_path):
    again, config = tmp_path / "again", str(flown / "config.toml")
    assert main(["plan", "--config", config, "--workers", "2", "--output", str(again)]) == 0
    assert filecmp.cmp(flown / "ranking.json", again / "ranking.json", shallow=False)


def test_a_film_of_the_safest_flight(wall_file, tmp_path, monkeypatch):
    from ompl_risk.cli import flights

    monkeypatch.setattr(flights, "FRAMES", 4)
    out = tmp_path / "film"
    scene = [*SCENE, "--animation", "gif", "--output", str(out)]
    assert main(["plan", "--terrain", wall_file, *scene]) == 0
    safest = read_ranking(out)["orders"]["H1"][0]
    with Image.open(out / f"flight-{safest}.gif") as film:
        assert film.n_frames == 4


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--planner", "bitstar"], ["planner", "bitstar", "roadmap"]),
        (["--speed", "20"], ["speed", "20", "helicopter"]),
        (["--samples", "0"], ["samples", "at least 1"]),
        (["--effort", "2"], ["effort", "no use"]),
        (["--roadmap-norm", "H2"], ["norm"]),
        (["--start-height", "3"], ["start-height", "collision"]),
    ],
)
def test_wrong_settings_are_refused_before_work_starts(
    wall_file, tmp_path, refused, arguments, words
):
    out = tmp_path / "none"
    scene = list(SCENE)
    del scene[scene.index("--samples") : scene.index("--samples") + 2]
    line = refused("plan", "--terrain", wall_file, *scene, *arguments, "--output", out)
    assert all(word in line for word in words), line
    assert not out.exists()


def test_a_point_is_not_filmed(wall_file, tmp_path, refused):
    out = tmp_path / "none"
    scene = [*SCENE[2:], "--animation", "gif", "--output", out]
    line = refused("plan", "--terrain", wall_file, *scene)
    assert all(word in line for word in ("animation", "--vehicle point", "no use")), line
    assert not out.exists()


def test_no_flight_is_an_error_that_says_why(wall_file, tmp_path, refused):
    arguments = ["plan", "--terrain", wall_file, *SCENE, "--output", tmp_path / "none"]
    arguments[arguments.index("--ceiling") + 1] = "90"
    line = refused(*arguments)
    assert "no path in a roadmap of" in line


def test_a_film_that_cannot_be_written_is_refused_before_work_starts(
    wall_file, tmp_path, refused, monkeypatch
):
    from ompl_risk.report import film_files

    monkeypatch.setattr(film_files.FFMpegWriter, "isAvailable", lambda: False)
    out = tmp_path / "none"
    line = refused("plan", "--terrain", wall_file, *SCENE, "--animation", "mp4", "--output", out)
    assert all(word in line for word in ("MP4", "ffmpeg", ".gif")), line
    assert not out.exists()


def test_the_pareto_set_is_written_as_planned(wall_file, tmp_path):
    out = tmp_path / "front"
    scene = [*SCENE, "--pareto", "--roadmap-norm", "L2", "--output", str(out)]
    assert main(["plan", "--terrain", wall_file, *scene]) == 0
    front = read_columns(out / "pareto.csv")
    files = sorted((out / "pareto").glob("*.csv"))
    assert len(files) == len(front["path"]) > 1
    for file, seconds in zip(files, front["duration_s"], strict=True):
        trajectory = read_trajectory(file)
        assert trajectory.duration == pytest.approx(float(seconds), abs=1e-6)
        assert np.linalg.norm(trajectory.velocities, axis=1).max() < 31.0
        np.testing.assert_allclose(trajectory.positions[-1, :2], [2700.0, 1000.0], atol=1e-6)
