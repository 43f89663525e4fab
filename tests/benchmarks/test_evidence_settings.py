"""The campaign's table as arrays, and what settings make of it, against the library one by one."""

import json
import math

import numpy as np
import pyarrow.parquet as pq
import pytest
from evidence_tables import Flight, incomplete, no_difference, units, write
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.evidence.analysis.families import families
from benchmarks.evidence.analysis.profiles import Profiles
from benchmarks.evidence.analysis.settings import (
    FASTEST,
    PAPER,
    CorrectedCap,
    CorrectedTail,
    ExpectedCollisions,
    NormOf,
    OfDistance,
    OutcrossingOf,
    Product,
    evaluated,
)
from benchmarks.evidence.analysis.strata import measures
from benchmarks.evidence.analysis.table import LEVELS, read
from ompl_risk import InverseDistance, Lp, Sobolev
from ompl_risk.avoidance import FlatCap, GaussianTail
from ompl_risk.avoidance.corrections import corrected_cap, corrected_tail
from ompl_risk.errors import FileError
from ompl_risk.probability.crossings import CrossingRate
from ompl_risk.probability.outcrossing import Outcrossing

NORMS = (
    Lp(1), Lp(1.5), Lp(2), Lp(8), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=0.1),
    Sobolev(1, time_scale=20.0),
)  # fmt: skip


@pytest.fixture(scope="module")
def rows():
    return units(3, no_difference, rollouts=100)


@pytest.fixture(scope="module")
def table(rows, tmp_path_factory):
    return read(write(tmp_path_factory.mktemp("evidence") / "table.parquet", rows))


def test_outcrossing_of_all_flights_is_that_of_each(table):
    model = Outcrossing(8.0, 6.0, correlation_time=5.0)
    profiles = table.profiles
    found = OutcrossingOf(model)(profiles)
    for k in range(0, len(profiles), 4):
        flight = profiles.flight(k)
        one = model.probability(flight["t"], flight["d"], flight["up"])
        assert found[k] == pytest.approx(one, rel=1e-9, abs=1e-15)


def profiles_of(*flights):
    """Flights given as (t, d) end to end."""
    starts = np.cumsum([0, *(len(t) for t, _ in flights)])
    t, d = (np.concatenate(columns) for columns in zip(*flights, strict=True))
    return Profiles(starts, t, d, np.ones_like(d), np.zeros_like(d), d, d)


@st.composite
def some_flights(draw):
    flights = []
    for _ in range(draw(st.integers(1, 4))):
        n = draw(st.integers(2, 12))
        steps = draw(st.lists(st.floats(0.1, 2.0), min_size=n - 1, max_size=n - 1))
        d = draw(st.lists(st.floats(1.0, 150.0), min_size=n, max_size=n))
        flights.append((np.cumsum([0.0, *steps]), np.array(d)))
    return flights


@settings(max_examples=60, deadline=None)
@given(
    some_flights(), st.sampled_from(NORMS), st.sampled_from([InverseDistance(60.0), FlatCap(30.0)])
)
def test_a_norm_of_all_flights_at_once_is_the_norm_of_each(flights, norm, avoidance):
    found = NormOf(norm, OfDistance(avoidance))(profiles_of(*flights))
    alone = [norm(t, avoidance(d)) for t, d in flights]
    np.testing.assert_allclose(found, alone, rtol=1e-9, atol=0.0)


def test_flights_that_are_never_near_have_norm_zero():
    far = (np.arange(4.0), np.full(4, 500.0))
    near = (np.arange(3.0), np.full(3, 10.0))
    for norm in NORMS:
        found = NormOf(norm, OfDistance(InverseDistance(100.0)))(profiles_of(far, near, far))
        assert found[0] == found[2] == 0.0
        assert found[1] > 0.0


def test_corrected_integrands_and_rates_are_those_of_the_library(table):
    each = [table.profiles.flight(k) for k in range(len(table.profiles))]
    cap, tail = CorrectedCap(40.0), CorrectedTail(8.0, 4.0)
    rate = CrossingRate(9.0, correlation_time=3.0)
    expected = {
        NormOf(Lp(3), cap): [
            Lp(3)(f["t"], corrected_cap(f["d"], f["up"], f["curvature"], r=40.0)) for f in each
        ],
        NormOf(Lp(1), tail): [
            Lp(1)(
                f["t"], corrected_tail(f["d"], f["up"], f["curvature"], vertical=8.0, isotropic=4.0)
            )
            for f in each
        ],
        ExpectedCollisions(rate): [rate.expected_collisions(f["t"], f["d"]) for f in each],
        FASTEST: [f["t"][-1] for f in each],
    }
    for setting, values in expected.items():
        np.testing.assert_allclose(
            setting(table.profiles), values, rtol=1e-9, err_msg=setting.label
        )


def test_evaluated_is_each_setting_on_its_own_unit_by_unit(table):
    tail = NormOf(Lp(2), OfDistance(GaussianTail(12.0)))
    chosen = [*PAPER, tail, Product(PAPER[0], tail, 0.25), FASTEST, PAPER[1]]
    found = evaluated(chosen, table.profiles)
    assert found.shape == (len(chosen), 6, 5)
    for values, setting in zip(found, chosen, strict=True):
        np.testing.assert_array_equal(values.ravel(), setting(table.profiles))
    np.testing.assert_allclose(found[5], found[0] ** 0.75 * found[4] ** 0.25)


def test_the_papers_four_are_its_norms_of_its_integrand():
    assert [s.norm for s in PAPER] == [Lp(1), Lp(2), Lp(math.inf), Sobolev(1)]
    assert {s.integrand.avoidance for s in PAPER} == {InverseDistance(100.0)}


def test_no_two_settings_of_a_family_share_a_name():
    for family in families():
        labels = [setting.label for setting in family.settings]
        assert len(set(labels)) == len(labels) > 0
    assert {f.name: f.simple for f in families()}["expected collisions, σ and τ tuned"] is False


def test_what_was_written_is_read(rows, table):
    assert table.units.tolist() == list(range(6))
    assert table.split.tolist() == ["train"] * 3 + ["test"] * 3
    assert table.facts == {"procedure": {"seed": 7, "versions": {"numpy": "2"}}}
    for k, row in enumerate(rows):
        flight = table.profiles.flight(k)
        np.testing.assert_array_equal(flight["d"], np.float32(row["d"]))
        np.testing.assert_allclose(np.diff(flight["t"])[:-1], row["step"])
        assert flight["t"][-1] == row["duration"]
        unit, number = divmod(k, 5)
        hits = [table.hits[level, unit, number] for level in range(3)]
        assert hits == [row[f"{level}_hits"] for level in LEVELS]
    assert (table.rollouts == 100).all()


def test_patterns_count_which_flights_collide_together(rows, table):
    for level, name in enumerate(LEVELS):
        bits = np.array(
            [np.unpackbits(np.frombuffer(r[f"{name}_bits"], np.uint8), count=100) for r in rows[:5]]
        )
        both = int((bits[1] & bits[3]).sum())
        codes = np.arange(32)
        counted = table.patterns[level, 0][(codes & 0b01010) == 0b01010].sum()
        assert counted == both


def test_rows_may_come_in_any_order(rows, table, tmp_path):
    order = np.random.default_rng(3).permutation(len(rows))
    other = read(write(tmp_path / "t.parquet", [rows[k] for k in order]))
    np.testing.assert_array_equal(other.profiles.d, table.profiles.d)
    np.testing.assert_array_equal(other.patterns, table.patterns)


def test_parts_are_their_units(rows, table, tmp_path):
    part = table.part("test")
    alone = read(write(tmp_path / "t.parquet", rows[15:]))
    np.testing.assert_array_equal(part.profiles.d, alone.profiles.d)
    np.testing.assert_array_equal(part.profiles.clock, alone.profiles.clock)
    np.testing.assert_array_equal(part.patterns, alone.patterns)
    assert part.places.tolist() == alone.places.tolist()


def test_units_that_came_to_nothing_are_counted(rows, tmp_path):
    more = [incomplete(100), incomplete(101), incomplete(102, "train", "few", "3 flights")]
    found = read(write(tmp_path / "t.parquet", rows + more))
    assert len(found) == 6
    assert found.outcomes == {
        ("train", "complete"): 3, ("test", "complete"): 3, ("test", "failed"): 2,
        ("train", "few"): 1,
    }  # fmt: skip
    assert found.reasons == {"RuntimeError: no way": 2, "3 flights": 1}


def changed(rows, **values):
    return [{**rows[0], **values}, *rows[1:]]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda rows: rows[1:], "another number of rows for unit 0"),
        (lambda rows: [*rows, rows[0]], "another number of rows for unit 0"),
        (lambda rows: changed(rows, flight=3), "not 0 to 4"),
        (lambda rows: changed(rows, split="validation"), "validation"),
        (lambda rows: changed(rows, status="done"), "done"),
        (lambda rows: changed(rows, calm_hits=101), "calm bits that are not its hits"),
        (lambda rows: changed(rows, severe_rollouts=99), "other numbers of severe bits"),
        (lambda rows: changed(rows, calm_bits=b""), "other numbers of calm bits"),
        (lambda rows: changed(rows, d=np.zeros_like(rows[0]["d"])), "d <= 0"),
        (lambda rows: changed(rows, up=np.full_like(rows[0]["d"], np.nan)), "up is not finite"),
        (lambda rows: changed(rows, speed=rows[0]["speed"][1:]), "speed is not finite"),
        (lambda rows: changed(rows, duration=rows[0]["duration"] + 1.0), "do not fit"),
        (lambda rows: changed(rows, duration=rows[0]["duration"] - 1.0), "do not fit"),
        (lambda rows: [incomplete(0)], "no complete unit"),
    ],
)  # fmt: skip
def test_a_table_that_is_no_campaigns_is_refused(rows, tmp_path, spoil, words):
    with pytest.raises(FileError, match=words):
        read(write(tmp_path / "t.parquet", spoil(rows)))


def test_a_file_without_a_column_or_that_is_no_parquet_is_refused(rows, tmp_path):
    path = write(tmp_path / "t.parquet", rows)
    pq.write_table(pq.read_table(path).drop_columns(["curvature", "calm_bits"]), path)
    with pytest.raises(FileError, match="no column curvature, calm_bits"):
        read(path)
    path.write_text(json.dumps({}))
    with pytest.raises(FileError, match="cannot be read"):
        read(path)
    with pytest.raises(FileError, match="cannot be read"):
        read(tmp_path / "none.parquet")


def test_measures_of_danger_by_hand():
    """Ten seconds at 20 m over level ground, then a climb and a dive beside a wall."""
    t = np.arange(21.0)
    d = np.concatenate([np.full(11, 20.0), [40, 60, 80, 60, 44, 30, 40, 60, 80, 45]])
    up = np.where(t > 10, 0.5, 1.0)
    flight = Flight(20.0, 1.0, d, up, np.zeros(21), np.ones(21))
    five = profiles_of(*[(flight.t, flight.d)] * 5)
    five = Profiles(
        five.starts, five.t, five.d, np.tile(up, 5), five.curvature, five.speed, five.pc
    )
    found = measures(five)
    assert found["long exposure"] == pytest.approx([10.5])  # to half-way to 40 m; 30 is not below
    assert found["narrow passes"] == pytest.approx([100.0 * 4.5 / 20.0])  # 11, 15 to 17, 20
    assert found["fast approach"] == pytest.approx(
        [14.0]
    )  # 44 to 30 m; the next begins lower still
