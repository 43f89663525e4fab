"""``python -m benchmarks evidence``: it repeats nothing, loses nothing and says what it does."""

import re

import pytest
from evidence_work import COMPLETE, done

from benchmarks import __main__ as command
from benchmarks import working
from benchmarks.evidence import analysis, cli
from benchmarks.evidence.engines import ClusterLostError, Dask, Lost
from benchmarks.evidence.settings import Settings
from benchmarks.evidence.store import NAME, UNITS, compact, keep, kept
from benchmarks.evidence.unit import failed


@pytest.fixture
def reports(monkeypatch):
    """Calls of the report, which does nothing."""
    calls = []

    def report(parquet, folder, console):
        console.print("reported")
        calls.append((parquet, folder))

    monkeypatch.setattr(analysis, "report", report)
    return calls


@pytest.fixture
def asked(monkeypatch, reports):
    """Units that are worked on, which have few flights; 2 fails."""
    units = []

    def evaluate(settings, unit):
        units.append(unit)
        if unit == 2:
            return failed(settings, unit, "RuntimeError: no wind")
        return done(settings, unit, **(COMPLETE if unit == 0 else {}))

    monkeypatch.setattr(cli, "evaluate", evaluate)
    return units


def run(folder, *options):
    """The command in this process."""
    return command.main(["evidence", "--workers", "1", "--output", str(folder), *options])


def test_a_failed_unit_does_not_stop_the_others(tmp_path, asked, reports, capsys):
    folder = tmp_path / "a"
    assert run(folder, "--units", "4") == 1
    assert asked == [0, 1, 2, 3]
    told = capsys.readouterr()
    assert re.search(r"^3/4  0:0\d left  unit 2 failed: RuntimeError: no wind$", told.err, re.M)
    assert re.search(r"^4/4  0:00 left  unit 3 few: 3 flights$", told.err, re.M)
    assert "4 units: 1 complete, 1 failed, 2 few" in told.err
    assert re.search(rf"{NAME}: 0\.\d MB\nreported\n$", told.out)
    assert reports == [(folder / NAME, folder)]
    assert {path.name for path in folder.iterdir()} == {NAME, "sessions.jsonl", "units"}


def test_nothing_is_repeated(tmp_path, asked, capsys):
    assert run(tmp_path, "--units", "3") == 1
    before = UNITS.path(tmp_path, 0).read_bytes()
    assert run(tmp_path, "--units", "3") == 1  # it is done, if not well
    assert run(tmp_path, "--units", "3", "--retry-failed") == 1
    assert asked == [0, 1, 2, 2]
    assert run(tmp_path, "--units", "4") == 1
    assert asked == [0, 1, 2, 2, 3]
    assert run(tmp_path, "--units", "2") == 0
    assert UNITS.path(tmp_path, 0).read_bytes() == before
    assert len((tmp_path / "sessions.jsonl").read_text().splitlines()) == 5
    assert "3 of 4 units were done before" in capsys.readouterr().err


def test_a_failed_unit_can_get_well(tmp_path, asked, monkeypatch):
    run(tmp_path, "--units", "3")
    monkeypatch.setattr(cli, "evaluate", done)
    assert run(tmp_path, "--units", "3", "--retry-failed") == 0
    assert kept(tmp_path, Settings())[2].status == "few"


def test_a_damaged_unit_is_told_and_done_again(tmp_path, asked, capsys):
    run(tmp_path, "--units", "2")
    UNITS.path(tmp_path, 1).write_bytes(b"PAR1")
    assert run(tmp_path, "--units", "2") == 0
    assert asked == [0, 1, 1]
    err = capsys.readouterr().err
    assert "00001.parquet is no result of unit 1" in err
    assert "1 of 2 units were done before" in err


def test_a_unit_that_the_cluster_loses_has_failed(tmp_path, asked, monkeypatch):
    monkeypatch.setattr(Dask, "__init__", lambda *_: None)
    monkeypatch.setattr(Dask, "run", lambda *_: iter([(1, Lost("KilledWorker: x"))]))
    assert run(tmp_path, "--units", "2", "--engine", "dask") == 1
    found = kept(tmp_path, Settings())
    assert (found[1].status, found[1].reason) == ("failed", "KilledWorker: x")


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (working.WorkersDiedError([1], "units"), "worker processes died 3 times .* 1 units"),
        (ClusterLostError("the Dask cluster has gone"), "the Dask cluster has gone"),
    ],
)
def test_workers_that_are_gone_end_it_with_a_message(
    tmp_path, asked, reports, monkeypatch, capsys, error, message
):
    def dying(_self, work, units, _say):
        yield 0, work(0)
        raise error

    monkeypatch.setattr(cli.Local, "run", dying)
    assert run(tmp_path, "--units", "2") == 1
    err = capsys.readouterr().err
    assert re.search(f"error: {message}.*the same command goes on from here", err)
    assert list(kept(tmp_path, Settings())) == [0]
    assert reports == []


def test_units_of_another_procedure_are_refused(tmp_path, asked, capsys):
    run(tmp_path, "--units", "1")
    before = UNITS.path(tmp_path, 0).read_bytes()
    for options in (["--seed", "1"], ["--rollouts", "8"], ["--rollouts", "8", "--report-only"]):
        assert run(tmp_path, "--units", "1", *options) == 2
        assert "another folder, as this one holds units of another" in capsys.readouterr().err
    assert UNITS.path(tmp_path, 0).read_bytes() == before
    assert asked == [0]
    assert len((tmp_path / "sessions.jsonl").read_text().splitlines()) == 1


def test_units_of_two_versions_of_the_code_are_told(tmp_path, asked, capsys):
    keep(tmp_path, done(Settings(), 0, code="older"))
    run(tmp_path, "--units", "2")
    assert "note: they were made by 2 versions of the code" in capsys.readouterr().err


def test_a_report_needs_no_work(tmp_path, asked, reports):
    keep(tmp_path, done(Settings(), 5))
    assert run(tmp_path, "--report-only") == 0
    keep(tmp_path, done(Settings(), 6))
    assert run(tmp_path, "--report-only") == 0
    alone = tmp_path / "alone"  # the file without the units
    alone.mkdir()
    compact(tmp_path, Settings()).rename(alone / NAME)
    assert run(alone, "--report-only") == 0
    assert reports == [(tmp_path / NAME, tmp_path)] * 2 + [(alone / NAME, alone)]
    assert asked == []
    assert not (tmp_path / "sessions.jsonl").exists()


def test_a_report_on_nothing_is_refused(tmp_path, reports, capsys):
    assert run(tmp_path / "none", "--report-only") == 2
    assert f"has neither units nor {NAME}" in capsys.readouterr().err
    assert not (tmp_path / "none").exists()


def test_there_is_no_report_without_a_complete_unit(tmp_path, asked, reports, monkeypatch, capsys):
    monkeypatch.setattr(cli, "evaluate", done)
    assert run(tmp_path, "--units", "2") == 0
    err = capsys.readouterr().err
    assert "2 units: 2 few\nno unit is complete, so there is nothing to report\n" in err
    assert reports == []
    assert not (tmp_path / NAME).exists()


def test_quick_is_small_and_has_its_own_folder(tmp_path, asked, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert command.main(["evidence", "--quick", "--workers", "1"]) == 1
    assert asked == list(range(10))
    found = kept(tmp_path / "runs" / "evidence-quick", Settings(rollouts=100))
    assert list(found) == asked
