"""Pairs are drawn as it is written down, and the fingerprint says by which procedure."""

import math

import numpy as np
import pytest

from benchmarks.scenario import procedure
from benchmarks.scenario.fingerprint import CONSTANTS, differences, fingerprint
from ompl_risk.errors import ArgumentError


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
