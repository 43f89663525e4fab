"""The campaign as a command: killed, interrupted and started again."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from benchmarks.campaign import cli
from benchmarks.campaign.execution import execute
from benchmarks.campaign.planners import PLANNERS
from benchmarks.campaign.run import Run
from benchmarks.campaign.store import RUNS, SESSIONS, Store

ROOT = Path(__file__).parents[2]
SMALL = (
    "--seconds", "0.2", "--seeds", "2", "--scenes", "circles", "--objectives", "length",
    "--planners", "RRTstar", "BITstar", "--workers", "1",
)  # fmt: skip


def start(folder, *options):
    command = [sys.executable, "-m", "benchmarks.campaign", *SMALL, "--output", str(folder)]
    return subprocess.Popen(
        [*command, *options], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def wait_for_records(process, folder, count):
    path = folder / RUNS
    while process.poll() is None:
        if path.exists() and path.read_bytes().count(b"\n") >= count:
            return
        time.sleep(0.01)
    pytest.fail(f"it ended by itself: {process.communicate()}")


def living(parent):
    """Process ids of the children of a process, as far as the system tells."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            state, ppid = path.read_text().rsplit(")", 1)[1].split()[:2]
            if int(ppid) == parent and state != "Z":
                found.append(int(path.parent.name))
    return found


def is_alive(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def identities(folder):
    facts = [json.loads(line)["configuration"] for line in (folder / RUNS).open()]
    return [(c["scene"], c["objective"], c["planner"], c["seed"]) for c in facts]


def test_killed_interrupted_and_started_again(tmp_path):
    """It repeats nothing and loses nothing, and the reports are as if nothing had happened."""
    folder = tmp_path / "campaign"
    killed = start(folder)
    wait_for_records(killed, folder, 1)
    workers = living(killed.pid)
    killed.kill()
    killed.communicate()
    deadline = time.monotonic() + 60.0
    while any(map(is_alive, workers)):
        assert time.monotonic() < deadline, "workers of a killed campaign live on"
        time.sleep(0.05)
    kept = (folder / RUNS).read_bytes()
    whole = kept[: kept.rfind(b"\n") + 1]
    (folder / RUNS).write_bytes(whole + b'{"key": "torn')

    interrupted = start(folder)
    wait_for_records(interrupted, folder, whole.count(b"\n") + 1)
    interrupted.send_signal(signal.SIGINT)
    _, told = interrupted.communicate(timeout=60)
    assert interrupted.returncode == 130, told
    assert "the same command goes on from here" in told
    assert "Traceback" not in told

    done = (folder / RUNS).read_bytes()
    assert done.startswith(whole)
    last = start(folder)
    out, told = last.communicate(timeout=120)
    assert last.returncode == 0, told
    assert f"{done.count(bytes([10]))} of 4 runs were done before" in told
    assert (folder / RUNS).read_bytes().startswith(done)
    expected = [("circles", "length", p, k) for k in (1, 2) for p in ("RRTstar", "BITstar")]
    assert identities(folder) == expected
    assert len((folder / SESSIONS).read_text().splitlines()) == 3
    assert "4 runs: 4 solved" in out
    for name in (
        "summary.md", "runs.csv", "curves.csv", "summary.csv", "columns.csv", "ompl/circles.log",
        "ompl/benchmark.db", "figures/convergence-circles.png", "figures/matrix-circles.png",
        "figures/pareto-circles.png",
    ):  # fmt: skip
        assert (folder / name).stat().st_size > 0

    other = start(folder, "--seconds", "0.3")
    _, told = other.communicate(timeout=60)
    assert other.returncode == 2
    assert "seconds: 0.2 there, 0.3 here" in told
    assert identities(folder) == expected


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--seconds", "0"], "must be a positive number of seconds"),
        (["--seconds", "nan"], "must be a positive number of seconds"),
        (["--seeds", "1.5"], "must be a whole number of at least 1"),
        (["--scenes", "moon"], "'moon'"),
        (["--objectives", "L3"], "'L3'"),
        (["--planners", "PRM"], "'PRM'"),
        (["--workers", str(len(os.sched_getaffinity(0)) + 1)], "take each other's time"),
    ],
)
def test_wrong_use_is_refused(arguments, message, capsys, tmp_path):
    with pytest.raises(SystemExit) as refusal:
        cli.main([*arguments, "--output", str(tmp_path / "c")])
    assert refusal.value.code == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "c").exists()


def test_a_folder_with_something_else_is_refused(tmp_path, capsys):
    (tmp_path / "thesis.tex").write_text("x")
    assert cli.main([*SMALL, "--output", str(tmp_path)]) == 2
    assert "a campaign's folder or a new one" in capsys.readouterr().err
