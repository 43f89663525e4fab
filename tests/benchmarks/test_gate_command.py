"""``python -m benchmarks --gate`` and ``--update-baseline``."""

import math
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import pytest

from benchmarks import __main__ as command
from benchmarks import baseline
from benchmarks.metric import comparison, error, figure
from benchmarks.readings import readings
from benchmarks.registry import Benchmark


@dataclass(frozen=True)
class Settings:
    size: int


@pytest.fixture
def measured(monkeypatch):
    """Two benchmarks whose metrics the test chooses: measured["one"] = [...]."""
    found = {
        "one": [figure("count", 5, "edges"), error("error", 1e-12, "m", 1e-9)],
        "two": [comparison("speed", np.array([1.0]), "us", "peer", np.array([10.0]))],
    }
    registry = {
        name: Benchmark(lambda _c, _s, _say, name=name: iter(found[name]), Settings(2), Settings(1))
        for name in found
    }
    monkeypatch.setattr(command, "BENCHMARKS", MappingProxyType(registry))
    return found


@pytest.fixture
def file(tmp_path, measured, capsys):
    """A baseline of them."""
    path = tmp_path / "baseline.json"
    assert command.main(["--update-baseline", "--baseline", str(path)]) == 0
    assert f"3 figures written to {path}" in " ".join(capsys.readouterr().out.split())
    return path


def gated(file, *options):
    return command.main(["--gate", "--baseline", str(file), *options])


def test_the_baseline_says_where_it_is_from(file):
    known = baseline.load(file)
    assert (known.mode, known.seed) == ("quick", 0)
    assert known.facts["machine"]["processors"] >= 1
    assert "numpy" in known.facts["versions"]
    assert known.facts["configuration"] == {"one": {"size": 1}, "two": {"size": 1}}
    assert known.readings["two: speed"].value == 10.0


def test_the_gate_is_open_for_what_is_as_it_was(file, measured, capsys):
    measured["two"] = [comparison("speed", np.array([1.0]), "us", "peer", np.array([6.0]))]
    assert gated(file) == 0
    out = capsys.readouterr().out
    assert "3 figures: 3 kept" in out
    assert "gate open" in out


@pytest.mark.parametrize(
    ("benchmark", "now", "line"),
    [
        ("one", [figure("count", 6, "edges"), error("error", 1e-12, "m", 1e-9)],
         "one: count 5 edges 6 edges 1.2 times <= 5.1 worse"),
        ("two", [comparison("speed", np.array([1.0]), "us", "peer", np.array([4.0]))],
         "two: speed 10 times peer 4 times peer 2.5 times >= 5 worse"),
        ("two", [comparison("speed", np.array([math.nan]), "us", "peer", np.array([4.0]))],
         "two: speed 10 times peer nan times peer ? >= 5 worse"),
        ("two", [], "two: speed 10 times peer >= 5 gone"),
        ("two", [comparison("speed", np.array([1.0]), "us", "other", np.array([10.0]))],
         "two: speed 10 times peer 10 times other 1 times >= 5 changed"),
    ],
)  # fmt: skip
def test_the_gate_closes(file, measured, capsys, benchmark, now, line):
    measured[benchmark] = now
    assert gated(file) == 1
    out = capsys.readouterr().out
    assert line in [" ".join(each.split()) for each in out.splitlines()]
    assert "gate CLOSED" in out


def test_wrong_figures_close_the_gate_even_within_the_tolerance(file, measured, capsys):
    measured["one"][1] = error("error", 1.005e-9, "m", 1e-9)
    baseline.save(file, replace(baseline.load(file), readings=readings(measured, 1.0)))
    assert gated(file) == 1
    out = capsys.readouterr().out
    assert "3 figures: 3 kept" in out
    assert "figures that are wrong: error" in out
    assert "gate CLOSED" in out


def test_new_and_better_figures_are_told_and_pass(file, measured, capsys):
    measured["one"] += [figure("more", 1.0, "m")]
    measured["two"] = [comparison("speed", np.array([1.0]), "us", "peer", np.array([90.0]))]
    assert gated(file) == 0
    lines = [" ".join(each.split()) for each in capsys.readouterr().out.splitlines()]
    assert "one: more 1 m new" in lines
    assert "two: speed 10 times peer 90 times peer 0.111 times >= 5 better" in lines
    assert "4 figures: 2 kept, 1 better, 1 new" in lines


def test_a_part_is_compared_with_its_part(file, measured, capsys):
    measured["two"] = []
    assert gated(file, "--only", "one") == 0
    assert "2 figures: 2 kept" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--full"], "of a quick run with seed 0, but this is a full run with seed 0"),
        (["--seed", "1"], "of a quick run with seed 0, but this is a quick run with seed 1"),
    ],
)
def test_another_run_is_no_comparison(file, measured, capsys, options, message):
    measured.clear()  # so that running anything fails
    assert gated(file, *options) == 2
    assert message in " ".join(capsys.readouterr().err.split())


def test_without_a_baseline_nothing_runs(tmp_path, measured, capsys):
    measured.clear()
    assert gated(tmp_path / "none.json") == 2
    assert "no such file" in " ".join(capsys.readouterr().err.split())


def test_what_is_wrong_does_not_become_the_baseline(file, measured, capsys):
    before = file.read_text()
    measured["one"] = [error("error", 1.0, "m", 1e-9)]
    assert command.main(["--update-baseline", "--baseline", str(file)]) == 2
    assert "the baseline stays as it was" in " ".join(capsys.readouterr().err.split())
    measured["one"] = [figure("odd", math.nan, "m")]
    assert command.main(["--update-baseline", "--baseline", str(file)]) == 2
    assert file.read_text() == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--gate", "--update-baseline"], "not allowed with"),
        (["--update-baseline", "--only", "one"], "a baseline is of everything"),
        (["--baseline", "x.json"], "only with --gate or --update-baseline"),
        (["--quick", "--full"], "not allowed with"),
        (["peers", "--gate"], "unrecognized arguments: --gate"),
        (["rivals"], "unrecognized arguments: rivals"),
    ],
)
def test_options_that_do_not_fit(measured, capsys, options, message):
    measured.clear()
    with pytest.raises(SystemExit) as refusal:
        command.main(options)
    assert refusal.value.code == 2
    assert message in " ".join(capsys.readouterr().err.split())
