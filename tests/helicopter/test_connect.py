"""The kernel that connects two vertices, against flown pieces and solvers of other kinds."""

import math

import numpy as np
import pytest
from connecting import assert_flies, connected, durations, flown, moved, random_vertices
from hypothesis import given, settings
from hypothesis import strategies as st
from toy_primitives import ToyLibrary, likely
from word_solver import Solver

from ompl_risk._kernels import connect_tables as columns
from ompl_risk._kernels import pieces as piece
from ompl_risk.helicopter.tables import connect_tables

TOY = ToyLibrary(likely)
TABLES = connect_tables(TOY, longest_ratio=1e6)
IDEAL = ToyLibrary(speeds=[20.0])


def test_pieces_lead_from_one_vertex_to_the_other():
    rng = np.random.default_rng(1)
    a, b = random_vertices(2000, rng), random_vertices(2000, rng)
    times = durations(TABLES, a, b)
    assert np.isfinite(times).mean() > 0.95
    most = 0
    for p, q, time in zip(a, b, times, strict=True):
        pieces, duration = connected(TABLES, p, q)
        assert duration == time
        most = max(most, len(pieces))
        if math.isfinite(duration):
            assert_flies(TOY, p, q, pieces, duration)
    assert 15 <= most <= 20


@given(
    st.floats(-1e-3, 1e-3) | st.sampled_from([0.0, 1e-9, 1e-11, -1e-12]),
    st.floats(-1e-3, 1e-3) | st.sampled_from([0.0, 1e-9, -1e-11, 1e-12]),
    st.floats(-2.0, 2.0) | st.sampled_from([0.0, 1e-9, 1e-11]),
    st.floats(-math.pi, math.pi) | st.sampled_from([0.0, math.pi / 2, math.pi]),
    st.integers(1, 3),
    st.integers(1, 3),
)
@settings(max_examples=200, deadline=None)
def test_nearly_straight_ahead_leaves_no_gap(bearing, turn, rise, heading, i, j):
    a = np.array([100.0, 200.0, 300.0, heading, i])
    at = 350.0 * np.exp(1j * (heading + bearing))
    b = np.array([100.0 + at.real, 200.0 + at.imag, 300.0 + rise, heading + turn, j])
    pieces, duration = connected(TABLES, a, b)
    straight = connected(TABLES, [0, 0, 0, 0, i], [350, 0, 0, 0, j])[1]
    assert straight <= duration + 1e-9 < straight + 13.0  # two counter-turns and the climb
    assert_flies(TOY, a, b, pieces, duration)


def dubins_lengths(radius, a, b):
    ob = pytest.importorskip("ompl.base")
    space = ob.DubinsStateSpace(radius)
    found = []
    for pair in zip(a, b, strict=True):
        states = [space.allocState() for _ in pair]
        for state, row in zip(states, pair, strict=True):
            state.setXY(float(row[0]), float(row[1]))
            state.setYaw(math.remainder(row[3], 2.0 * math.pi))
        found.append(space.distance(*states))
    return np.array(found)


def test_ideal_primitives_make_dubins_shortest_paths():
    tables = connect_tables(IDEAL, longest_ratio=1e6)
    blocks = tables.blocks.copy()
    blocks[:, 2:, columns.LEAST_TIME] = np.inf  # hard turns only, so that there is one radius
    tables = tables._replace(blocks=blocks)
    rng = np.random.default_rng(2)
    radius = 20.0 / IDEAL.turns[0, 3]
    a, b = (random_vertices(1500, rng, span=span, speeds=1, rise=0.0) for span in (400.0, 400.0))
    least = dubins_lengths(radius, a, b)
    lengths = 20.0 * durations(tables, a, b)
    # three turns are only shorter, and only offered by OMPL, where circles of both ends meet
    far = np.hypot(*(b - a)[:, :2].T) > 4.0 * radius
    assert 300 < far.sum() < 1400
    np.testing.assert_allclose(lengths[far], least[far], rtol=1e-9)
    assert (lengths >= least * (1.0 - 1e-9)).all()


def test_no_word_speed_or_climb_takes_less_time():
    rng = np.random.default_rng(3)
    a, b = random_vertices(16, rng, span=500.0), random_vertices(16, rng, span=500.0)
    near = slice(None, None, 2)  # half of them with heading changes that need counter-turns
    bearing = rng.uniform(-0.15, 0.15, 8) + np.tile([0.0, 1.3], 4)  # at one end or at both
    ahead = a[near, 3] + bearing
    b[near, 3] = ahead + rng.uniform(-0.15, 0.15, 8)
    b[near, :2] = a[near, :2] + 400.0 * np.column_stack([np.cos(ahead), np.sin(ahead)])
    b[::4, 2] = a[::4, 2] + rng.uniform(-1.0, 1.0, 4)  # and some that go up and down again
    solver = Solver(TOY)
    least = [solver.least(p, q) for p, q in zip(a, b, strict=True)]
    np.testing.assert_allclose(durations(TABLES, a, b), least, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(("speed", "longer"), [(1, 7.0), (2, 4.0), (3, 2.0)])
def test_no_heading_change_needs_a_circle(speed, longer):
    turns = np.linspace(-0.4, 0.4, 4001)
    a, b = np.zeros((4001, 5)), np.zeros((4001, 5))
    a[:, 4] = b[:, 4] = speed
    for bearing in (turns, 0.5 * turns, np.zeros(4001)):
        b[:, 0], b[:, 1], b[:, 3] = 300.0 * np.cos(bearing), 300.0 * np.sin(bearing), turns
        found = durations(TABLES, a, b)
        straight = connected(TABLES, a[0], [300, 0, 0, 0, speed])[1]
        assert (found < straight + longer).all()  # a circle takes 7.6 s times the speed index


def test_ways_of_mirrored_vertices_take_the_same_time():
    rng = np.random.default_rng(4)
    a, b = random_vertices(300, rng), random_vertices(300, rng)
    mirror = np.array([1.0, -1.0, 1.0, -1.0, 1.0])
    np.testing.assert_allclose(
        durations(TABLES, a * mirror, b * mirror), durations(TABLES, a, b), rtol=1e-9
    )


def test_straight_ahead_needs_no_turn():
    pieces, duration = connected(TABLES, [0, 0, 50, 0.3, 3], [*rotated(90.0, 0.3), 50, 0.3, 3])
    assert duration == pytest.approx(3.0)
    assert len(pieces) == 1
    assert pieces[0, piece.DURATION] == pytest.approx(3.0)


def rotated(length, heading):
    return length * math.cos(heading), length * math.sin(heading)


@pytest.mark.parametrize("backwards", [False, True])
def test_one_turn_suffices_where_it_leads_right_there(backwards):
    rate = TOY.turns[2, 3]
    entry = TOY.manoeuvre((20.0, 0.0, 0.0), (20.0, 0.0, rate))
    leave = TOY.manoeuvre((20.0, 0.0, rate), (20.0, 0.0, 0.0))
    held = np.array([0, 0, 0, 0, 0, 0, 20.0, 0, rate, 0])
    held[piece.DURATION] = 1.5
    straight = np.array([100.0, 0.0, 0.0, 0.0])
    parts = [entry.displacement, flown(TOY, held), leave.displacement]
    pose = np.array([7.0, 8.0, 90.0, 1.0])
    for part in [straight, *parts] if backwards else [*parts, straight]:
        pose = moved(pose, part)
    pieces, duration = connected(TABLES, [7.0, 8.0, 90.0, 1.0, 2], [*pose, 2])
    assert duration <= entry.duration + 1.5 + leave.duration + 5.0 + 1e-9
    level = TABLES._replace(cruise=np.array([2]))
    pieces, duration = connected(level, [7.0, 8.0, 90.0, 1.0, 2], [*pose, 2])
    assert duration == pytest.approx(entry.duration + 1.5 + leave.duration + 5.0, abs=1e-9)
    assert len(pieces) == 4
    assert_flies(TOY, np.array([7.0, 8.0, 90.0, 1.0, 2]), np.array([*pose, 2]), pieces, duration)


def test_detours_beyond_the_ratio_are_not_offered():
    rng = np.random.default_rng(5)
    a = random_vertices(2000, rng, span=300.0, rise=30.0)
    b = random_vertices(2000, rng, span=300.0, rise=30.0)
    a[:, 4] = b[:, 4] = 3
    least = durations(TABLES, a, b)
    for ratio in (1.0, 1.5):
        tables = TABLES._replace(longest_ratio=ratio)
        found = durations(tables, a, b)
        ahead, there = a.copy(), b.copy()
        ahead[:, 3] = there[:, 3] = np.arctan2(*(b - a)[:, 1::-1].T)
        reach = np.hypot(*(b - a)[:, :2].T)
        hard = TOY.turns[3, 3]
        spent = 2.0 * likely((30.0, 0.0, 0.0), (30.0, 0.0, hard))[0]
        flat = np.abs(a[:, 2] - b[:, 2]) < 1.0
        most = ratio * reach / 30.0 + 2.0 * (spent + math.pi / hard)
        level = np.isfinite(found)
        assert 0.3 < level.mean() < 1.0
        np.testing.assert_array_equal(found[level], least[level])
        kept = least < most  # a climb only adds to what is allowed
        assert level[kept].all()
        assert not (level & (least > most + ratio * 12.0))[flat].any()


def test_from_a_vertex_to_itself_takes_no_time():
    for k in range(4):
        pieces, duration = connected(TABLES, [1, 2, 3, 0.4, k], [1, 2, 3, 0.4 - 2 * math.pi, k])
        assert duration == 0.0
        assert len(pieces) == 0
    assert connected(TABLES, [1, 2, 3, 0.4, 1], [1, 2, 3, 0.4, 2])[1] > 3.0
