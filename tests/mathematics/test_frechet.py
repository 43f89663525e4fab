from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.errors import ArgumentError
from ompl_risk.frechet import frechet_distance
from ompl_risk.trajectory import Trajectory

coordinate = st.integers(-9, 9).map(float)
curves = st.integers(1, 6).flatmap(
    lambda n: st.lists(st.tuples(coordinate, coordinate), min_size=n, max_size=n).map(np.array)
)


def by_definition(a, b):
    """The recursion of Eiter and Mannila."""

    @cache
    def c(i, j):
        d = float(np.sqrt(((a[i] - b[j]) ** 2).sum()))
        if i == j == 0:
            return d
        before = [(i - 1, j), (i - 1, j - 1), (i, j - 1)]
        return max(d, min(c(k, m) for k, m in before if k >= 0 and m >= 0))

    return c(len(a) - 1, len(b) - 1)


@given(curves, curves)
def test_against_the_recursion(a, b):
    assert frechet_distance(a, b) == pytest.approx(by_definition(a, b), rel=1e-15)


@given(curves, curves, curves)
@settings(max_examples=50)
def test_it_is_a_metric_on_curves(a, b, c):
    assert frechet_distance(a, a) == 0
    assert frechet_distance(a, b) == frechet_distance(b, a) >= 0
    detour = frechet_distance(a, b) + frechet_distance(b, c)
    assert frechet_distance(a, c) <= detour * (1 + 1e-15)


@given(curves, curves)
def test_no_leash_is_shorter_than_ends_or_hausdorff(a, b):
    apart = np.linalg.norm(a[:, None] - b[None], axis=2)
    least = max(apart[0, 0], apart[-1, -1], apart.min(0).max(), apart.min(1).max())
    assert frechet_distance(a, b) >= least * (1 - 1e-15)


def test_going_back_costs_although_the_sets_are_equal():
    there_and_back = [[0, 0], [4, 0], [0, 0], [4, 0]]
    assert frechet_distance(there_and_back, [[0, 0], [4, 0]]) == 4.0
    assert frechet_distance([[0, 0], [4, 0]], there_and_back) == 4.0


def test_trajectories_by_their_positions_only():
    a = Trajectory([0, 1, 2], [[0, 0, 0], [5, 0, 0], [9, 0, 0]])
    b = Trajectory([0, 7, 8], [[0, 0, 3], [5, 0, 3], [9, 0, 3]])
    assert frechet_distance(a, b) == 3.0


def test_what_is_refused():
    with pytest.raises(ArgumentError, match=r"b.shape = \(1, 3\): must be \(m, 2\)"):
        frechet_distance([[0, 0]], [[0, 0, 0]])
    with pytest.raises(ArgumentError, match=r"a.shape = \(0, 3\)"):
        frechet_distance(np.zeros((0, 3)), [[0, 0, 0]])
    with pytest.raises(ArgumentError, match=r"b\[0, 1\] = nan"):
        frechet_distance([[0, 0]], [[0, np.nan]])
    with pytest.raises(ArgumentError, match=r"a.shape = \(2,\)"):
        frechet_distance([0, 0], [[0, 0]])
