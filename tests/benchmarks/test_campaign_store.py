"""The campaign's records and its worker processes: nothing is lost, nothing is done twice."""

import json
import math
import os

import pytest
from campaign_work import answer, misbehave, sigint_is_blocked

from benchmarks.campaign import run as run_module
from benchmarks.campaign.processes import finished
from benchmarks.campaign.run import Run, configuration, key, runs
from benchmarks.campaign.store import RUNS, Store
from ompl_risk.errors import ArgumentError, FileError

RUN = Run("circles", "H1", "RRTstar", 1, 0.5)
OTHER = Run("circles", "H1", "RRTstar", 2, 0.5)


@pytest.fixture
def folder(tmp_path):
    """A folder with one finished run."""
    with Store(tmp_path / "campaign") as store:
        store.add(RUN, {"status": "solved", "cost": math.inf, "curve": [(0.1, 2.5)]})
    return tmp_path / "campaign"


def test_runs_are_all_combinations_seed_by_seed():
    found = runs(["a", "b"], ["x"], ["p", "q", "p"], 2, 3.0)
    assert len(found) == len(set(found)) == 8
    assert [run.seed for run in found] == [1] * 4 + [2] * 4
    assert found[0] == Run("a", "x", "p", 1, 3.0)


def test_records_are_read_back(folder):
    with Store(folder) as store:
        (record,) = store.records.values()
    assert record["result"] == {"status": "solved", "cost": "inf", "curve": [[0.1, 2.5]]}
    assert float(record["result"]["cost"]) == math.inf
    assert record["key"] == key(configuration(RUN))
    assert record["configuration"]["scene recipe"]["count"] == 40
    assert json.loads((folder / RUNS).read_text(), parse_constant=pytest.fail)


@pytest.mark.parametrize("end", [b'{"key": "ab', b"\n\n{", b'{"a": 1}', b"\xff\x00"])
def test_what_is_left_of_a_torn_line_is_cut_off(folder, end):
    path = folder / RUNS
    whole = path.read_bytes()
    path.write_bytes(whole + end.replace(b"\n", b""))
    with Store(folder) as store:
        assert list(store.records) == [RUN.identity]
        store.add(OTHER, {"status": "no path"})
    assert path.read_bytes().startswith(whole)
    with Store(folder) as store:
        assert list(store.records) == [RUN.identity, OTHER.identity]


def test_a_record_cut_anywhere_counts_as_not_done(folder):
    whole = (folder / RUNS).read_bytes()
    for cut in (1, len(whole) // 2, len(whole) - 1):
        (folder / RUNS).write_bytes(whole[:cut])
        with Store(folder) as store:
            assert not store.records
        assert (folder / RUNS).read_bytes() == b""


@pytest.mark.parametrize("line", [b"nonsense\n", b"{}\n", b'{"configuration": 3}\n', b"\n"])
def test_a_broken_line_before_the_last_is_an_error(folder, line):
    path = folder / RUNS
    whole = path.read_bytes()
    path.write_bytes(whole + line + whole)
    with pytest.raises(FileError, match="line 2 is no record"):
        Store(folder)
    path.write_bytes(whole)
    with Store(folder):  # the lock was given back
        pass


def test_a_later_record_of_a_run_counts(folder):
    with Store(folder) as store:
        store.add(RUN, {"status": "failed"})
    with Store(folder) as store:
        assert [r["result"]["status"] for r in store.records.values()] == ["failed"]


def test_runs_of_another_configuration_are_refused(folder, monkeypatch):
    with Store(folder) as store:
        store.check(0.5)
        with pytest.raises(ArgumentError, match=r"seconds: 0\.5 there, 3\.0 here"):
            store.check(3.0)
        monkeypatch.setattr(run_module.metrics, "STEP", 0.125)
        with pytest.raises(ArgumentError, match=r"judged with\.step: 0\.2 there, 0\.125 here"):
            store.check(0.5)


def test_runs_of_what_is_no_more_are_refused(folder):
    path = folder / RUNS
    path.write_text(path.read_text().replace('"circles"', '"squares"'))
    with Store(folder) as store, pytest.raises(ArgumentError, match="squares"):
        store.check(0.5)


def test_the_key_depends_on_everything():
    base = configuration(RUN)
    assert key(base) == key(json.loads(json.dumps(base)))
    others = [configuration(Run(*RUN.identity[:3], 2, 0.5)), base | {"processor": "another"}]
    others += [base | {"versions": base["versions"] | {"ompl": "9"}}]
    assert len({key(each) for each in (base, *others)}) == 4


def test_two_campaigns_do_not_share_a_folder(folder):
    with Store(folder), pytest.raises(ArgumentError, match="no other campaign is writing"):
        Store(folder)


def test_foreign_folders_and_files_are_refused(tmp_path):
    (tmp_path / "precious.txt").write_text("x")
    with pytest.raises(ArgumentError, match="a campaign's folder or a new one"):
        Store(tmp_path)
    with pytest.raises(FileError):
        Store(tmp_path / "precious.txt" / "campaign")
    assert [path.name for path in tmp_path.iterdir()] == ["precious.txt"]


def test_each_run_has_a_fresh_process():
    wanted = runs(["circles"], ["H1"], ["RRTstar"], 3, 0.0)
    found = dict(finished(wanted, workers=2, grace=60.0, work=answer))
    assert {run: result["seed"] for run, result in found.items()} == {r: r.seed for r in wanted}
    assert len({result["pid"] for result in found.values()} | {os.getpid()}) == 4
    assert all(result["calls"] == 1 for result in found.values())


def test_processes_that_die_hang_or_raise_cost_their_own_run_only(capfd):
    wanted = runs(["circles"], ["H1"], ["RRTstar"], 5, 0.0)
    found = dict(finished(wanted, workers=2, grace=8.0, work=misbehave))
    results = {run.seed: result for run, result in found.items()}
    assert [results[k]["status"] for k in (1, 2, 3, 4, 5)] == [
        "solved", "failed", "failed", "failed", "solved",
    ]  # fmt: skip
    assert results[2]["reason"] == "ValueError: no such thing"
    assert results[3]["reason"] == "the worker process died: SIGKILL(-9)"
    assert results[4]["reason"] == "no answer after 8 s: killed"


def test_ctrl_c_is_the_parents_business():
    ((_, result),) = finished([RUN], workers=1, grace=60.0, work=sigint_is_blocked)
    assert result["blocked"]
