"""The scenario's report: its numbers are those of the records."""

from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from rich.console import Console
from scenario_work import LABELS, NAMES, judged
from scipy import stats

from benchmarks.scenario import procedure, report
from benchmarks.scenario.findings import CLAIMS, Share, claims, claims_with_ties
from benchmarks.scenario.fingerprint import fingerprint


@pytest.fixture(scope="module")
def records():
    """Random sets, whose L-infinity norms are tied now and then, and two pairs without."""
    random = np.random.default_rng(5)

    def table():
        base = random.random(5)
        found = {label: (base + 0.3 * random.random(5)).tolist() for label in LABELS}
        return found | {"L∞": random.integers(0, 6, 5).astype(float).tolist()}

    sets = [judged(k, table(), table()) for k in range(30)]
    for record in sets[::2]:  # else nothing ever agrees
        for what in ("norms", "orders"):
            record[what] = record[f"pc {what}"]
        record["claims"] = claims(record["orders"], record["pc orders"])
    fewer = {"seed": 0, "pair": 30, "status": "fewer", "flights": 4}
    return [*sets, fewer, {"seed": 0, "pair": 31, "status": "failed", "reason": "XError: no | no"}]


def recounted(records, label, pc, extreme):
    """How often a norm's extreme flight is that of another, from the norms: ties to the shorter."""

    def extreme_of(table, label):
        key = [(table[n][label], record["durations"][n]) for n in NAMES]
        return extreme(range(5), key=key.__getitem__)

    count = 0
    for record in (r for r in records if r["status"] == "judged"):
        count += extreme_of(record["norms"], label) == extreme_of(record["pc norms"], pc)
    return count


def test_the_tables_agree_with_the_records(records):
    found = {title: (header, lines) for title, header, lines in report.tables(records)}
    assert len(found) == 4
    for extreme, word in ((min, "safest"), (max, "riskiest")):
        header, lines = found[f"How often a norm finds the {word} flight"]
        assert header == ["norm of f", *(f"{word} by {label} of P_c" for label in LABELS)]
        for label, *cells in lines:
            for pc, cell in zip(LABELS, cells, strict=True):
                count = recounted(records, label, pc, extreme)
                assert cell.split(" %")[0] == f"{100 * count / 30:.0f}"
    _, lines = found["What the paper found"]
    sets = records[:30]
    agree = sum(len({tuple(o) for o in r["pc orders"].values()}) == 1 for r in sets)
    riskiest = sum(
        {order[-1] for order in r["orders"].values()} == {r["pc orders"]["L2"][-1]} for r in sets
    )
    assert lines[0][1:3] == [
        f"{agree} of 30",
        str(Share.of([True] * agree + [False] * (30 - agree))),
    ]
    assert lines[1][1] == f"{riskiest} of 30"
    assert 0 < riskiest < 30
    for line, name in zip(lines, CLAIMS, strict=True):
        assert line[0] == CLAIMS[name]
        assert line[3] == str(Share.of([claims_with_ties(r)[name] for r in sets]))
    _, lines = found["Agreement of the orders: Kendall's tau [95 % interval of the mean]"]
    for label, cell in lines:
        tau = [record["tau"][label] for record in sets]
        half = 1.96 * stats.sem(tau)
        low, high = np.mean(tau) - half, np.mean(tau) + half
        assert cell == f"{np.mean(tau):.2f} [{low:.2f}, {high:.2f}]"


def test_what_became_of_the_pairs_is_told(records):
    first, spread, *rest = report.notes(records)
    assert first == "32 pairs: 30 judged, 1 with fewer than five flights, 1 failed"
    assert spread == "durations of the five differ by 1.3 % in the median, 1.3 % at most"
    ties = sum(len({r["pc norms"][n]["L∞"] for n in NAMES}) < 5 for r in records[:30])
    assert 0 < ties < 30
    told = f"L∞ of P_c ties flights in {ties} of 30 sets; orders put the shorter first"
    assert told in rest
    assert not [note for note in rest if note.startswith(("L1", "L2", "H1"))]
    assert rest[-1] == "pair 31: XError: no | no"
    other = [record | {"procedure": fingerprint(200)} for record in records]
    assert "roadmaps of 200 places, where the procedure has 3000" in report.notes(other)


def text(records):
    stream = StringIO()
    console = Console(width=200, file=stream)
    for table in report.terminal_tables(records):
        console.print(table)
    return stream.getvalue()


def written(records, folder: Path):
    report.draw_hits(records, folder / "hits.png")
    picture = imread(folder / "hits.png")
    assert picture.shape[:2] == (630, 1350)
    assert picture[..., :3].std() > 0.01
    return report.markdown(records)


def test_the_report_is_written(records, tmp_path):
    document = written(records, tmp_path)
    assert document.startswith("# Five flights of equal time, many times\n\n- 32 pairs: ")
    assert (procedure.__doc__ or "?").strip() in document
    printed = text(records)
    for title, _, lines in report.tables(records):
        assert f"\n## {title}\n" in document
        for line in lines:
            assert f"\n| {' | '.join(line)} |\n" in document
            assert all(cell in printed for cell in line)


def test_a_report_of_one_pair(records, tmp_path):
    document = written(records[:1], tmp_path)
    assert f"| L1 | {records[0]['tau']['L1']:.2f} |\n" in document
    assert "nan" not in document


@pytest.mark.parametrize("start", [30, 32])
def test_a_report_without_a_judged_pair(records, tmp_path, start):
    document = written(records[start:], tmp_path)
    assert f"- {32 - start} pairs: 0 judged, " in document
    assert [line for line in document.splitlines() if line.startswith("## ")] == ["## Procedure"]
    assert text(records[start:]) == ""


def test_intervals_of_tau_stay_within_its_range(records):
    sets = [record | {"tau": dict.fromkeys(LABELS, value)} for record, value in
            zip(records[:3], (1.0, 1.0, 0.8), strict=True)]  # fmt: skip
    *_, (_, _, lines) = report.tables(sets)
    assert lines[0] == ["L1", "0.93 [0.80, 1.00]"]
