"""Fingerprints of procedures and of the code that carries them out."""

from types import SimpleNamespace

import pytest

from benchmarks import blind_flights, procedures
from benchmarks.campaign import run
from benchmarks.evidence import settings


@pytest.fixture
def folder(tmp_path):
    """Three sources, one of them further down."""
    (tmp_path / "within").mkdir()
    for name in ("b.py", "a.py", "within/c.py"):
        (tmp_path / name).write_text(f"# {name}\n")
    return tmp_path


def fresh(*sources):
    procedures.code.cache_clear()
    return procedures.code(*sources)


def test_code_is_known_by_every_source(folder):
    before = fresh(folder)
    assert fresh(folder) == before
    assert len(before) == 12
    seen = {before, fresh(), fresh(folder / "a.py")}
    for path in sorted(folder.rglob("*.py")):
        text = path.read_text()
        path.write_text(text + "1\n")
        seen.add(fresh(folder))
        path.write_text(text)
    assert fresh(folder) == before
    (folder / "a.py").rename(folder / "a2.py")  # still the first
    seen.add(fresh(folder))
    assert len(seen) == 7


def test_what_is_no_source_does_not_count(folder):
    before = fresh(folder)
    (folder / "notes.txt").write_text("x")
    (folder / "within" / "c.pyc").write_text("x")
    assert fresh(folder) == before


def test_the_code_of_units_covers_the_search_for_flights(monkeypatch, folder):
    before = settings.code.__wrapped__()
    monkeypatch.setattr(blind_flights, "__file__", str(folder / "a.py"))
    assert settings.code.__wrapped__() != before
    assert run.code() != before


def test_words_do_not_depend_on_line_breaks():
    assert procedures.words("a b\n  c") == procedures.words("a\nb c") != procedures.words("a b")
    assert procedures.words(None) == procedures.words("")


def test_constants_are_named_in_lower_case():
    module = SimpleNamespace(EXCESS=0.05, STEP=0.2, other=1)
    assert procedures.constants(module, ("STEP", "EXCESS")) == {"step": 0.2, "excess": 0.05}


def test_differences_name_what_is_on_either_side():
    there, here = {"a": 1, "b": [2], "c": 3}, {"a": 1, "b": [4], "d": None, "e": 0}
    assert list(procedures.differences(there, here)) == [
        "b: [2] there, [4] here", "c: 3 there, None here", "e: None there, 0 here",
    ]  # fmt: skip
