"""Metrics, timing, report and command line of the benchmarks."""

import gc
import io
import json
import math
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import pytest
from rich.console import Console

from benchmarks import __main__ as command
from benchmarks import report
from benchmarks.metric import Metric, Peer, Spread, Target, comparison, error, figure
from benchmarks.registry import BENCHMARKS, Benchmark
from benchmarks.timing import interleaved


def test_spread_is_median_and_quartiles():
    assert Spread.of([5.0, 1.0, 2.0, 4.0, 3.0]) == Spread(3.0, 2.0, 4.0)
    assert Spread.of([1.0, 2.0]).median == 1.5
    assert Spread.of(7.0) == Spread(7.0, 7.0, 7.0)
    assert Spread.of([1.0, math.inf, math.inf]) == Spread(math.inf, 1.0, math.inf)
    assert math.isnan(Spread.of([1.0, math.nan]).median)


@pytest.mark.parametrize(("better", "good", "bad"), [("lower", 1.9, 2.1), ("higher", 2.1, 1.9)])
def test_a_target_is_a_limit_in_the_right_direction(better, good, bad):
    metric = lambda value: figure("m", value, "s", better=better, target=Target(2.0))  # noqa: E731
    assert metric(good).met is True
    assert metric(2.0).met is True
    assert metric(bad).met is False
    assert metric(math.nan).met is False
    assert figure("m", bad, "s").met is None


@pytest.mark.parametrize(("better", "theirs"), [("lower", [8.0, 30.0]), ("higher", [0.5, 0.3])])
def test_the_advantage_is_of_pairs_and_better_when_higher(better, theirs):
    ours = np.array([2.0, 3.0])
    metric = comparison(
        "m", ours, "s", "peer", np.array(theirs), better=better,
        target=Target(7.0, of="advantage"),
    )  # fmt: skip
    assert metric.advantage == Spread(7.0, 4.0, 10.0)
    assert metric.peer == Peer("peer", Spread.of(theirs))
    assert metric.met is True


def test_no_path_of_either_is_no_advantage():
    nothing = np.array([math.inf])
    target = Target(1.0, of="advantage")
    both = comparison("m", nothing, "s", "peer", nothing, target=target)
    assert both.met is False
    peer_only = comparison("m", np.array([1.0]), "s", "peer", nothing, target=target)
    assert peer_only.met is True


def test_only_missed_correctness_fails():
    assert error("e", [1e-12, -3e-9], "m", 1e-9).failed is True
    assert error("e", [1e-12, -1e-10], "m", 1e-9).failed is False
    assert error("e", [math.nan], "m", 1e-9).failed is True
    slow = figure("t", 9.0, "s", target=Target(1.0))
    assert slow.met is False
    assert slow.failed is False


def test_tasks_take_turns_in_alternating_order_after_a_warm_up():
    calls = []
    tasks = [lambda k, name=name: calls.append((name, k)) for name in "ab"]
    seconds = interleaved(3, *tasks)
    assert calls == [(n, k) for k in range(4) for n in ("ba" if k % 2 else "ab")]
    assert seconds.shape == (2, 3)
    assert (seconds > 0.0).all()


def test_processor_time_leaves_out_waiting():
    wait = lambda _: time.sleep(0.05)  # noqa: E731
    assert interleaved(1, wait).max() < 0.05
    assert interleaved(1, wait, clock=time.perf_counter).min() >= 0.05


def test_timing_gives_the_collector_back_after_an_error():
    def fail(_):
        assert not gc.isenabled()
        raise KeyError

    with pytest.raises(KeyError):
        interleaved(1, fail)
    assert gc.isenabled()


METRICS = [
    comparison(
        "speed",
        np.array([0.2]),
        "us",
        "peer",
        np.array([12.0]),
        target=Target(50.0, of="advantage"),
    ),
    figure("cost", math.inf, "s/m^2", target=Target(1.0)),
    error("error", 1.0, "m", 1e-9),
]


def test_the_table_says_it_all():
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(report.table("title", METRICS))
    lines = [" ".join(line.split()) for line in console.export_text().splitlines()]
    assert [line for line in lines if "=" in line] == [
        "speed 0.2 us 12 peer 60 >= 50 times yes",
        "cost inf s/m^2 <= 1 NO",
        "error 1 m <= 1e-09 WRONG",
    ]


def test_the_document_is_strict_json():
    text = report.document({"x": METRICS}, seed=3, configuration={"x": {"repeats": (1, 2)}})
    read = json.loads(text, parse_constant=pytest.fail)
    assert read["seed"] == 3
    assert read["configuration"] == {"x": {"repeats": [1, 2]}}
    speed, cost, wrong = read["metrics"]
    assert (speed["benchmark"], speed["unit"], speed["met"]) == ("x", "us", True)
    assert speed["value"]["median"] == 0.2
    assert speed["peer"]["name"] == "peer"
    assert speed["advantage"]["median"] == pytest.approx(60.0)
    assert speed["target"] == {"limit": 50.0, "of": "advantage", "correctness": False}
    assert cost["value"]["median"] == "inf"
    assert wrong["met"] is False


@dataclass(frozen=True)
class Settings:
    size: int


@pytest.fixture
def fake(monkeypatch):
    """Replaces the benchmarks by one whose metric is given; records how it was called."""
    calls = []

    def install(metric):
        def measure(config, seed, say):
            say("at it")
            calls.append((config.size, seed))
            yield metric

        benchmark = Benchmark(measure, Settings(100), Settings(1))
        registry = MappingProxyType({"fake": benchmark, "other": benchmark})
        monkeypatch.setattr(command, "BENCHMARKS", registry)
        return calls

    return install


GOOD, SLOW, WRONG = (
    figure("fine", 0.5, "s", target=Target(1.0)),
    figure("slow", 2.0, "s", target=Target(1.0)),
    error("off", 2.0, "m", 1.0),
)


@pytest.mark.parametrize(("metric", "code"), [(GOOD, 0), (SLOW, 0), (WRONG, 1)])
def test_the_exit_code_is_that_of_correctness(fake, capsys, metric: Metric, code):
    fake(metric)
    assert command.main(["--only", "fake"]) == code
    captured = capsys.readouterr()
    assert metric.name in captured.out
    assert ("targets not met: slow" in captured.out) == (metric is SLOW)
    assert ("figures that are wrong: off" in captured.out) == (metric is WRONG)
    assert "fake: at it" in captured.err


def test_one_notice_of_compilation_covers_all_benchmarks(monkeypatch):
    happened = []

    @contextmanager
    def announced(console):
        happened.append("listens" if console.stderr else "would disturb the tables")
        yield
        happened.append("stops")

    def measure(config, seed, say):
        happened.append("measures")
        yield GOOD

    monkeypatch.setattr("benchmarks.running.compilation_announced", announced)
    both = dict.fromkeys(("one", "two"), Benchmark(measure, Settings(2), Settings(1)))
    monkeypatch.setattr(command, "BENCHMARKS", both)
    assert command.main([]) == 0
    assert happened == ["listens", "measures", "measures", "stops"]


def test_options_reach_the_benchmarks(fake, tmp_path):
    calls = fake(GOOD)
    output = tmp_path / "out.json"
    command.main(["--quick", "--only", "other", "--seed", "7", "--output", str(output)])
    command.main([])
    assert calls == [(1, 7), (100, 0), (100, 0)]
    written = json.loads(output.read_text())
    assert (written["mode"], written["seed"]) == ("quick", 7)
    assert written["configuration"] == {"other": {"size": 1}}
    assert written["machine"]["processors"] >= 1
    assert {"python", "ompl", "python-fcl", "numpy"} <= written["versions"].keys()
    assert [metric["name"] for metric in written["metrics"]] == ["fine"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "nothing"], "'nothing'"),
        (["--seed", "-1"], "'-1': must be a whole number from 0"),
        (["--output", "/no/such/folder/x.json"], "must be a file in a folder that exists"),
    ],
)
def test_wrong_use_is_refused_before_anything_runs(fake, capsys, arguments, message):
    calls = fake(GOOD)
    with pytest.raises(SystemExit) as refusal:
        command.main(arguments)
    assert refusal.value.code == 2
    assert message in capsys.readouterr().err
    assert not calls


def test_it_runs_as_a_module():
    run = subprocess.run(
        [sys.executable, "-m", "benchmarks", "--help"],
        capture_output=True, text=True, check=True, cwd=command.__file__.rsplit("/", 2)[0],
    )  # fmt: skip
    assert all(name in run.stdout for name in BENCHMARKS)
