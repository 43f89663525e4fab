"""A run's folder is its own, but what a run that was broken off began may be begun again."""

import pytest

from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.errors import ArgumentError


def test_the_folder_of_a_run_that_was_broken_off_is_taken_again(tmp_path):
    RunFolder(tmp_path / "run").write_config("plan", {"seed": 1})
    RunFolder(tmp_path / "run").write_config("plan", {"seed": 2})
    assert "seed = 2" in (tmp_path / "run" / "config.toml").read_text()


@pytest.mark.parametrize("name", ["config.toml", "notes.txt"])
def test_what_somebody_put_there_is_kept(name, tmp_path):
    (tmp_path / name).write_text("seed = 1\n")
    with pytest.raises(ArgumentError, match="output"):
        RunFolder(tmp_path)


def test_results_are_kept(tmp_path):
    RunFolder(tmp_path).write_config("plan", {})
    (tmp_path / "ranking.json").write_text("{}")
    with pytest.raises(ArgumentError, match="output"):
        RunFolder(tmp_path)
