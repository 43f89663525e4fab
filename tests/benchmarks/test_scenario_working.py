"""Pairs are worked on in processes, and no death stops the rest."""

import re
from functools import partial

import pytest
from scenario_work import answer, die_always, die_once

from benchmarks.scenario.records import keep, kept
from benchmarks.scenario.working import finished
from benchmarks.working import DEATHS, WorkersDiedError


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
