"""``python -m benchmarks helicopter``: its records, killed, interrupted and started again."""

import json
import re
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from scenario_work import answer, die_always, die_once
from scipy.stats import kendalltau

from benchmarks import __main__ as command
from benchmarks.scenario import cli, procedure
from benchmarks.scenario.findings import claims
from benchmarks.scenario.fingerprint import fingerprint
from benchmarks.scenario.records import evaluate, keep, kept, path_of
from benchmarks.scenario.working import DEATHS, WorkersDiedError, finished
from ompl_risk.errors import ArgumentError

ROOT = Path(__file__).parents[2]
FEW = 60
"""Places of a roadmap that takes half a second."""


@pytest.fixture(scope="module")
def evaluated():
    return [evaluate(0, number, FEW) for number in range(3)]


def test_pairs_are_evaluated(evaluated):
    statuses = [record["status"] for record in evaluated]
    assert set(statuses) <= {"judged", "fewer"}
    assert "judged" in statuses
    for number, record in enumerate(evaluated):
        assert (record["seed"], record["pair"]) == (0, number)
        assert record["procedure"] == fingerprint(FEW)
        ends = procedure.pair(0, number)
        assert (record["start"], record["goal"]) == (list(ends.start), list(ends.goal))
        assert json.loads(json.dumps(record, allow_nan=False)) == record
        assert record["status"] == "judged" or 0 <= record["flights"] < 5


def test_orders_are_those_of_the_norms(evaluated):
    for record in (r for r in evaluated if r["status"] == "judged"):
        names = list(record["durations"])
        assert names == list("ABCDE")
        assert record["pc orders"]["L2"] == names
        assert min(record["least clearances"].values()) > 19.5
        for orders, norms in (("orders", "norms"), ("pc orders", "pc norms")):
            assert list(record[orders]) == ["L1", "L2", "L∞", "H1"]
            for label, order in record[orders].items():
                key = {n: (record[norms][n][label], record["durations"][n]) for n in names}
                assert order == sorted(names, key=key.__getitem__)
        assert record["claims"] == claims(record["orders"], record["pc orders"])
        truth = [record["pc norms"][name]["L2"] for name in names]
        for label, tau in record["tau"].items():
            norms = [record["norms"][name][label] for name in names]
            assert tau == pytest.approx(kendalltau(norms, truth)[0])


def test_a_pair_depends_on_nothing_but_its_number(evaluated):
    again = evaluate(0, 1, FEW)
    assert again | {"seconds": 0} == evaluated[1] | {"seconds": 0}


def refused(*_, **__):
    raise RuntimeError("no wind")


@pytest.mark.parametrize("name", ["pair", "flights"])
def test_what_goes_wrong_is_a_record_too(name, monkeypatch):
    monkeypatch.setattr(procedure, name, refused)
    record = evaluate(0, 4, FEW)
    assert record["status"] == "failed"
    assert record["reason"] == "RuntimeError: no wind"
    assert ("start" in record) == (name == "flights")


def test_what_is_kept_comes_back(tmp_path):
    assert kept(tmp_path / "nothing", 0, 3) == {}
    records = [answer(0, number, 7) for number in range(3)]
    for record in records:
        keep(tmp_path, record)
    keep(tmp_path, records[1])
    assert kept(tmp_path, 0, 3) == dict(enumerate(records))
    assert kept(tmp_path, 0, 2) == dict(enumerate(records[:2]))
    assert sorted(p.name for p in (tmp_path / "pairs").iterdir()) == [
        "0000.json", "0001.json", "0002.json",
    ]  # fmt: skip


def test_a_record_is_there_whole_or_not_at_all(tmp_path, monkeypatch):
    keep(tmp_path, answer(0, 0, 7))

    def torn(self, text, **_):
        self.write_bytes(text.encode()[:20])
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "write_text", torn)
    for number in (0, 1):
        with pytest.raises(KeyboardInterrupt):
            keep(tmp_path, answer(0, number, 8))
    assert kept(tmp_path, 0, 3, say=pytest.fail) == {0: answer(0, 0, 7)}


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "Expecting value"),
        (b'{"seed": 0, "pair": 1, "sta', "Unterminated string"),
        (b"\xff\xfe", "can't decode"),
        (b"[1]", "no object"),
        (b"{}", "without pair, seed, status"),
        (b'{"seed": 0, "pair": 1, "status": "judged", "tau": {}}', "without claims, durations"),
        (b'{"seed": 0, "pair": 1, "status": "failed"}', "without reason"),
        (b'{"seed": 0, "pair": 2, "status": "fewer", "flights": 4}', "pair 2"),
        (b'{"seed": 0, "pair": 1, "status": ["fewer"]}', "status \"['fewer']\""),
    ],
)
def test_a_broken_or_foreign_file_counts_as_not_done(tmp_path, content, why):
    for number in range(3):
        keep(tmp_path, answer(0, number, 7))
    path_of(tmp_path, 1).write_bytes(content)
    said = []
    assert list(kept(tmp_path, 0, 3, say=said.append)) == [0, 2]
    (message,) = said
    assert message.startswith(f"{path_of(tmp_path, 1)} is no record of pair 1 (")
    assert why in message
    assert message.endswith("the pair counts as not done")
    keep(tmp_path, answer(0, 1, 7))
    assert list(kept(tmp_path, 0, 3, say=pytest.fail)) == [0, 1, 2]


def test_records_of_another_seed_or_procedure_are_refused(tmp_path, monkeypatch):
    keep(tmp_path, answer(0, 0, 7))  # without a fingerprint
    keep(tmp_path, answer(0, 1, 7) | {"procedure": fingerprint(procedure.PLACES)})
    assert list(kept(tmp_path, 0, 3)) == [0, 1]
    with pytest.raises(ArgumentError, match=r"0000\.json: seed: 0 there, 2 here\)"):
        kept(tmp_path, 2, 3)
    with pytest.raises(ArgumentError, match=r"another folder.*places: 3000 there, 60 here"):
        kept(tmp_path, 0, 3, FEW)
    monkeypatch.setattr(procedure, "EXCESS", 0.1)
    with pytest.raises(ArgumentError, match=r"0001\.json: excess: 0\.05 there, 0\.1 here"):
        kept(tmp_path, 0, 3)


def test_every_pair_is_worked_on_once(tmp_path):
    records = list(finished(tmp_path, 3, [4, 0, 9], 7, workers=1, say=pytest.fail, work=answer))
    assert sorted(r["pair"] for r in records) == [0, 4, 9]
    assert {(r["seed"], r["flights"]) for r in records} == {(3, 7)}
    assert list(finished(tmp_path, 3, [], 7, workers=2, say=pytest.fail, work=answer)) == []


def test_a_worker_that_dies_loses_nothing_that_was_finished(tmp_path):
    said, work = [], partial(die_once, tmp_path)
    records = list(finished(tmp_path, 0, range(6), 7, workers=2, say=said.append, work=work))
    assert sorted(r["pair"] for r in records) == list(range(6))
    (message,) = said
    told = re.fullmatch(r"a worker process died; (\d) pairs are left and started again", message)
    assert told
    assert kept(tmp_path, 0, 6) == {record["pair"]: record for record in records}
    before = 6 - int(told[1])  # were finished, and are not done again
    for record in records[:before]:
        assert len(list(tmp_path.glob(f"{record['pair']}.*"))) == 1


def collect(coming, records):
    """Like ``records.extend``, but what came before an error stays."""
    for record in coming:
        records.append(record)


def test_workers_that_always_die_are_given_up_in_the_end(tmp_path):
    """Pairs that kill their workers do not keep the others from being done."""
    for number in range(4):  # written anew, as by --retry-failed
        keep(tmp_path, {"seed": 0, "pair": number, "status": "failed", "reason": "x"})
    said, records = [], []
    coming = finished(tmp_path, 0, range(4), 7, workers=2, say=said.append, work=die_always)
    with pytest.raises(WorkersDiedError, match="worker processes died 3 times with") as death:
        collect(coming, records)
    assert sorted(record["pair"] for record in records) == [2, 3]
    assert sorted(death.value.left) == [0, 1]
    assert len(said) >= DEATHS - 1
    statuses = {number: record["status"] for number, record in kept(tmp_path, 0, 4).items()}
    assert statuses == {0: "failed", 1: "failed", 2: "fewer", 3: "fewer"}


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
    path_of(tmp_path, 2).write_text("{")
    run(tmp_path, "--pairs", "3")
    assert asked == [1, 2, 3, 3]
    err = capsys.readouterr().err
    assert "0002.json is no record of pair 2" in err
    assert "2 of 3 pairs were done before" in err


def test_other_places_are_another_procedure(tmp_path, asked, capsys):
    assert run(tmp_path, "--pairs", "1", "--places", "60") == 0
    assert "roadmaps of 60 places, where the procedure has 3000" in capsys.readouterr().out
    before = path_of(tmp_path, 0).read_bytes()
    assert run(tmp_path, "--pairs", "1") == 2
    err = capsys.readouterr().err
    assert err.startswith(f"error: output = '{tmp_path}': must be another folder")
    assert "places: 60 there, 3000 here" in err
    assert run(tmp_path, "--pairs", "1", "--places", "60", "--seed", "5") == 2
    assert path_of(tmp_path, 0).read_bytes() == before
    assert len((tmp_path / "sessions.jsonl").read_text().splitlines()) == 1
    assert asked == [1]


def test_workers_that_die_for_good_end_it_with_a_message(tmp_path, asked, monkeypatch, capsys):
    def dying(_folder, seed, numbers, places, **_):
        yield answer(seed, numbers[0], places)
        raise WorkersDiedError(numbers[1:])

    monkeypatch.setattr(cli, "finished", dying)
    assert run(tmp_path, "--pairs", "3") == 1
    err = capsys.readouterr().err
    assert "error: worker processes died 3 times" in err
    assert "2 pairs are left; if memory ran out, fewer --workers need less" in err
    assert "the same command goes on from here" in err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--pairs", "0"], "must be a whole number of at least 1"),
        (["--pairs", "1.5"], "must be a whole number of at least 1"),
        (["--places", "-3"], "must be a whole number of at least 1"),
        (["--workers", "none"], "must be a whole number of at least 1"),
        (["--seed", "-1"], "argument --seed: -1: must be 0 or more"),
        (["--seed", "x"], "invalid int value"),
        (["--terrain", "hills"], "unrecognized arguments"),
    ],
)
def test_wrong_use_is_refused(tmp_path, asked, capsys, options, message):
    with pytest.raises(SystemExit) as refusal:
        run(tmp_path / "a", *options)
    assert refusal.value.code == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "a").exists()


def test_a_file_is_no_folder(tmp_path, asked, capsys):
    (tmp_path / "thesis.tex").write_text("x")
    assert run(tmp_path / "thesis.tex", "--pairs", "1") == 2
    assert "thesis.tex" in capsys.readouterr().err
    assert (tmp_path / "thesis.tex").read_text() == "x"
    assert asked == []


def test_help_names_every_option(capsys):
    with pytest.raises(SystemExit) as ending:
        command.main(["helicopter", "--help"])
    assert ending.value.code == 0
    text = " ".join(capsys.readouterr().out.split())
    for option in ("--pairs", "--quick", "--seed", "--workers", "--places", "--retry-failed"):
        assert f" {option} " in text
    assert "of a roadmap (3000)" in text


def start(folder):
    line = [sys.executable, "-m", "benchmarks", "helicopter", "--pairs", "6", "--workers", "1"]
    return subprocess.Popen(
        [*line, "--places", str(FEW), "--no-example", "--output", str(folder)],
        cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def wait_for_records(process, folder, count):
    while process.poll() is None:
        if len(list(folder.glob("pairs/*.json"))) >= count:
            return
        time.sleep(0.005)
    pytest.fail(f"it ended by itself: {process.communicate()}")


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.glob("pairs/*.json")}


def test_killed_interrupted_and_started_again(tmp_path):
    """It repeats nothing and loses nothing, and the report is of all."""
    folder = tmp_path / "scenario"
    killed = start(folder)
    wait_for_records(killed, folder, 1)
    killed.kill()
    killed.communicate()
    first = contents(folder)

    interrupted = start(folder)
    wait_for_records(interrupted, folder, len(first) + 1)
    interrupted.send_signal(signal.SIGINT)
    _, told = interrupted.communicate(timeout=60)
    assert interrupted.returncode == 130, told
    assert "stopped; every finished pair is kept, and the same command goes on from here" in told
    assert "Traceback" not in told
    second = contents(folder)
    assert len(second) < 6
    assert first.items() <= second.items()

    last = start(folder)
    out, told = last.communicate(timeout=120)
    assert last.returncode == 0, told
    lines = told.splitlines()
    assert lines[0] == f"{len(second)} of 6 pairs were done before"
    done = [re.fullmatch(r"(\d)/6  \d+:\d\d left  pair (\d) (judged|fewer)", x) for x in lines[1:]]
    assert [int(one[1]) for one in done if one] == list(range(len(second) + 1, 7))
    assert lines[-1].startswith("6/6  0:00 left")
    whole = contents(folder)
    assert second.items() <= whole.items()
    assert sorted(whole) == [f"{number:04d}.json" for number in range(6)]
    assert f"in {folder}: report.md, hits.png, pairs/" in out
    judged = sum(b'"status": "judged"' in record for record in whole.values())
    assert f"6 pairs: {judged} judged" in out
    assert f"6 pairs: {judged} judged" in (folder / "report.md").read_text()
    assert (folder / "hits.png").stat().st_size > 0
