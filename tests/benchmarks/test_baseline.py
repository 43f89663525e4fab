"""The baseline's file."""

import json
import math
from dataclasses import replace

import pytest

from benchmarks import baseline
from benchmarks.baseline import Baseline, BaselineError
from benchmarks.metric import LIMIT_ONLY, Tolerance
from benchmarks.readings import Reading
from benchmarks.registry import BENCHMARKS

KNOWN = Baseline(
    "quick",
    3,
    {
        "a: time": Reading(1.25, "s, by yardstick", "lower", Tolerance(1.0, of="yardstick")),
        "a: no path": Reading(math.inf, "s/m^2", "lower", LIMIT_ONLY),
        "b: error": Reading(0.0, "m", "lower", Tolerance(0.02, absolute=1e-11)),
    },
    {"versions": {"numpy": "2"}},
)


def test_a_baseline_comes_back_as_it_was(tmp_path):
    file = tmp_path / "baseline.json"
    baseline.save(file, KNOWN)
    json.loads(file.read_text(), parse_constant=pytest.fail)  # strict JSON in spite of inf
    assert baseline.load(file) == KNOWN


def broken(change):
    """The known baseline's document with something done to it."""

    def make(path):
        baseline.save(path, KNOWN)
        whole = json.loads(path.read_text())
        change(whole)
        path.write_text(json.dumps(whole))

    return make


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda path: None, "no such file; --update-baseline writes it"),
        (lambda path: path.mkdir(), "directory"),
        (lambda path: path.write_text("{"), "no JSON"),
        (lambda path: path.write_bytes(b"\xff\xfe{"), "no JSON"),
        (lambda path: path.write_text("[1]"), "format None, but this program reads 1"),
        (broken(lambda w: w.update(format=2)), "format 2, but this program reads 1"),
        (broken(lambda w: w.update(format=True)), "format True"),
        (broken(lambda w: w.pop("metrics")), "not as this program writes it: KeyError('metrics')"),
        (broken(lambda w: w.update(metrics=[])), "not as this program writes it"),
        (broken(lambda w: w.update(mode="slow")), "mode 'slow'"),
        (broken(lambda w: w.update(seed="0")), "seed '0'"),
        (broken(lambda w: w["metrics"]["a: time"].pop("unit")), "KeyError('unit')"),
        (broken(lambda w: w["metrics"]["a: time"].update(value="nan")), "a: time: value nan"),
        (broken(lambda w: w["metrics"]["a: time"].update(value="much")), "could not convert"),
        (broken(lambda w: w["metrics"]["a: time"].update(better="bigger")), "'bigger'"),
        (
            broken(lambda w: w["metrics"]["a: time"]["tolerance"].update(relative=-1.0)),
            "tolerance [-1.0, 0.0]",
        ),
    ],
)
def test_a_baseline_that_cannot_be_used(tmp_path, make, message):
    file = tmp_path / "baseline.json"
    make(file)
    with pytest.raises(BaselineError) as refusal:
        baseline.load(file)
    assert message in str(refusal.value)
    assert str(file) in str(refusal.value)


def test_what_must_not_become_a_baseline(tmp_path):
    file = tmp_path / "baseline.json"
    with pytest.raises(BaselineError, match="nothing was measured"):
        baseline.save(file, replace(KNOWN, readings={}))
    with pytest.raises(BaselineError, match="not a number, so it is no baseline: a: bad"):
        baseline.save(
            file,
            replace(KNOWN, readings={"a: bad": replace(KNOWN.readings["a: time"], value=math.nan)}),
        )
    assert not file.exists()
    with pytest.raises(BaselineError, match="directory"):
        baseline.save(tmp_path / "none" / "baseline.json", KNOWN)


def test_the_committed_baseline_fits_the_benchmarks():
    known = baseline.load(baseline.FILE)
    assert (known.mode, known.seed) == ("quick", 0)
    assert {name.split(": ", 1)[0] for name in known.readings} == set(BENCHMARKS)
