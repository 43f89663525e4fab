"""What is asked of the paper's scenario: claims, shares, pairs, and the report's numbers."""

import math
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.image import imread
from rich.console import Console
from scenario_work import LABELS, NAMES, judged
from scipy import stats

from benchmarks.scenario import procedure, report
from benchmarks.scenario.findings import CLAIMS, Share, claims, claims_with_ties, hits
from benchmarks.scenario.fingerprint import CONSTANTS, differences, fingerprint
from ompl_risk.errors import ArgumentError

ALL = {"L1": "ABCDE", "L2": "ABCDE", "L∞": "ABCDE", "H1": "ABCDE"}
PAPER = {"L1": "BACDE", "L2": "CABDE", "L∞": "DBCAE", "H1": "ACBDE"}
"""Orders of f as the paper found them: all end with E, only H1 begins with A."""


@pytest.mark.parametrize(
    ("orders", "pc_orders", "agree", "riskiest", "safest"),
    [
        (PAPER, ALL, True, True, True),
        (ALL, ALL, True, True, False),  # H1 finds it, and so do the others
        (PAPER | {"H1": "BACDE"}, ALL, True, True, False),  # nobody finds it
        (PAPER | {"L1": "ABCDE"}, ALL, True, True, False),  # one more finds it
        (PAPER | {"H1": "CABDE", "L2": "ABCDE"}, ALL, True, True, False),  # another finds it
        (PAPER | {"L∞": "DBCEA"}, ALL, True, False, True),
        (PAPER | {"H1": "ABCED"}, ALL, True, False, True),
        (PAPER, ALL | {"L∞": "ABDCE"}, False, True, True),
        # the L2 norm says which is which where they differ
        (PAPER, ALL | {"L2": "BACDE"}, False, True, False),
        (PAPER, ALL | {"L2": "ABCED"}, False, False, True),
        (PAPER, dict.fromkeys(ALL, "EDCBA"), True, False, False),
    ],
)
def test_claims(orders, pc_orders, agree, riskiest, safest):
    expected = (agree, riskiest, safest, agree and riskiest and safest)
    assert tuple(claims(orders, pc_orders).values()) == expected
    listed = [{label: list(order) for label, order in each.items()} for each in (orders, pc_orders)]
    assert tuple(claims(*listed).values()) == expected
    assert list(claims(orders, pc_orders)) == list(CLAIMS)


distinct = st.lists(st.integers(0, 99), min_size=5, max_size=5, unique=True)
tables = st.fixed_dictionaries(dict.fromkeys(LABELS, distinct))
tied = st.fixed_dictionaries(
    {label: st.lists(st.integers(0, 2), min_size=5, max_size=5) for label in LABELS}
)


@given(tables, tables)
def test_without_ties_they_change_nothing(norms, pc_norms):
    record = judged(0, norms, pc_norms)
    assert claims_with_ties(record) == record["claims"]


@given(tied, tied, st.randoms(use_true_random=False))
@settings(max_examples=50)
def test_ties_go_either_way(norms, pc_norms, random):
    """Whatever breaks them, what then holds of agreement or the riskiest also holds with ties."""
    record = judged(0, norms, pc_norms)
    truth = record["pc orders"]["L2"]
    broken = [
        {
            label: sorted(NAMES, key=lambda n, v=values: (v[NAMES.index(n)], random.random()))
            for label, values in table.items()
        }
        for table in (norms, pc_norms)
    ]
    found = claims(broken[0], broken[1] | {"L2": truth})
    held = claims_with_ties(record)
    for name in ("pc norms agree", "all find riskiest"):
        assert held[name] or not found[name]
    if held["only H1 finds safest"]:
        assert broken[0]["H1"][0] == truth[0] or norms["H1"].count(min(norms["H1"])) > 1
        assert all(broken[0][label][0] != truth[0] for label in ("L1", "L2", "L∞"))


def like(values):
    """The same norms of A to E for every label."""
    return {label: list(values) for label in LABELS}


def test_ties_at_the_ends():
    riskiest_is_d = [1, 2, 3, 5, 4]
    # D and E are tied by L-infinity of f, and the order puts E, which is longer, last
    record = judged(0, like(riskiest_is_d) | {"L∞": [1, 2, 3, 5, 5]}, like(riskiest_is_d))
    assert record["orders"]["L∞"][-1] == "E"
    assert not record["claims"]["all find riskiest"]
    assert claims_with_ties(record)["all find riskiest"]
    # the same by L-infinity of P_c
    record = judged(0, like(riskiest_is_d), like(riskiest_is_d) | {"L∞": [1, 2, 3, 5, 5]})
    assert not record["claims"]["pc norms agree"]
    assert claims_with_ties(record)["pc norms agree"]
    # B is the safest; L1 ties it with A, which is shorter, so L1 finds it too
    only_h1 = like([0, 1, 2, 3, 4]) | {"H1": [1, 0, 2, 3, 4], "L1": [0, 0, 2, 3, 4]}
    record = judged(0, only_h1, like([1, 0, 2, 3, 4]))
    assert record["claims"]["only H1 finds safest"]
    assert not claims_with_ties(record)["only H1 finds safest"]


@pytest.mark.parametrize("n", [1, 8, 197])
def test_the_interval_of_none_and_of_all(n):
    edge = 0.025 ** (1.0 / n)
    none, every = Share.of([False] * n), Share.of([True] * n)
    assert (none.count, none.total, none.low) == (0, n, 0.0)
    assert none.high == pytest.approx(1.0 - edge, rel=1e-9)
    assert (every.count, every.total, every.high) == (n, n, 1.0)
    assert every.low == pytest.approx(edge, rel=1e-9)


@given(st.integers(1, 40).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_the_interval_leaves_out_an_eightieth_on_each_side(case):
    """At its ends what was found, or anything more extreme, has a probability of 2.5 %."""
    count, total = case
    share = Share.of([True] * count + [False] * (total - count))
    assert share.low <= count / total <= share.high
    if count > 0:
        assert stats.binom.sf(count - 1, total, share.low) == pytest.approx(0.025, abs=1e-9)
    if count < total:
        assert stats.binom.cdf(count, total, share.high) == pytest.approx(0.025, abs=1e-9)


def test_shares_in_words():
    assert str(Share.of([])) == "none"
    assert Share.of([]) == Share(0, 0, 0.0, 1.0)
    assert str(Share.of([True] * 2 + [False] * 6)) == "25 % [3, 65]"


def test_hits_by_hand():
    records = [
        {"orders": {"L1": "AB", "H1": "AB"}, "pc orders": {"L1": "AB", "H1": "BA"}},
        {"orders": {"L1": "AB", "H1": "BA"}, "pc orders": {"L1": "AB", "H1": "BA"}},
    ]
    counts = {f: {pc: s.count for pc, s in row.items()} for f, row in hits(records, 0).items()}
    assert counts == {"L1": {"L1": 2, "H1": 0}, "H1": {"L1": 1, "H1": 1}}
    three = [{"orders": {"L1": "ABC"}, "pc orders": {"L1": "ACB"}}]
    assert hits(three, 0)["L1"]["L1"] == Share.of([True])
    assert hits(three, -1)["L1"]["L1"] == Share.of([False])
    assert hits([], 0) == {}


def test_pairs_are_as_the_procedure_says():
    xmin, xmax, ymin, ymax = procedure.scene().terrain.extent
    pairs = [procedure.pair(0, k) for k in range(25)]
    assert pairs == [procedure.pair(0, k) for k in range(25)]
    assert len({*pairs, *(procedure.pair(1, k) for k in range(25))}) == 50
    for ends in pairs:
        assert 8000.0 <= math.dist(*ends) <= 15000.0
        for x, y in ends:
            assert xmin + 2000.0 <= x <= xmax - 2000.0
            assert ymin + 2000.0 <= y <= ymax - 2000.0
        task = procedure.problem(ends)
        assert procedure.scene().clearance([task.start, task.goal]).min() >= 20.0
        heights = procedure.scene().terrain.height(*np.array(ends).T)
        assert [task.start[2], task.goal[2]] == pytest.approx(heights + 60.0)
        assert task.high[2] == math.ceil(max(heights) + 60.0 + 320.0)


def test_pairs_on_slopes_are_drawn_again(monkeypatch):
    """The next draw of the same generator is taken; so a pair depends on nothing but its number."""
    original, refused = procedure.problem, []

    def steep(ends):
        if not refused:
            refused.append(ends)
            raise ArgumentError("start", 1.0, "clear")
        return original(ends)

    before = procedure.pair(0, 3)
    monkeypatch.setattr(procedure, "problem", steep)
    assert procedure.pair(0, 3) != before
    assert refused == [before]


def test_the_fingerprint_depends_on_every_constant(monkeypatch):
    record = {"seed": 0, "procedure": fingerprint(procedure.PLACES)}
    assert not list(differences(record, 0, procedure.PLACES))
    for name in CONSTANTS:
        with monkeypatch.context() as patch:
            patch.setattr(procedure, name, 7.25)
            (what,) = differences(record, 0, procedure.PLACES)
            assert what.startswith(f"{name.lower()}: ")
            assert what.endswith("there, 7.25 here")
    for name in ("NORMS", "BLIND", "__doc__"):
        with monkeypatch.context() as patch:
            new = {"NORMS": procedure.NORMS[:2], "BLIND": procedure.scene().avoidance}
            patch.setattr(procedure, name, new.get(name, "1. The five are picked by hand."))
            assert len(list(differences(record, 0, procedure.PLACES))) == 1
    assert list(differences(record, 3, 200)) == [
        "seed: 0 there, 3 here", "places: 3000 there, 200 here",
    ]  # fmt: skip


def test_every_number_of_the_procedure_is_in_the_fingerprint():
    numbers = {
        name
        for name, value in vars(procedure).items()
        if name.isupper() and isinstance(value, int | float)
    }
    assert numbers == {*CONSTANTS, "PLACES"}


def test_records_without_a_fingerprint_are_of_the_default_procedure():
    assert not list(differences({"seed": 0}, 0, procedure.PLACES))
    assert list(differences({"seed": 0}, 0, 200)) == ["places: 3000 there, 200 here"]


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
