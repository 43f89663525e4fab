"""Wrong use: one line that names the argument, the value and what is allowed; exit code 1."""

import sys

import pytest

from ompl_risk.cli import main
from ompl_risk.cli.config import read_config, to_toml
from ompl_risk.errors import ArgumentError

WRONG = [
    (["--d0", "0"], ["--d0 = 0.0", "positive"]),
    (["--d0", "abc"], ["--d0", "abc", "float"]),
    (["--d0", "nan"], ["--d0 = nan"]),
    (["--radius", "-1"], ["--radius = -1.0", "0 or more"]),
    (["--uncertainty", "0"], ["--uncertainty = 0.0", "positive"]),
    (["--speed", "0"], ["--speed = 0.0", "positive"]),
    (["--norms", "L1", "Q3"], ["--norms = 'Q3'", '"L1"']),
    (["--norms", "L1", "l1"], ["--norms", "only once"]),
    (["--duration-tolerance", "-1"], ["--duration-tolerance = -1.0", "at least 0"]),
    (["--start", "-5", "2"], ["--start = (-5.0, 2.0)", "x 0 to 29978.41 m"]),
    (["--goal", "99999", "2"], ["--goal = (99999.0, 2.0)", "y 0 to 31718.92 m"]),
    (["--start", "5"], ["--start", "2"]),
    (["--start", "nan", "5"], ["--start[0] = nan", "finite"]),
    (["--start-height", "4"], ["--start-height = 4", "571.2 m", "in collision"]),
    (["--goal-height", "22"], ["--goal-height = 22", "too near", "min_clearance = 20 m"]),
    (["--ceiling", "600"], ["--ceiling = 600.0", "at least 631.2 m", "ground at (6500, 16000)"]),
    (["--min-clearance", "-1"], ["--min-clearance = -1.0", "0 or more"]),
    (["--margin", "-1"], ["--margin = -1.0", "at least 0"]),
    (["--planner", "portfolio", "--searches", "speed"], ["--searches = 'speed'", '"H1@20"']),
    (
        ["--planner", "portfolio", "--searches", "SST:length"],
        ["--searches = 'SST'", "BITstar, RRTstar"],
    ),
    (
        ["--planner", "portfolio", "--searches", "FMT:H1@20"],
        ["--searches = 'FMT:H1@20'", "no metric"],
    ),
    (
        ["--planner", "portfolio", "--searches", "H1@100"],
        ["--searches = 'H1@100'", "below d0 = 100 m"],
    ),
    (["--avoidance", "tail"], ["--avoidance = 'tail'", "tail(12)"]),
    (["--avoidance", "tail(12)", "--d0", "50"], ["--d0 = 50", "ends at 48 m"]),
    (["--avoidance", "cap", "--d0", "-3"], ["--d0 = -3", "positive"]),
    (["--rollouts", "0"], ["--rollouts = 0", "at least 1"]),
    (["--disturbances", "wild"], ["--disturbances", "severe"]),
    (["--disturbances", "calm"], ["--disturbances = 'calm'", "left out without --rollouts or"]),
    (
        ["--max-collision-probability", "1"],
        ["--max-collision-probability = 1.0", "between 0 and 1"],
    ),
    (["--max-collision-probability", "1e-7"], ["too many rollouts"]),
    (["--count", "1"], ["--count = 1", "at least 2"]),
    (["--count", "2.5"], ["--count", '"2.5" is no whole number']),
    (["--separation", "0"], ["--separation = 0.0", "positive"]),
    (["--planner", "portfolio", "--runs", "0"], ["--runs = 0", "at least 1"]),
    (["--planner", "portfolio", "--effort", "0"], ["--effort = 0.0", "positive"]),
    (["--seed", "0"], ["--seed = 0", "at least 1"]),
    (["--workers", "0"], ["--workers = 0", "at least 1"]),
    (["--planner", "portfolio", "--time-limit", "0"], ["--time-limit = 0.0", "positive"]),
    (["--terrain", "nowhere.tif"], ["nowhere.tif", "no such file", "jacksboro"]),
    (["--terrain", "hills"], ["--start = None", "x 0 to 12000 m"]),
    (["--terrain-seed", "3"], ["--terrain-seed = 3", "left out for jacksboro"]),
    (["--fill", "zero"], ["zero", "--fill", "interpolate"]),
    (["--bounds", "1", "2", "3"], ["--bounds", "4"]),
    (["--output", "/dev/null/x"], ["/dev/null/x", "Not a directory"]),
    (["--spead", "3"], ["--spead", "--speed", "plan --help"]),
    (["more"], ["more", "plan --help"]),
    (["--config", "missing.toml"], ["missing.toml", "No such file"]),
]


@pytest.mark.parametrize(("arguments", "parts"), WRONG, ids=" ".join)
def test_plan_names_what_is_wrong(arguments, parts, refused, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    line = refused("plan", *arguments)
    for part in parts:
        assert part in line
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("speeed = 3", ["speeed", "c.toml"]),
        ("speed =", ["c.toml", "no TOML", "Invalid value"]),
        ('speed = "fast"', ["speed", "fast", "c.toml"]),
        ("start = [1]", ["start", "expected 2 but got 1"]),
        ("count = 2.5", ["count", '"2.5" is no whole number']),
        ("d0 = true", ["d0", "c.toml"]),
        ("start_height = 4", ["--start-height = 4", "in collision"]),
        ("[plan]\nspeed = 3", ["c.toml", "[plan]", "at the top"]),
    ],
)
def test_a_configuration_that_is_wrong_is_named(text, parts, refused, tmp_path):
    path = tmp_path / "c.toml"
    path.write_text(text, encoding="utf-8")
    line = refused("plan", "--config", path)
    for part in parts:
        assert part in line


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["fly"], "plan, rank, table1, doctor"),
        (["rank"], "terrain"),
        (["rank", "jacksboro"], "files"),
        (["table1", "--output", "x.foo"], "x.foo: is no kind of picture"),
        (["doctor", "now"], "now"),
    ],
)
def test_other_commands_too(arguments, part, refused, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert part in refused(*arguments)


def test_an_occupied_folder_is_left_alone(tmp_path, refused):
    (tmp_path / "kept.txt").write_text("kept", encoding="utf-8")
    line = refused("plan", "--output", tmp_path)
    assert f"--output = '{tmp_path}'" in line
    assert [path.name for path in tmp_path.iterdir()] == ["kept.txt"]


def test_toml_goes_both_ways(tmp_path):
    values = {
        "text": 'a "quoted" \\ ü',
        "number": 0.1,
        "whole": 3,
        "yes": True,
        "endless": float("inf"),
        "several": [1.5, 2.0],
        "names": ["L1", "H1@20"],
    }
    path = tmp_path / "c.toml"
    path.write_text(to_toml({**values, "left_out": None}, "a\nb"), encoding="utf-8")
    assert read_config(path) == values
    with pytest.raises(ArgumentError, match="what"):
        to_toml({"what": object()}, "")


def test_the_process_arguments_are_the_default(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["ompl-risk", "--version"])
    assert main() == 0
    assert capsys.readouterr().out.strip()
