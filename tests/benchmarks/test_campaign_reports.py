"""From records to tables, OMPL's log and database, and figures."""

import csv
import math
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from campaign_work import record
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.campaign import curve, table
from benchmarks.campaign.curve import Watch
from benchmarks.campaign.database import write_database
from benchmarks.campaign.figures import convergence_figure, matrix_figure, pareto_figure
from benchmarks.campaign.figures.convergence import best_so_far, quantiles
from benchmarks.campaign.figures.matrix import ratios
from benchmarks.campaign.figures.pareto import front
from benchmarks.campaign.metrics import METRICS
from benchmarks.campaign.ompl_log import RISK, SAMPLES, progress, write_logs
from benchmarks.campaign.report import markdown, notes
from benchmarks.campaign.summary import standings, summary_rows, verdicts
from benchmarks.campaign.table import curve_rows, row, write_csv, write_parquet
from benchmarks.metric import Spread
from benchmarks.progress import clock
from ompl_risk.errors import FileError

NOTHING = {"status": "no path", "metrics": {}, "curve": [], "cost": None, "length": None}


def with_metric(name, value, **options):
    made = record(**options)
    made["result"]["metrics"][name] = value
    return made


@pytest.fixture
def records():
    """Two objectives, two planners, three seeds; one run without a path, one that crashed."""
    made = [
        with_metric(
            "H1", 0.1 * seed + 0.01 * k + j, seed=seed, planner=planner, objective=objective
        )
        for k, planner in enumerate(("RRTstar", "BITstar"))
        for j, objective in enumerate(("H1", "length"))
        for seed in (1, 2, 3)
    ]
    made[0] = record(1, **NOTHING, reason="no exact solution in time")
    made[-1] = record(3, objective="length", planner="BITstar", **NOTHING) | {
        "result": {"status": "failed", "reason": "the worker process died: SIGSEGV(-11)"}
    }
    return made


def test_the_watch_counts_processor_time(monkeypatch):
    wall, cpu, costs = [0.0], [0.0], iter([math.inf, 5.0, 5.0, 6.0, 4.0, 3.0])
    monkeypatch.setattr(curve.time, "perf_counter", lambda: wall[0])
    monkeypatch.setattr(curve.time, "process_time", lambda: cpu[0])
    watch = Watch(1.0, lambda: next(costs))
    stops = []
    for _ in range(6):
        stops.append(watch())
        stops.append(watch())  # at once: neither clock nor planner is asked
        wall[0] += 1.0
        cpu[0] += 0.25
    assert stops == [False] * 8 + [True] * 4
    assert watch.rows == [(0.25, 5.0), (1.0, 4.0), (1.25, 3.0)]
    assert watch.in_processor_time([(0.0, 9.0), (2.5, 8.0), (5.0, 7.0)]) == [
        (0.0, 9.0), (0.625, 8.0), (1.25, 7.0),
    ]  # fmt: skip


def test_progress_is_what_was_best_at_the_time():
    rows = progress([[0.5, 4.0], [1.5, 0.25]], 2.0)
    assert len(rows) == SAMPLES
    assert rows[-1] == (2.0, 0.25)
    for t, cost in rows:
        assert cost == (math.inf if t < 0.5 else 4.0 if t < 1.5 else 0.25)


def test_ompls_script_takes_everything_over(records, tmp_path):
    logs = write_logs(tmp_path / "ompl", records, "2026-01-01 00:00:00")
    path = tmp_path / "benchmark.db"
    assert write_database(path, logs, records)[:3] == (12, 10, 12 * SAMPLES)
    with closing(sqlite3.connect(path)) as database:
        found = database.execute(
            "SELECT plannerConfigs.name, run_seed, risk_H1_tau_1_s, solved, enums.description "
            "FROM runs JOIN plannerConfigs ON plannerConfigs.id = plannerid "
            "JOIN enums ON enums.name = 'status' AND enums.value = status"
        ).fetchall()
        best = database.execute(
            "SELECT MIN(best_cost), COUNT(best_cost) FROM progress WHERE time < 1.49 GROUP BY runid"
        ).fetchall()
        (experiment,) = database.execute(
            "SELECT name, timelimit, runcount, d0, version FROM experiments"
        ).fetchall()
    expected = set()
    for each in records:
        c, r = each["configuration"], each["result"]
        status = {"solved": "Exact solution", "no path": "Timeout", "failed": "Crash"}[r["status"]]
        risk = float(f"{r['metrics']['H1']:.10g}") if r["status"] == "solved" else None
        name = f"{c['planner']} for {c['objective']}"
        expected.add((name, c["seed"], risk, int(r["status"] == "solved"), status))
    assert set(found) == expected
    assert sorted(best, key=str) == sorted([(4.0, 25)] * 10 + [(None, 0)] * 2, key=str)
    assert experiment[:4] == ("circles", 2.0, 3, 8.0)
    assert experiment[4].startswith("OMPL 2.")


def test_a_database_with_less_than_was_given_is_refused(records, tmp_path):
    logs = write_logs(tmp_path / "ompl", records[:-1], "2026-01-01 00:00:00")
    with pytest.raises(FileError, match="holds"):
        write_database(tmp_path / "benchmark.db", logs, records)
    logs[0].write_text("nonsense")
    with pytest.raises(FileError, match="failed"):
        write_database(tmp_path / "benchmark.db", logs, records)
    assert not (tmp_path / "benchmark.db").exists()


def test_every_metric_has_a_column_in_the_database():
    assert list(RISK) == list(METRICS)
    assert all(name.replace(" ", "").isalnum() for name in RISK.values())


def test_a_run_without_a_path_counts_as_the_worst(records):
    found = {
        (s.planner, s.objective): s
        for s in standings([row(r) for r in records])
        if s.metric == "H1"
    }
    best = found["RRTstar", "H1"]
    assert (best.runs, best.solved) == (3, 2)
    assert (best.spread.low, best.spread.high) == (0.2, math.inf)
    assert best.spread.median == pytest.approx(0.3)
    assert found["BITstar", "length"].spread.high == math.inf
    clearance = [s for s in standings([row(records[0])]) if s.metric == "clearance"]
    assert clearance[0].spread.median == -math.inf


def test_winners_and_their_equals():
    values = {"L1": [1.0, 2.0, 3.0], "L2": [2.5, 2.5, 2.5], "H1": [3.5, 4.0, 5.0]}
    made = [
        with_metric("clearance", value, seed=seed, objective=objective)
        for objective, each in values.items()
        for seed, value in enumerate(each, 1)
    ]
    made += [with_metric("L2", 7.0, objective="Linf", seed=k, **NOTHING) for k in (1, 2, 3)]
    rows = [row(each) for each in made]
    judged = verdicts(standings(rows))
    most = judged["circles", "clearance", "RRTstar"]
    assert most.winner is not None
    assert (most.winner.objective, most.equals) == ("H1", ())
    flipped = [
        each | {"clearance": None if each["clearance"] is None else 10.0 - each["clearance"]}
        for each in rows
    ]
    least = verdicts(standings(flipped))["circles", "clearance", "RRTstar"]
    assert least.winner is not None
    assert least.winner.objective == "L1"
    assert [each.objective for each in least.equals] == ["L2"]
    marked = [e for e in summary_rows(standings(rows)) if e["metric"] == "clearance" and e["wins"]]
    assert [(e["objective"], e["median"], e["solved"]) for e in marked] == [("H1", 4.0, 3)]
    assert judged["circles", "L2", "RRTstar"].winner is not None
    nobody = verdicts(standings([row(each) for each in made[-3:]]))
    assert nobody["circles", "L2", "RRTstar"].winner is None


def test_the_summary_tells_what_went_wrong(records):
    text = markdown([row(each) for each in records])
    assert "12 runs: 1 no path, 10 solved, 1 failed" in text
    assert "failed: circles, length by BITstar, seed 3: the worker process died: SIGSEGV" in text
    assert "| H1 [√s/m] | H1 0.3 [0.2, none] = length | H1 0.21 [0.11, 0.31] |" in text
    slow = [row(record(1)) | {"wall seconds": 9.0, "code": "other"}, row(record(2))]
    found = notes(slow)
    assert any("2 states of the code" in note for note in found)
    assert any("busy: in 1 of 2 runs" in note for note in found)
    assert not any("busy" in note or "states" in note for note in notes([row(record(1))]))


def test_tables_are_read_back(records, tmp_path):
    rows = [row(each) for each in records]
    write_csv(tmp_path / "runs.csv", rows)
    with (tmp_path / "runs.csv").open(newline="") as file:
        back = list(csv.DictReader(file))
    assert [e["status"] for e in back] == [e["status"] for e in rows]
    assert [e["H1"] for e in back] == ["" if e["H1"] is None else str(e["H1"]) for e in rows]
    assert back[0]["cost"] == ""
    assert back[1]["value"] == "0.5"  # the root of a cost of 0.25
    described = {each["column"] for each in table.columns()}
    assert set(METRICS) <= described
    assert described <= set(rows[0])
    assert [each["cost"] for each in curve_rows(records[1:2])] == [4.0, 0.25]


def test_parquet_holds_the_same(records, tmp_path):
    rows = [row(each) for each in records]
    path = tmp_path / "runs.parquet"
    if write_parquet(path, rows):
        parquet = pytest.importorskip("pyarrow.parquet")
        assert parquet.read_table(path).to_pylist() == rows
    else:
        assert not path.exists()


def test_quantiles_do_not_mix_with_infinity():
    samples = np.array([[1.0, 1.0], [2.0, math.inf], [3.0, math.inf], [math.inf, math.inf]])
    assert quantiles(samples).tolist() == [[2.0, math.inf], [2.5, math.inf], [3.0, math.inf]]
    for column in samples.T:
        found = Spread.of(column)
        assert quantiles(column[:, None]).ravel().tolist() == [found.low, found.median, found.high]
    times = np.array([0.1, 0.5, 1.0, 2.0])
    assert best_so_far([(0.5, 4.0), (1.5, 2.0)], times).tolist() == [math.inf, 4.0, 4.0, 2.0]
    assert best_so_far([], times).tolist() == [math.inf] * 4


def test_ratios_are_over_the_best():
    assert ratios(np.array([2.0, 4.0, math.inf, 3.0])).tolist() == [1.0, 2.0, math.inf, 1.5]
    assert ratios(np.array([2.0, 4.0, -math.inf]), higher=True).tolist() == [2.0, 1.0, math.inf]
    assert ratios(np.array([0.0, 0.0, 1.0])).tolist() == [1.0, 1.0, math.inf]
    bounded = ratios(np.array([0.0, 0.0, 1.0, 0.25]), zero=0.5)
    assert bounded.tolist() == [1.0, 1.0, 2.0, 1.0]
    assert ratios(np.array([math.inf])).tolist() == [math.inf]


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=1, max_size=30))
def test_the_front_is_what_nothing_beats(points):
    array = np.array(points, dtype=float)
    found = {tuple(array[i]) for i in front(array)}
    beaten = lambda a, b: b[0] <= a[0] and b[1] <= a[1] and b != a  # noqa: E731
    assert found == {a for a in points if not any(beaten(a, b) for b in points)}
    assert len(front(array)) == len(found)


def test_figures_show_the_numbers(records):
    figure = convergence_figure("circles", records)
    shown = [axes for axes in figure.axes if axes.get_title(loc="left")]
    assert [axes.get_title(loc="left") for axes in shown] == ["length [m]", "$H^1$, 1 s [√s/m]"]
    by_label = {line.get_label(): line.get_ydata() for line in shown[1].get_lines()}
    assert set(by_label) == {"RRTstar", "BITstar"}
    assert by_label["BITstar"][-1] == pytest.approx(0.5)  # the root of the last cost
    assert "no path: 1/3 RRTstar" in shown[1].texts[-1].get_text()
    matrix = matrix_figure("circles", standings([row(each) for each in records]))
    assert [axes.get_title(loc="left") for axes in matrix.axes] == ["RRTstar", "BITstar"]
    texts = [text.get_text() for text in matrix.axes[0].texts]
    assert "2/3" in texts
    assert "4.00" in texts  # length 1.2 against H1 0.3
    pareto = pareto_figure("circles", [row(each) for each in records])
    assert len(pareto.axes) == 8
    assert all(len(axes.get_lines()) == 11 for axes in pareto.axes)  # 10 paths and the front


def test_a_probability_of_zero_comes_with_its_bound():
    made = [
        with_metric("pc ever", value, objective=objective, seed=seed)
        for objective, value in (("H1", 0.0), ("length", 0.2))
        for seed in (1, 2)
    ]
    for each in made:
        each["result"]["metrics"]["pc ever high"] = each["result"]["metrics"]["pc ever"] + 0.04
        each["result"]["metrics"]["pc ever low"] = 0.0
    rows = [row(each) for each in made]
    assert "| pc ever | H1 0 {0, 0.04} |" in markdown(rows)
    texts = [text.get_text() for text in matrix_figure("circles", standings(rows)).axes[0].texts]
    assert "≤ 0.04" in texts
    assert "5.00" in texts
    for each in made[:2]:
        each["result"]["metrics"]["pc L2"] = 0.0
    axes = pareto_figure("circles", [row(each) for each in made]).axes[7]
    assert axes.texts[-1].get_text() == "on the bottom edge: 2 paths of 0"
    assert len(axes.get_lines()) == 5


def test_figures_of_nothing():
    nothing = [record(seed, **NOTHING) for seed in (1, 2)]
    rows = [row(each) for each in nothing]
    assert convergence_figure("circles", nothing).axes[0].texts
    assert "no path" in [
        t.get_text() for t in matrix_figure("circles", standings(rows)).axes[0].texts
    ]
    assert pareto_figure("circles", rows).axes[0].texts[0].get_text() == "no path"


@pytest.mark.parametrize(("seconds", "text"), [(7.4, "0:07"), (61.0, "1:01"), (3750.0, "1:02:30")])
def test_time_left(seconds, text):
    assert clock(seconds) == text
