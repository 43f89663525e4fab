"""Pairs of the scenario: what is found for each, and kept whatever happens to the rest."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from scenario_work import answer, refused
from scipy.stats import kendalltau

from benchmarks.scenario import procedure
from benchmarks.scenario.findings import claims
from benchmarks.scenario.fingerprint import fingerprint
from benchmarks.scenario.records import PAIRS, evaluate, keep, kept
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
    PAIRS.path(tmp_path, 1).write_bytes(content)
    said = []
    assert list(kept(tmp_path, 0, 3, say=said.append)) == [0, 2]
    (message,) = said
    assert message.startswith(f"{PAIRS.path(tmp_path, 1)} is no record of pair 1 (")
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


def start(folder):
    line = [sys.executable, "-m", "benchmarks", "helicopter", "--pairs", "6", "--workers", "1"]
    return subprocess.Popen(
        [*line, "--places", str(FEW), "--no-example", "--output", str(folder)],
        cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
