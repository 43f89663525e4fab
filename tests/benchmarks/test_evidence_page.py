"""The report from the file to the page: every number is the findings', the words follow them."""

import dataclasses
import io
import json
import re

import numpy as np
import pytest
from evidence_tables import incomplete, units, write
from rich.console import Console

from benchmarks.evidence.analysis import report, reporting
from benchmarks.evidence.analysis.__main__ import main
from benchmarks.evidence.analysis.families import family
from benchmarks.evidence.analysis.figures.fits import curve, exponent, fit_curves, length
from benchmarks.evidence.analysis.figures.standing import distinct
from benchmarks.evidence.analysis.findings import Comparison, analyse, compare
from benchmarks.evidence.analysis.fitting import Family
from benchmarks.evidence.analysis.page import code, page
from benchmarks.evidence.analysis.settings import (
    PAPER,
    CorrectedTail,
    ExpectedCollisions,
    NormOf,
    OfDistance,
    Product,
)
from benchmarks.evidence.analysis.statistics import Interval
from benchmarks.evidence.analysis.strata import strata
from benchmarks.evidence.analysis.table import read
from benchmarks.evidence.analysis.tables import difference, number, share, sheets
from benchmarks.evidence.analysis.words import _target, answer
from ompl_risk import InverseDistance, Lp, Sobolev
from ompl_risk.avoidance import GaussianTail
from ompl_risk.probability.crossings import CrossingRate

FEW = (
    family("near", (Lp(1), Sobolev(1)), [OfDistance(InverseDistance(d)) for d in (30.0, 100.0)]),
    family("tail", (Lp(1), Lp(3)), [OfDistance(GaussianTail(s)) for s in (5.0, 8.0)]),
    Family("rate", (ExpectedCollisions(CrossingRate(8.0, correlation_time=3.0)),)),
)


def rule(five, level):
    values = np.array([Lp(1)(f.t, GaussianTail(8.0)(f.d)) for f in five])
    return 1.0 - np.exp(-(1.0, 2.0, 4.0)[level] * values)


@pytest.fixture(scope="module")
def rows():
    more = [incomplete(900), incomplete(901, "train", "few", "4 flights")]
    return units(12, rule, rollouts=300) + more


@pytest.fixture(scope="module")
def parquet(rows, tmp_path_factory):
    return write(tmp_path_factory.mktemp("evidence") / "evidence.parquet", rows)


@pytest.fixture(scope="module")
def findings(parquet):
    return analyse(read(parquet), FEW)


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(reporting, "families", lambda: FEW)


def words(console_or_text):
    return re.sub(r"\s+", " ", console_or_text)


def test_one_call_writes_page_figures_and_tables(few, parquet, findings, tmp_path):
    console = Console(file=io.StringIO(), width=200)
    written = tmp_path / "docs" / "evidence.md"
    report(parquet, tmp_path / "out", console, page=written)
    text = written.read_text(encoding="utf-8")
    images = re.findall(r"!\[.*?\]\((.*?)\)", text)
    assert len(images) == len(set(images)) == 5
    for image in images:
        assert (written.parent / image).read_bytes().startswith(b"\x89PNG")
    tables = json.loads((tmp_path / "out" / "tables.json").read_text(encoding="utf-8"))
    assert [t["title"] for t in tables] == [s.title for s in sheets(findings)]
    for table in tables:
        assert f"## {table['title']}" in text
        assert table["title"].split(":")[0] in console.file.getvalue()
        for line in table["lines"]:
            assert "| " + " | ".join(line) + " |" in text
    for paragraph in answer(findings):
        assert paragraph in text


def test_the_page_tells_seeds_versions_and_failures(findings):
    text = page(findings, tuple(sheets(findings)), {})
    assert '"seed": 7' in text
    assert "- 1 units: RuntimeError: no way" in text
    assert "- 1 units: 4 flights" in text
    assert re.search(r"numpy \d", text)
    assert "rollouts of each flight and level: 300" in text
    assert re.search(r"\| train \| 12 \| 1 \| 0 \| \d+ of 36 \|", text)
    assert re.search(r"\| test \| 12 \| 0 \| 1 \| \d+ of 36 \|", text)


def test_the_numbers_of_the_answer_are_those_of_the_data(findings):
    text = " ".join(answer(findings))
    counted = findings.judge.decided
    found = findings.by_judge.safest[0][counted].mean()
    assert f"finds the safest of five flights in {100 * found:.0f} % [" in text
    assert f"of {counted.sum()} decided test sets" in text
    safest, tau = compare(findings, "safest"), compare(findings, "tau")
    four = [findings.by_judge.safest[k][counted].mean() for k in range(1, 5)]
    assert safest.best == PAPER[int(np.argmax(four))]
    assert safest.by_unit.mean == pytest.approx(found - max(four))
    assert difference("safest", safest.by_unit) in text
    assert difference("tau", tau.by_unit) in text


def test_drawing_lots_is_right_more_often_where_the_judge_ties(findings):
    values = np.where(np.arange(5) < 3, 0.0, 0.5)  # three of five never collide
    judge = dataclasses.replace(
        findings.judge, values=np.broadcast_to(values, findings.judge.values.shape)
    )
    tied = dataclasses.replace(findings, judge=judge)
    assert tied.chance == pytest.approx(0.6)
    assert "drawing lots would in 60 %" in " ".join(answer(tied))


def test_few_test_units_are_warned_of(findings, monkeypatch):
    assert next(answer(findings)).startswith("**Only 12 test units with a decided set")
    monkeypatch.setattr("benchmarks.evidence.analysis.words.ENOUGH", 12)
    assert "Only" not in next(answer(findings))


def test_the_answer_says_whether_the_target_is_reached():
    def made(mean, low, metric):
        interval = Interval(mean, low, mean + 0.1)
        return Comparison(metric, PAPER[0], interval, interval, interval)

    reached = _target(made(0.2, 0.1, "safest"), made(0.1, 0.05, "tau"))
    missed = _target(made(0.05, 0.01, "safest"), made(0.1, 0.05, "tau"))
    assert "**reached**" in reached
    assert "+20.0 points [+10.0, +30.0]" in reached
    assert "**not reached**" in missed


def test_where_the_target_is_missed_it_says_why(findings):
    worse = dataclasses.replace(
        findings,
        by_judge=findings.by_judge._replace(safest=np.zeros_like(findings.by_judge.safest)),
    )
    text = " ".join(answer(worse))
    assert "**not reached**" in text
    assert "Why: L1 of InverseDistance(100 m) is" in text
    better = findings.by_judge.safest.copy()
    better[1:5] = 0.0
    better[0] = 1.0
    tau = findings.by_judge.tau.copy()
    tau[0] = 1.0
    tau[1:5] = 0.0
    reached = dataclasses.replace(
        findings, by_judge=findings.by_judge._replace(safest=better, tau=tau)
    )
    text = " ".join(answer(reached))
    assert "**reached**" in text
    assert "Why:" not in text


def test_h1_is_judged_whatever_comes_of_it(findings):
    for value, verdict in ((1.0, "better than"), (0.0, "worse than"), (None, "no certain")):
        scores = {}
        for metric in ("safest", "tau"):
            changed = getattr(findings.by_judge, metric).copy()
            changed[1:4] = 0.5
            changed[4] = 0.5 if value is None else value
            scores[metric] = changed
        found = dataclasses.replace(findings, by_judge=findings.by_judge._replace(**scores))
        line = next(p for p in answer(found) if p.startswith("The paper's H1"))
        assert line.count(verdict) == 2


def test_without_a_decided_test_set_nothing_is_claimed(tmp_path):
    rows = units(6, rule, rollouts=300, splits=("train",))
    never = units(3, lambda five, level: np.zeros(5), seed=1, splits=("test",))
    for row in never:
        row["unit"] += 100
    found = analyse(read(write(tmp_path / "t.parquet", rows + never)), FEW)
    text = page(found, tuple(sheets(found)), {})
    assert "No test set is decided" in text
    assert "reached" not in "".join(answer(found))
    assert "| none |" in text


def test_too_few_units_are_said_to_be_too_few(few, tmp_path):
    console = Console(file=io.StringIO(), width=200)
    never = write(tmp_path / "t.parquet", units(2, lambda five, level: np.zeros(5)))
    report(never, tmp_path / "out", console)
    assert "no training set" in console.file.getvalue()
    report(write(never, units(6, rule, splits=("train",))), tmp_path / "out", console)
    assert "no complete test unit" in console.file.getvalue()
    assert not (tmp_path / "out").exists()


def test_the_command_reports_or_says_what_is_wrong(
    few, parquet, findings, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(reporting, "_draw", lambda findings, page: {"Scores": "drawn.png"})
    assert main([str(parquet), "--output", str(tmp_path)]) == 0
    text = page(findings, tuple(sheets(findings)), {"Scores": "drawn.png"})
    assert (tmp_path / "evidence.md").read_text(encoding="utf-8") == text
    assert main([str(parquet), "--output", str(tmp_path), "--page", str(tmp_path / "p.md")]) == 0
    assert (tmp_path / "p.md").read_text(encoding="utf-8") == text
    assert not capsys.readouterr().err
    assert main([str(tmp_path / "none.parquet"), "--output", str(tmp_path)]) == 2
    assert "none.parquet: cannot be read" in words(capsys.readouterr().err)


def test_strata_share_out_the_decided_test_sets(findings):
    decided = int(findings.judge.decided.sum())
    groups = {}
    for stratum in strata(findings):
        groups.setdefault(stratum.group, []).append(stratum)
        scores = findings.by_judge.tau[2][stratum.counted]
        assert stratum.scores["tau"][2].mean == pytest.approx(scores.mean())
    assert set(groups) == {"narrow passes", "long exposure", "fast approach", "ground", "level"}
    for parts in groups.values():
        assert sum(int(part.counted.sum()) for part in parts) == decided


def test_curves_are_the_best_over_the_other_parameter():
    grid, objective = FEW[1], np.array([0.1, 0.4, 0.3, 0.2])
    assert curve(grid, objective, length) == [(5.0, 0.4), (8.0, 0.3)]
    assert curve(grid, objective, exponent) == [(1.0, 0.3), (3.0, 0.4)]
    assert curve(FEW[2], np.array([0.5]), exponent) == []
    assert curve(FEW[2], np.array([0.5]), length) == [(8.0, 0.5)]


def test_figures_show_each_setting_once_and_each_family(findings):
    settings = [findings.rows[k].setting for k in distinct(findings)]
    assert len(set(settings)) == len(settings) == len({row.setting for row in findings.rows})
    labels = [text.get_text() for text in fit_curves(findings.fit).legends[0].get_texts()]
    assert labels == ["near", "tail"]


def test_how_numbers_are_written():
    interval = Interval(0.123, 0.01, 0.2)
    assert share(interval) == "12 % [1, 20]"
    assert number(interval) == "0.12 [0.01, 0.20]"
    assert difference("safest", Interval(-0.05, -0.1, 0.0)) == "-5.0 points [-10.0, +0.0]"
    assert difference("tau", interval) == "+0.123 [+0.010, +0.200]"
    nothing = Interval(np.nan, np.nan, np.nan)
    assert {share(nothing), number(nothing), difference("tau", nothing)} == {"none"}


def test_code_of_a_setting_is_how_it_is_used():
    simple = NormOf(Lp(3), OfDistance(GaussianTail(8.0)))
    assert code(simple) == (
        "rank(trajectories, clearance, GaussianTail(sigma=8.0, d0=32.0), norms=(Lp(p=3.0),))"
    )
    other = Product(simple, NormOf(Lp(1), CorrectedTail(8.0, 4.0)), 0.5)
    assert code(other) == repr(other)
