"""Files of pieces of work: whole or not there, each under its own name, of one procedure."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.evidence.store import UNITS
from benchmarks.pieces import Pieces
from benchmarks.scenario.records import PAIRS
from ompl_risk.errors import ArgumentError

LOAVES = Pieces("loaf", "bread", digits=3, suffix=".txt")


def text(folder, number):
    """A loaf that is not burnt."""
    found = LOAVES.path(folder, number).read_text()
    if found == "burnt":
        raise ValueError("too dark")
    return found


def same(_text):
    return ()


def bake(folder, *numbers):
    for number in numbers:
        LOAVES.keep(folder, number, f"loaf {number}".encode())


@pytest.mark.parametrize(
    ("pieces", "name"), [(UNITS, "units/00007.parquet"), (PAIRS, "pairs/0007.json")]
)
def test_names_of_files_stay_as_they_are(pieces, name):
    """Folders of older results have them."""
    assert pieces.path(Path("a"), 7) == Path("a") / name


@given(st.sets(st.integers(0, 20_000), max_size=12), st.integers(0, 20_000) | st.none())
def test_what_is_kept_comes_back_in_order(tmp_path_factory, numbers, count):
    folder = tmp_path_factory.mktemp("loaves")
    bake(folder, *sorted(numbers, reverse=True))
    found = list(LOAVES.kept(folder, text, same, count=count, say=pytest.fail))
    ours = sorted(number for number in numbers if count is None or number < count)
    assert found == [(number, f"loaf {number}") for number in ours]


@pytest.mark.parametrize("pieces", [UNITS, PAIRS], ids=["units", "pairs"])
def test_a_file_is_there_whole_or_not_at_all(tmp_path, monkeypatch, pieces):
    pieces.keep(tmp_path, 0, b"old and whole")
    opened = Path.open

    class Torn:
        def __init__(self, file):
            self.file = file

        def __enter__(self):
            return self

        def __exit__(self, *_):
            self.file.close()

        def write(self, content):
            self.file.write(content[:3])
            raise KeyboardInterrupt

    monkeypatch.setattr(Path, "open", lambda path, *a, **k: Torn(opened(path, *a, **k)))
    for number in (0, 1):
        with pytest.raises(KeyboardInterrupt):
            pieces.keep(tmp_path, number, b"new and torn")
    monkeypatch.undo()

    def read(folder, number):
        return pieces.path(folder, number).read_bytes()

    assert dict(pieces.kept(tmp_path, read, same, say=pytest.fail)) == {0: b"old and whole"}
    pieces.keep(tmp_path, 1, b"new")  # over what is left of the torn one
    assert list(pieces.kept(tmp_path, read, same)) == [(0, b"old and whole"), (1, b"new")]
    assert [path.stem for path in tmp_path.glob("*/*.part")] == [pieces.path(tmp_path, 0).stem]


def test_what_is_not_what_it_should_be_is_told_and_left_out(tmp_path):
    bake(tmp_path, 0, 1, 2)
    path = LOAVES.path(tmp_path, 1)
    path.write_text("burnt")
    LOAVES.path(tmp_path, 2).unlink()
    LOAVES.path(tmp_path, 2).mkdir()
    said = []
    assert list(LOAVES.kept(tmp_path, text, same, say=said.append)) == [(0, "loaf 0")]
    assert said[0] == f"{path} is no bread of loaf 1 (too dark): the loaf counts as not done"
    assert "is no bread of loaf 2 ([Errno" in said[1]


@pytest.mark.parametrize("name", ["7.txt", "0007.txt", "seven.txt", "007.part", "007.txt.bak"])
def test_files_of_other_names_are_nobodys(tmp_path, name):
    bake(tmp_path, 3)
    (tmp_path / "loafs" / name).write_text("burnt")
    assert list(LOAVES.kept(tmp_path, text, same, say=pytest.fail)) == [(3, "loaf 3")]


@pytest.mark.parametrize("backwards", [False, True])
def test_another_name_of_the_same_number_hides_no_piece(tmp_path, monkeypatch, backwards):
    bake(tmp_path, 3)
    (tmp_path / "loafs" / "3.txt").write_text("burnt")
    listed = Path.glob  # in any order

    def glob(path, pattern):
        return iter(sorted(listed(path, pattern), reverse=backwards))

    monkeypatch.setattr(Path, "glob", glob)
    assert list(LOAVES.kept(tmp_path, text, same, say=pytest.fail)) == [(3, "loaf 3")]


@pytest.mark.parametrize(
    ("count", "told"), [(1, "a"), (3, "a and b and c"), (5, "a and b and c and 2 more")]
)
def test_pieces_of_another_procedure_are_refused(tmp_path, count, told):
    bake(tmp_path, 4, 6)
    coming = LOAVES.kept(tmp_path, text, lambda found: "abcde"[:count] if "6" in found else ())
    assert next(coming) == (4, "loaf 4")
    with pytest.raises(ArgumentError) as refusal:
        next(coming)
    allowed = "another folder, as this one holds loafs of another seed or procedure"
    assert str(refusal.value) == f"output = '{tmp_path}': must be {allowed} (006.txt: {told})"
