"""Shortcuts: never dearer, never through an obstacle, taut where the length counts."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.planners import shortcut

DISC, RADIUS = np.array([0.0, 0.0, 0.0]), 1.0


def around_disc(a, b):
    """Length of a motion, inf if it meets the unit ball about the origin."""
    along = np.clip(-(a @ (b - a)) / max((b - a) @ (b - a), 1e-300), 0.0, 1.0)
    nearest = np.linalg.norm(a + along * (b - a))
    return np.inf if nearest < RADIUS else float(np.linalg.norm(b - a))


def total(path, cost):
    return sum(cost(a, b) for a, b in pairwise(path))


def test_corners_without_need_disappear():
    zigzag = np.array([[0, 5, 0], [1, 9, 0], [2, 3, 0], [3, 8, 0], [4, 5, 0]], dtype=float)
    result = shortcut(zigzag, around_disc)
    np.testing.assert_array_equal(result, zigzag[[0, -1]])


def test_a_detour_around_an_obstacle_becomes_nearly_the_shortest_way():
    detour = np.array([[-3, 0, 0], [-3, 6, 0], [3, 6, 0], [3, 0, 0]], dtype=float)
    shortest = 2 * np.sqrt(8.0) + 2 * np.arcsin(1.0 / 3.0)  # two tangents and the arc between
    result = shortcut(detour, around_disc, rounds=8)
    assert shortest <= total(result, around_disc) < 1.03 * shortest


@given(
    st.lists(
        st.tuples(*[st.floats(-4, 4)] * 2, st.floats(1.5, 4)), min_size=2, max_size=8, unique=True
    ),
    st.integers(0, 4),
)
def test_the_cost_never_rises_and_the_ends_stay(points, rounds):
    path = np.array(points)  # above z = 1, so free
    result = shortcut(path, around_disc, rounds=rounds)
    np.testing.assert_array_equal(result[[0, -1]], path[[0, -1]])
    assert total(result, around_disc) <= total(path, around_disc) * (1 + 1e-12)


def test_a_cost_that_is_no_length_is_heeded():
    """Flight costs ten times as much below y = 1: the way round over y = 1 is kept."""

    def cost(a, b):
        low = min(a[1], b[1]) < 1.0
        return (10.0 if low else 1.0) * float(np.linalg.norm(b - a))

    path = np.array([[0, 1, 0], [5, 4, 0], [10, 1, 0]], dtype=float)
    assert total(shortcut(path, cost), cost) == pytest.approx(10.0)
    blocked = np.array([[0, 0, 0], [0, 1, 0], [10, 1, 0], [10, 0, 0]], dtype=float)
    result = shortcut(blocked, cost, rounds=0)
    np.testing.assert_array_equal(result, blocked)
