"""``python -m benchmarks helicopter``: it repeats nothing, loses nothing and says what it does."""

import re

import pytest
from scenario_work import answer, refused

from benchmarks import __main__ as command
from benchmarks.scenario import cli, procedure
from benchmarks.scenario.records import PAIRS
from benchmarks.working import WorkersDiedError


def run(folder, *options):
    """The command in this process; pairs have no flights unless `procedure` is patched."""
    common = ["--workers", "1", "--no-example", "--output", str(folder)]
    return command.main(["helicopter", *common, *options])


@pytest.fixture
def asked(monkeypatch):
    """Seeds of the roadmaps that are asked for, which come without flights; 2 fails."""
    seeds = []

    def flights(_ends, seed, **_):
        seeds.append(seed)
        return refused() if seed == 2 else []

    monkeypatch.setattr(procedure, "flights", flights)
    return seeds


def test_a_failed_pair_does_not_stop_the_others(tmp_path, asked, capsys):
    assert run(tmp_path / "a", "--pairs", "3") == 1
    assert asked == [1, 2, 3]  # pair k has seed k + 1
    told = capsys.readouterr()
    assert re.search(r"^2/3  0:0\d left  pair 1 failed: RuntimeError: no wind$", told.err, re.M)
    assert "3 pairs: 0 judged, 2 with fewer than five flights, 1 failed" in told.out
    assert "pair 1: RuntimeError: no wind" in told.out
    assert "left" not in told.out
    assert {p.name for p in (tmp_path / "a").iterdir()} == {
        "hits.png", "pairs", "report.md", "sessions.jsonl",
    }  # fmt: skip
    assert run(tmp_path / "a", "--pairs", "3") == 1  # it is done, if not well
    assert run(tmp_path / "a", "--pairs", "3", "--retry-failed") == 1
    assert asked == [1, 2, 3, 2]
    assert run(tmp_path / "a", "--pairs", "4") == 1
    assert asked == [1, 2, 3, 2, 4]
    assert len((tmp_path / "a" / "sessions.jsonl").read_text().splitlines()) == 4


def test_a_broken_record_is_told_and_done_again(tmp_path, asked, capsys):
    run(tmp_path, "--pairs", "3")
    PAIRS.path(tmp_path, 2).write_text("{")
    run(tmp_path, "--pairs", "3")
    assert asked == [1, 2, 3, 3]
    err = capsys.readouterr().err
    assert "0002.json is no record of pair 2" in err
    assert "2 of 3 pairs were done before" in err


def test_other_places_are_another_procedure(tmp_path, asked, capsys):
    assert run(tmp_path, "--pairs", "1", "--places", "60") == 0
    assert "roadmaps of 60 places, where the procedure has 3000" in capsys.readouterr().out
    before = PAIRS.path(tmp_path, 0).read_bytes()
    assert run(tmp_path, "--pairs", "1") == 2
    err = capsys.readouterr().err
    assert err.startswith(f"error: output = '{tmp_path}': must be another folder")
    assert "places: 60 there, 3000 here" in err
    assert run(tmp_path, "--pairs", "1", "--places", "60", "--seed", "5") == 2
    assert PAIRS.path(tmp_path, 0).read_bytes() == before
    assert len((tmp_path / "sessions.jsonl").read_text().splitlines()) == 1
    assert asked == [1]


def test_workers_that_die_for_good_end_it_with_a_message(tmp_path, asked, monkeypatch, capsys):
    def dying(_folder, seed, numbers, places, **_):
        yield answer(seed, numbers[0], places)
        raise WorkersDiedError(numbers[1:], "pairs")

    monkeypatch.setattr(cli, "finished", dying)
    assert run(tmp_path, "--pairs", "3") == 1
    err = capsys.readouterr().err
    assert "error: worker processes died 3 times" in err
    assert "2 pairs are left; if memory ran out, fewer --workers need less" in err
    assert "the same command goes on from here" in err
