"""Units are kept whatever happens, and what is no result of theirs is noticed."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from evidence_work import done
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.evidence import procedure, schema, store
from benchmarks.evidence.settings import Settings, flat
from benchmarks.evidence.store import NAME, UNITS, Kept, compact, keep, kept, read
from benchmarks.evidence.unit import failed
from ompl_risk.errors import ArgumentError, FileError

SETTINGS = Settings(0, 16, 60)


def test_what_is_kept_comes_back(tmp_path):
    assert kept(tmp_path / "nothing", SETTINGS) == {}
    for unit in (2, 0, 1):
        keep(tmp_path, done(SETTINGS, unit))
    keep(tmp_path, failed(SETTINGS, 1, "no wind"))
    found = kept(tmp_path, SETTINGS, say=pytest.fail)
    assert list(found) == [0, 1, 2]
    assert found[0] == Kept("few", "3 flights", "c0de")
    assert (found[1].status, found[1].reason) == ("failed", "no wind")
    assert list(kept(tmp_path, SETTINGS, 2)) == [0, 1]
    assert sorted(path.name for path in (tmp_path / "units").iterdir()) == [
        "00000.parquet", "00001.parquet", "00002.parquet",
    ]  # fmt: skip


def test_units_come_in_the_order_of_their_numbers(tmp_path):
    numbers = [7, 100, 3, 12, 9, 0, 55, 31, 2, 20, 1, 99]
    for number in numbers:
        keep(tmp_path, done(SETTINGS, number))
    assert list(kept(tmp_path, SETTINGS)) == sorted(numbers)


def test_a_failed_unit_says_where_it_was_as_far_as_that_is_known():
    rows = schema.read(pa.BufferReader(failed(SETTINGS, 8, "no wind").content)).to_pylist()
    (row,) = rows
    assert (row["unit"], row["split"], row["terrain"]) == (8, "test", "canyon")
    assert (row["status"], row["reason"]) == ("failed", "no wind")
    assert (row["d"], row["calm_hits"], row["start"]) == (None, None, None)


def damaged(content, how):
    """The bytes of a unit's file, wrong in some way."""
    if how == "flipped":  # within the data: the footer is whole
        at = content.index(b"3 flights")
        return content[:at] + b"4" + content[at + 1 :]
    return {"empty": b"", "cut": content[:-1], "text": b"no parquet", "headless": content[4:]}[how]


def without(content, column):
    table = schema.read(pa.BufferReader(content))
    sink = pa.BufferOutputStream()
    pq.write_table(table.drop_columns([column]), sink)
    return sink.getvalue().to_pybytes()


@pytest.mark.parametrize("how", ["empty", "cut", "text", "headless", "flipped"])
def test_a_damaged_file_counts_as_not_done(tmp_path, how, monkeypatch):
    if how == "flipped":  # without compression, so that a letter can be found and changed
        monkeypatch.setattr(schema, "COMPRESSION", "none")
    for unit in range(3):
        keep(tmp_path, done(SETTINGS, unit))
    path = UNITS.path(tmp_path, 1)
    path.write_bytes(damaged(path.read_bytes(), how))
    said = []
    assert list(kept(tmp_path, SETTINGS, say=said.append)) == [0, 2]
    (message,) = said
    assert message.startswith(f"{path} is no result of unit 1 (")
    assert message.endswith("the unit counts as not done")
    keep(tmp_path, done(SETTINGS, 1))
    assert list(kept(tmp_path, SETTINGS, say=pytest.fail)) == [0, 1, 2]


@pytest.mark.parametrize("column", ["unit", "d", "severe_bits"])
def test_a_file_without_a_column_counts_as_not_done(tmp_path, column):
    keep(tmp_path, done(SETTINGS, 0))
    path = UNITS.path(tmp_path, 0)
    path.write_bytes(without(path.read_bytes(), column))
    said = []
    assert kept(tmp_path, SETTINGS, say=said.append) == {}
    assert f"no column {column} of" in said[0]


def test_a_unit_under_anothers_name_counts_as_not_done(tmp_path):
    keep(tmp_path, done(SETTINGS, 4))
    UNITS.path(tmp_path, 4).rename(UNITS.path(tmp_path, 5))
    said = []
    assert kept(tmp_path, SETTINGS, say=said.append) == {}
    assert "of unit 4" in said[0]


def test_a_parquet_of_something_else_counts_as_not_done(tmp_path):
    keep(tmp_path, done(SETTINGS, 0))
    table = schema.read(UNITS.path(tmp_path, 0)).replace_schema_metadata(None)
    pq.write_table(table, UNITS.path(tmp_path, 0))
    with pytest.raises(ValueError, match="without code, procedure, processor"):
        read(tmp_path, 0)


def test_units_of_another_seed_or_procedure_are_refused(tmp_path, monkeypatch):
    keep(tmp_path, done(SETTINGS, 0))
    before = UNITS.path(tmp_path, 0).read_bytes()
    for other, what in [
        (Settings(1, 16, 60), "seed: 0 there, 1 here"),
        (Settings(0, 17, 60), "rollouts: 16 there, 17 here"),
        (Settings(0, 16, 61), "places: 60 there, 61 here"),
    ]:
        with pytest.raises(ArgumentError, match=rf"another folder.*00000\.parquet: {what}\)"):
            kept(tmp_path, other)
        with pytest.raises(ArgumentError, match="another folder"):
            compact(tmp_path, other)
    monkeypatch.setattr(procedure, "EXCESS", 0.1)
    with pytest.raises(ArgumentError, match=r"excess: 0\.05 there, 0\.1 here\)"):
        kept(tmp_path, SETTINGS)
    assert UNITS.path(tmp_path, 0).read_bytes() == before


@pytest.mark.parametrize("name", ["LEAST", "FARTHEST", "STEP", "SEPARATION", "LEVELS", "__doc__"])
def test_the_fingerprint_changes_with_the_procedure(monkeypatch, name):
    before = SETTINGS.fingerprint
    value = getattr(procedure, name)
    monkeypatch.setattr(procedure, name, value[:2] if isinstance(value, str | tuple) else 2 * value)
    assert SETTINGS.fingerprint != before


def test_the_fingerprint_names_the_disturbances():
    found = SETTINGS.fingerprint
    assert found["calm terrain deviation"] < found["severe terrain deviation"]
    assert flat({"a": {"b": (1, 2), "c": {"d": None}}}) == {"a b": [1, 2], "a c d": None}


def flights(unit):
    """Rows of a complete unit with made-up numbers."""
    place = {"unit": unit, "split": "test", "terrain": "canyon", "terrain_seed": 1001}
    profile = np.linspace(1.0, 2.0, 7, dtype=np.float32)
    for flight in range(5):
        row = {**place, "status": "complete", "reason": "", "flight": flight, "d": profile + flight}
        yield row | {"calm_hits": 1, "calm_rollouts": 4, "calm_bits": bytes([1 << flight])}


def test_all_units_go_into_one_file(tmp_path):
    whole = done(SETTINGS, 3)
    facts = schema.facts_of(schema.read(pa.BufferReader(whole.content)).schema)
    content = schema.packed(schema.table(list(flights(3)), {**facts, "code": "new"}))
    for each in (done(SETTINGS, 11), store.Done(3, "complete", "", content), done(SETTINGS, 0)):
        keep(tmp_path, each)
    path = compact(tmp_path, SETTINGS)
    assert path == tmp_path / NAME
    assert not list(tmp_path.glob("*.part"))
    table = schema.read(path)
    assert table.column("unit").to_pylist() == [0, 3, 3, 3, 3, 3, 11]
    assert table.column("flight").to_pylist() == [None, 0, 1, 2, 3, 4, None]
    assert table.column("calm_bits").to_pylist()[1:6] == [bytes([1 << k]) for k in range(5)]
    for k in range(5):
        expected = np.linspace(1.0, 2.0, 7, dtype=np.float32) + np.float32(k)
        assert np.array_equal(table.column("d").to_pylist()[k + 1], expected)
    known = schema.facts_of(table.schema)
    assert known["procedure"] == SETTINGS.fingerprint
    assert known["code"] == {"c0de": 2, "new": 1}
    assert (known["units"], known["seconds"], known["seed"], known["rollouts"]) == (3, 4.5, 0, 16)
    assert list(known["levels"]) == ["calm", "moderate", "severe"]
    keep(tmp_path, done(SETTINGS, 1))
    assert schema.read(compact(tmp_path, SETTINGS)).num_rows == 8


def test_nothing_cannot_be_joined(tmp_path):
    with pytest.raises(FileError, match="holds no unit that is done"):
        compact(tmp_path, SETTINGS)


@given(st.lists(st.floats(width=32, allow_nan=False, allow_infinity=False), max_size=20))
def test_numbers_come_back_as_they_were_written(values):
    facts = {"a": [1, {"b": None}]}
    table = schema.table([{"unit": 1, "d": np.array(values, dtype=np.float32)}], facts)
    back = schema.read(pa.BufferReader(schema.packed(table)))
    assert back.column("d").to_pylist() == [values]
    assert schema.facts_of(back.schema) == facts
