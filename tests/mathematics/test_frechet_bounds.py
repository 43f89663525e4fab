import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk._kernels import frechet as kernels

coordinate = st.integers(-9, 9).map(float)
curves = st.integers(1, 8).flatmap(
    lambda n: st.lists(st.tuples(coordinate, coordinate), min_size=n, max_size=n).map(np.array)
)


def bounded(a, b, bound):
    row = np.full(len(b), -1.0)  # what work space holds at first is nobody's business
    return kernels.squared_frechet(a, b, bound, row)


@given(curves, curves, st.integers(0, 700).map(float))
@settings(deadline=None)
def test_bounded_by_what_matters(a, b, bound):
    exact = round(kernels.discrete_frechet(a, b) ** 2)
    assert bounded(a, b, bound) == (exact if exact <= bound else math.inf)
    assert bounded(a, b, float(exact)) == exact


@given(curves, curves, st.integers(0, 700).map(float))
@settings(deadline=None)
def test_greedy_walkers_need_no_shorter_leash(a, b, bound):
    exact = round(kernels.discrete_frechet(a, b) ** 2)
    upper = kernels.squared_greedy(a, b, math.inf)
    assert upper >= exact
    limited = kernels.squared_greedy(a, b, bound)
    assert limited == upper if upper <= bound else limited > bound


@given(curves)
@settings(deadline=None)
def test_greedy_walkers_stay_together_on_one_curve(a):
    assert kernels.squared_greedy(a, a, math.inf) == 0.0


@given(curves, curves, st.integers(1, 3), st.integers(0, 700).map(float))
@settings(deadline=None)
def test_nearness_by_definition(a, b, every, bound):
    apart = ((a[::every, None] - b[None]) ** 2).sum(2).min(1).max()
    assert kernels.are_near(a, b, every, bound) == (apart <= bound)
    assert kernels.are_near(a, b, every, round(kernels.discrete_frechet(a, b) ** 2))


def test_a_walker_ahead_waits():
    a = np.array([[0.0, 0], [1, 0], [2, 0], [3, 0], [4, 0]])
    b = np.array([[0.0, 1], [0, 1], [0, 1], [2, 1], [4, 1]])
    assert kernels.squared_greedy(a, b, math.inf) == pytest.approx(2.0)
    assert bounded(a, b, 2.0) == pytest.approx(2.0)
    assert bounded(a, b, 1.9) == math.inf
