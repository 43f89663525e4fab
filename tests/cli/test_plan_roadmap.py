"""`ompl-risk plan` by the roadmap, which is the default, and its Pareto set."""

import csv
import filecmp
import json

import numpy as np
import pytest
from run_files import read_columns, read_ranking

from ompl_risk import InverseDistance, Sobolev, TerrainClearance, frechet_distance
from ompl_risk.cli import main
from ompl_risk.planners.low_level import low_level_flight
from ompl_risk.planners.roadmap.building import sides_of

SCENE = (
    "--start", "200", "1000", "--goal", "2800", "1000", "--ceiling", "200", "--min-clearance", "10",
    "--margin", "0.3", "--d0", "80", "--uncertainty", "70", "--samples", "4000", "--workers", "1",
    "--duration-tolerance", "0.3",
)  # fmt: skip


@pytest.fixture(scope="module")
def found(wall_file, tmp_path_factory):
    folder = tmp_path_factory.mktemp("plan") / "run"
    arguments = ["plan", "--terrain", wall_file, *SCENE, "--alternatives", "3", "--pareto"]
    assert main([*arguments, "--output", str(folder)]) == 0
    return folder


def paths_in(folder):
    columns = [read_columns(path) for path in sorted(folder.glob("*.csv"))]
    return [(c["t"], np.column_stack([c["x"], c["y"], c["z"]])) for c in columns]


def test_alternatives_are_free_of_equal_time_and_differ(found, wall):
    paths = paths_in(found / "trajectories")
    assert len(paths) == 3
    clearance = TerrainClearance(wall, 5.0)
    problem = low_level_flight(
        clearance, (200, 1000), (2800, 1000), ceiling=200.0, margin=0.3, min_clearance=10.0
    )
    sides = sides_of(problem)
    durations = [t[-1] for t, _ in paths]
    assert max(durations) <= 1.3 * min(durations) * (1 + 1e-9)
    for k, (_, points) in enumerate(paths):
        assert clearance(points).min() > 10.0 - 1e-9
        assert points[:, 2].max() <= 200.0 + 1e-9
        np.testing.assert_allclose(points[0], [200, 1000, wall.height(200, 1000) + 60])
        np.testing.assert_allclose(points[-1], [2800, 1000, wall.height(2800, 1000) + 60])
        for _, other in paths[:k]:
            apart = frechet_distance(points[::10], other[::10]) > 0.02 * 2600.0 - 15.0
            assert apart or sides.word(points) != sides.word(other)
    assert len({sides.word(points) for _, points in paths}) >= 2  # by both passes


def test_the_pareto_set_follows_from_its_paths(found, wall):
    rows = list(csv.DictReader((found / "pareto.csv").open(encoding="utf-8")))
    durations, norms = (np.array([float(row[k]) for row in rows]) for k in ("duration_s", "H1"))
    assert len(rows) > 3
    assert (np.diff(durations) > 0.0).all()
    assert (np.diff(norms) < 0.0).all()
    clearance = TerrainClearance(wall, 5.0)
    paths = paths_in(found / "pareto")
    assert len(paths) == len(rows)
    for k in (0, len(rows) // 2, -1):
        t, points = paths[k]
        assert t[-1] == pytest.approx(durations[k], rel=1e-9)
        s = np.linspace(0.0, t[-1], 20_001)
        dense = np.column_stack([np.interp(s, t, axis) for axis in points.T])
        expected = Sobolev(1)(s, InverseDistance(80.0)(clearance(dense)))
        assert norms[k] == pytest.approx(expected, rel=1e-2)
    assert (found / "pareto.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_provenance_tells_the_roadmap(found):
    facts = json.loads((found / "provenance.json").read_text(encoding="utf-8"))
    assert facts["planner"] == "roadmap"
    assert facts["roadmap"]["vertices"] > 1000
    assert 0 < facts["roadmap"]["evaluated"] <= facts["roadmap"]["edges"]
    assert sorted(facts["paths"]) == ["A", "B", "C"]
    assert facts["selection"].startswith("3 of ")
    assert [t["name"] for t in read_ranking(found)["trajectories"]] == ["A", "B", "C"]


def test_the_written_configuration_repeats_the_run(found, tmp_path):
    again, config = tmp_path / "again", str(found / "config.toml")
    assert main(["plan", "--config", config, "--workers", "2", "--output", str(again)]) == 0
    for name in ("ranking.json", "pareto.csv"):
        assert filecmp.cmp(found / name, again / name, shallow=False), name


def test_a_planner_of_ompl_runs_every_search(wall_file, tmp_path):
    out = tmp_path / "rrtstar"
    scene = [x for x in SCENE if x not in ("--samples", "4000")]
    arguments = ["plan", "--terrain", wall_file, *scene, "--planner", "RRTstar", "--count", "2"]
    searches = ["--searches", "length", "H1@20", "H1@40", "BITstar:H1@40", "--effort", "0.1"]
    assert main([*arguments, *searches, "--output", str(out)]) == 0
    facts = json.loads((out / "provenance.json").read_text(encoding="utf-8"))
    planners = {row["task"].split()[0] for row in facts["candidates"]}
    assert planners == {"RRTstar"}
    assert len(facts["candidates"]) == 6  # three criteria, two runs each


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--planner", "rrt-star"], ["planner", "roadmap", "rrtstar"]),
        (["--planner", "bitstar", "--pareto"], ["pareto", "bitstar", "no use"]),
        (["--samples", "0"], ["samples", "at least 1"]),
        (["--roadmap-norm", "H2"], ["norm"]),
        (["--workers", "0"], ["workers", "at least 1"]),
        (["--count", "1"], ["count", "at least 2"]),
        (["--seed", "0"], ["seed", "at least 1"]),
        (["--effort", "2"], ["effort", "roadmap", "no use"]),
        (["--planner", "portfolio", "--samples", "9"], ["samples", "portfolio", "no use"]),
    ],
)
def test_wrong_settings_are_refused_before_work_starts(
    wall_file, tmp_path, refused, arguments, words
):
    out = tmp_path / "none"
    scene = SCENE[: SCENE.index("--samples")]
    line = refused("plan", "--terrain", wall_file, *scene, *arguments, "--output", out)
    assert all(word in line for word in words), line
    assert not out.exists()


def test_no_path_is_an_error_that_says_why(wall_file, tmp_path, refused):
    arguments = ["plan", "--terrain", wall_file, *SCENE, "--output", tmp_path / "none"]
    arguments[arguments.index("--ceiling") + 1] = "90"
    line = refused(*arguments)
    assert "no path in a roadmap of" in line
    assert "--ceiling" in line


def test_one_path_is_nothing_to_compare(wall_file, tmp_path, refused):
    arguments = ["plan", "--terrain", wall_file, *SCENE, "--output", tmp_path / "one"]
    arguments[arguments.index("--duration-tolerance") + 1] = "0"
    line = refused(*arguments)
    assert "a single path" in line
    assert "--separation" in line
