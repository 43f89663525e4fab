"""`ompl-risk rank` on files of every kind."""

import filecmp

import numpy as np
import pytest
from run_files import read_columns, read_ranking

from ompl_risk import Lp, TerrainClearance, Trajectory
from ompl_risk.cli import main
from ompl_risk.trajectory_files import write_csv


def test_files_of_every_kind_are_ranked(wall, wall_file, files, tmp_path, capsys):
    t, positions = [0.0, 50.0, 100.0], [[200, 1000, 60], [1500, 500, 195], [2800, 1000, 60]]
    np.savez(tmp_path / "numbers.npz", t=t, positions=positions)
    tum = [f"{a} {p[0]} {p[1] + 10} {p[2] + 50} 0 0 0 1" for a, p in zip(t, positions, strict=True)]
    (tmp_path / "tum.txt").write_text("\n".join(tum), encoding="utf-8")
    given = [*files, str(tmp_path / "numbers.npz"), str(tmp_path / "tum.txt")]
    out = tmp_path / "out"
    assert main(["rank", wall_file, *given, "--duration-tolerance", "1", "--output", str(out)]) == 0
    ranking = read_ranking(out)
    assert {t["name"] for t in ranking["trajectories"]} == {"south", "north", "numbers", "tum"}
    clearance = TerrainClearance(wall, 5.0)
    for trajectory in ranking["trajectories"]:
        c = read_columns(out / "trajectories" / f"{trajectory['name']}.csv")
        points = np.column_stack([c["x"], c["y"], c["z"]])
        np.testing.assert_allclose(c["d"], clearance(points), rtol=1e-12)
        assert Lp(1)(c["t"], c["f"]) == pytest.approx(trajectory["norms"]["L1"], rel=1e-9)
        assert Lp(1)(c["t"], c["pc"]) == pytest.approx(trajectory["pc_norms"]["L1"], rel=1e-9)
    assert ranking["orders"]["L1"][0] == "tum"  # the highest
    assert (out / "figure.png").exists()
    assert "south" in capsys.readouterr().out


def test_planned_paths_rank_as_they_did(planned, wall_file, tmp_path):
    paths = [str(path) for path in sorted((planned / "trajectories").iterdir())]
    out = tmp_path / "out"
    judged = ["--d0", "80", "--uncertainty", "70", "--duration-tolerance", "0.3"]
    assert main(["rank", wall_file, *reversed(paths), *judged, "--output", str(out)]) == 0
    assert read_ranking(out) == read_ranking(planned)


def test_the_written_configuration_repeats_the_run(wall_file, files, tmp_path):
    first, again = tmp_path / "first", tmp_path / "again"
    assert main(["rank", wall_file, *files, "--radius", "3", "--output", str(first)]) == 0
    config = str(first / "config.toml")
    assert main(["rank", "--config", config, "--output", str(again)]) == 0
    for name in ("ranking.json", "config.toml"):
        assert filecmp.cmp(first / name, again / name, shallow=False), name


def test_different_durations_are_told_with_the_pareto_set(wall_file, files, tmp_path, capsys):
    slow = tmp_path / "slow.csv"
    write_csv(slow, Trajectory([0, 300], [[200, 1000, 400], [2800, 1000, 400]]))
    out = tmp_path / "out"
    assert main(["rank", wall_file, *files, str(slow), "--output", str(out)]) == 0
    ranking = read_ranking(out)
    assert not ranking["durations_comparable"]
    text = " ".join(capsys.readouterr().out.split())
    assert "Durations differ by" in text
    assert f"L1: {', '.join(ranking['pareto']['L1'])};" in text
    assert "slow" in ranking["pareto"]["L1"]


def test_a_collision_is_ranked_last_and_located(wall_file, files, tmp_path, capsys):
    through = tmp_path / "through.csv"
    write_csv(through, Trajectory.at_constant_speed([[200, 1000, 60], [2800, 1000, 60]], 20.0))
    out = tmp_path / "out"
    assert main(["rank", wall_file, *files, str(through), "--output", str(out)]) == 0
    ranking = read_ranking(out)
    assert all(order[-1] == "through" for order in ranking["orders"].values())
    assert ranking["trajectories"][-1]["norms"]["H1"] == "inf"
    assert "collides, first at t" in " ".join(capsys.readouterr().out.split())
    assert np.isinf(read_columns(out / "trajectories" / "through.csv")["f"]).any()


def test_files_of_one_name_are_told_apart_by_their_folders(wall_file, files, tmp_path):
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / "south.csv"
    write_csv(other, Trajectory.at_constant_speed([[200, 900, 300], [2800, 900, 300]], 20.0))
    out = tmp_path / "out"
    arguments = [wall_file, files[0], str(other), "--duration-tolerance", "1"]
    assert main(["rank", *arguments, "--output", str(out)]) == 0
    names = {t["name"] for t in read_ranking(out)["trajectories"]}
    assert names == {files[0], str(other)}
    assert len(list((out / "trajectories").iterdir())) == 2


def test_a_file_given_twice_is_refused(wall_file, files, refused):
    line = refused("rank", wall_file, files[0], files[0])
    assert files[0] in line
    assert "only once" in line


def test_one_file_is_nothing_to_compare(wall_file, files, refused):
    assert "at least two" in refused("rank", wall_file, files[0])


def test_a_trajectory_that_leaves_the_map_is_refused(wall_file, files, tmp_path, refused):
    away = tmp_path / "away.csv"
    write_csv(away, Trajectory([0, 1, 2], [[0, 0, 500], [3100, 0, 500], [3200, 0, 500]]))
    line = refused("rank", wall_file, files[0], away)
    assert str(away) in line
    assert "2 of 3 samples lie outside the terrain, the first, at t = 1 s, at (3100, 0) m" in line
    assert "x 0 to 3000 m" in line


@pytest.mark.parametrize(
    ("name", "content", "part"),
    [
        ("x.csv", "t,x,y\n0,1,2\n", "no column z"),
        ("x.csv", "t,x,y,z\n0,1,2,3\n0,1,2,3\n", "times must increase"),
        ("x.csv", "t,x,y,z\n0,1,2,nan\n1,1,2,3\n", "nan"),
        ("x.dat", "", "format"),
    ],
)
def test_files_that_are_no_trajectories_are_named(
    wall_file, files, tmp_path, refused, name, content, part
):
    path = tmp_path / name
    path.write_text(content, encoding="utf-8")
    line = refused("rank", wall_file, files[0], path)
    assert str(path) in line
    assert part in line
