"""What the steering looks up: turn blocks, and libraries that lack something or are bent."""

import math

import numpy as np
import pytest
from connecting import connected, durations, random_vertices
from toy_primitives import ToyLibrary, bent, likely

from ompl_risk._kernels import connect_tables as columns
from ompl_risk._kernels import pieces as piece
from ompl_risk._kernels.connect import held_turn
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.tables import connect_tables, tracks, used

TOY = ToyLibrary(likely)
TABLES = connect_tables(TOY, longest_ratio=1e6)


@pytest.mark.parametrize("k", range(4))
def test_a_turn_is_held_until_the_heading_is_right(k):
    for block in TABLES.blocks[k]:
        least, rate, most = block[[columns.LEAST_TURN, columns.RATE, columns.MOST_HOLD]]
        assert held_turn(block, least) == 0.0
        assert held_turn(block, least - 1e-13 * np.sign(rate)) == 0.0  # rounding, no full circle
        for turn in np.linspace(-9.0, 9.0, 97).tolist():
            hold = held_turn(block, turn)
            around = (turn - least) * np.sign(rate) % (2.0 * math.pi)
            if around > most * abs(rate):
                assert hold == math.inf
            else:
                assert hold == pytest.approx(around / abs(rate), abs=1e-9)
        assert (most == math.inf) == (block[columns.MOST_TAN] == math.inf)


def test_what_a_library_lacks_is_not_flown():
    library = ToyLibrary(likely)
    lacking = [
        pair
        for pair in library._found
        if any(turn > 0.0 for _, _, turn in pair) or any(climb > 2.0 for _, climb, _ in pair)
    ]
    for pair in lacking:
        del library._found[pair]
    tables = connect_tables(library, longest_ratio=1e6)
    rng = np.random.default_rng(6)
    a, b = random_vertices(300, rng), random_vertices(300, rng)
    found = durations(tables, a, b)
    assert np.isfinite(found).mean() > 0.8
    assert (found >= durations(TABLES, a, b) - 1e-9).all()
    flown_turns = set()
    for p, q in zip(a, b, strict=True):
        pieces, _ = connected(tables, p, q)
        flown_turns |= set(np.sign(pieces[pieces[:, piece.KIND] == piece.TRIM, piece.TURN]))
    assert flown_turns == {-1.0, 0.0}


def test_tables_refer_to_the_manoeuvres_of_cruise_speeds_alone():
    every = set(range(len(TOY.manoeuvres)))
    assert set(used(TABLES)) == every
    slow = connect_tables(TOY, cruise=[10.0])
    climbing = {m.number for m in TOY.manoeuvres if m.first[1] or m.last[1]}
    fast = {m.number for m in TOY.manoeuvres if max(m.first[0], m.last[0]) > 10.0}
    assert every - set(used(slow)) >= climbing & fast
    assert slow.cruise.tolist() == [1, 0]
    assert tracks(TOY).first[-1] == 11 * len(TOY.manoeuvres)


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: connect_tables(TOY, cruise=[15.0]), r"cruise\[0\] = 15"),
        (lambda: connect_tables(TOY, cruise=[10.0, 0.0]), r"cruise\[1\] = 0"),
        (lambda: connect_tables(TOY, cruise=[]), "cruise"),
        (lambda: connect_tables(TOY, cruise=[math.nan]), r"cruise\[0\]"),
        (lambda: connect_tables(TOY, longest_ratio=0.9), "longest_ratio = 0.9"),
        (lambda: connect_tables(TOY, longest_ratio=math.inf), "longest_ratio = inf"),
        (
            lambda: connect_tables(bent(lambda a, b: [0, 0, 1e-6 * (a[2] != b[2]), 0])),
            "rise of manoeuvre",
        ),
        (
            lambda: connect_tables(bent(lambda a, b: [0, 0, 1e-6 * (a[0] != b[0]), 0])),
            "rise of manoeuvre",
        ),
        (
            lambda: connect_tables(bent(lambda a, b: [0, 1e-6 * (a[1] != b[1]), 0, 0])),
            "deviation of manoeuvre",
        ),
        (
            lambda: connect_tables(bent(lambda a, b: [0, 0, 0, 1e-6 * (a[0] != b[0])])),
            "deviation of manoeuvre",
        ),
        (
            lambda: connect_tables(ToyLibrary(likely, speeds=np.arange(9.0))),
            "cruise speeds x climb rates = 18",
        ),
    ],
)
def test_errors_name_what_is_wrong(make, argument):
    with pytest.raises(ArgumentError, match=argument):
        make()
