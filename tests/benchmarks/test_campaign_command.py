"""The campaign as a command: killed, interrupted and started again."""

import json

import pytest

from benchmarks.campaign import cli
from benchmarks.campaign.execution import execute
from benchmarks.campaign.planners import PLANNERS
from benchmarks.campaign.run import Run
from benchmarks.campaign.store import Store

SMALL = (
    "--seconds", "0.2", "--seeds", "2", "--scenes", "circles", "--objectives", "length",
    "--planners", "RRTstar", "BITstar", "--workers", "1",
)  # fmt: skip


@pytest.mark.parametrize("planner", PLANNERS)
def test_a_run_judges_what_its_planner_found(planner):
    if PLANNERS[planner].missing():
        pytest.skip(PLANNERS[planner].missing())
    run = Run("circles", "length", planner, 3, 0.4)
    result = execute(run)
    assert result["status"] == "solved", result
    assert result["cost"] == pytest.approx(result["length"])
    assert result["metrics"]["duration"] == pytest.approx(result["length"] / 5.0)
    times, costs = zip(*result["curve"], strict=True)
    assert list(costs) == sorted(set(costs), reverse=True)
    assert costs[-1] == pytest.approx(result["cost"], rel=1e-6)
    assert list(times) == sorted(times)
    assert times[0] >= 0.0
    assert times[-1] <= result["seconds"] + 1e-3
    assert result["path"][0] == pytest.approx([4.0, 4.0, 5.0])
    assert json.dumps(result, allow_nan=False)


def test_what_goes_wrong_in_a_run_is_its_result():
    result = execute(Run("circles", "nothing", "RRTstar", 1, 0.1))
    assert result == {"status": "failed", "reason": "KeyError: 'nothing'"}
    result = execute(Run("circles", "H1", "RRTstar", 1, 1e-6))
    assert result["status"] in ("no path", "solved")


def test_failed_runs_are_done_unless_asked_for_again(tmp_path, monkeypatch):
    asked = []

    def fake(left, **_):
        asked.append([run.identity for run in left])
        for run in left:
            yield run, {"status": "failed", "reason": "x"}

    monkeypatch.setattr(cli, "finished", fake)
    monkeypatch.setattr(cli, "write_all", lambda *_: [])
    arguments = [*SMALL[:8], "--planners", "RRTstar", "--output", str(tmp_path / "c")]
    assert cli.main(arguments) == 1
    assert cli.main(arguments) == 1
    assert cli.main([*arguments, "--retry-failed"]) == 1
    assert [len(each) for each in asked] == [2, 0, 2]
    assert cli.main([*arguments, "--seeds", "3"]) == 1
    assert asked[-1] == [("circles", "length", "RRTstar", 3)]
    with Store(tmp_path / "c") as store:
        assert len(store.records) == 3


def test_planners_that_are_missing_are_left_out_with_a_message(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("benchmarks.campaign.planners.ROADMAP", "ompl_risk.planners.no_such")
    monkeypatch.setattr(cli, "finished", lambda left, **_: iter(()))
    arguments = ["--planners", "RiskRoadmap", "--output", str(tmp_path / "c")]
    assert cli.main(arguments) == 1
    told = " ".join(capsys.readouterr().err.split())
    assert "RiskRoadmap is left out: this ompl_risk has no RiskRoadmap" in told
    assert "nothing to report" in told


def test_a_folder_with_something_else_is_refused(tmp_path, capsys):
    (tmp_path / "thesis.tex").write_text("x")
    assert cli.main([*SMALL, "--output", str(tmp_path)]) == 2
    assert "a campaign's folder or a new one" in capsys.readouterr().err
