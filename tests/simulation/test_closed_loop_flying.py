"""Rollouts of the helicopter: replay, gusts, navigation errors, limits."""

import math
from functools import cache

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from loop_scene import CLIMB, CRUISE, HOVER, TURN, X_CELL, flown, ground, plan, steady
from numpy.testing import assert_allclose, assert_array_equal
from scalar_loop import scalar_loop

from ompl_risk._kernels import closed_loop, gusts, normals
from ompl_risk._kernels.air import COMPLETED
from ompl_risk._kernels.lanes import LANES, answer
from ompl_risk.helicopter.parameters import Limits
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.navigation import Drift, NavigationError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.air import air_for

NOTHING = Drift((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 10.0)


def correct(plan, e, control):
    """The control of the first step at a deviation, by the kernel."""
    loop, seen, controls = plan._loop, np.repeat(e, LANES), np.repeat(control, LANES)
    for j in range(4):
        answer_all(
            seen, loop.gains[0, j], loop.controls[0, j], loop.most[0, j],
            loop.low[j], loop.high[j], loop.change[j], j, controls,
        )  # fmt: skip
    return controls.reshape(4, LANES)[:, 0]


@numba.njit
def answer_all(seen, gain, planned, most, low, high, change, j, controls):
    answer(seen, gain, planned, most, low, high, change, j, controls)


@pytest.mark.parametrize("level", ["calm", "moderate", "severe"])
@pytest.mark.parametrize("key", [HOVER, CLIMB])
def test_lanes_fly_as_one_vehicle_after_the_other(key, level):
    """Against a loop of the library's own deviation, rotations and controls; 19: lanes left."""
    one, level = plan(key, 12.0, position=(500.0, 500.0, 200.0)), Disturbances.level(level)
    draws = Draws.make(19, 0, level)
    outcomes = flown(one, ground(), level, count=19, traced=1)
    air = air_for(one, ground(), level, draws)
    for k in (0, 7, 18):
        states, controls = scalar_loop(one._loop, air, k)
        assert_allclose(outcomes.traces[k], states[:, :3], rtol=0.0, atol=1e-6)
        limits = Limits()
        low, high = limits.controls(X_CELL)
        assert ((controls >= low) & (controls <= high)).all()


@pytest.mark.parametrize("key", [HOVER, CRUISE, TURN, CLIMB])
def test_undisturbed_rollouts_replay_the_flight(key):
    one = plan(key, 8.0)
    outcomes = flown(one, traced=1, count=3)
    assert outcomes.traces.shape == (3, 401, 3)
    for trace in outcomes.traces:
        assert_allclose(trace, one.positions, rtol=0.0, atol=1e-9)
    assert_array_equal(outcomes.endings, COMPLETED)
    assert_array_equal(outcomes.collided, np.inf)


def test_the_plan_in_still_air_is_flown_with_gusts_of_no_strength():
    """The drag of the planned motion is part of the plan."""
    one = plan(TURN, 8.0)
    outcomes = flown(one, disturbances=steady(0.0, drag=(5.0, 5.0, 20.0)), traced=1)
    assert_allclose(outcomes.traces - one.positions, 0.0, atol=1e-8)


def test_a_steady_gust_is_leant_against():
    """In hover: C w = m g lean; what place and lean ask of the input then adds up to nothing."""
    one = plan(HOVER, 25.0)
    outcomes = flown(one, disturbances=steady(0.3, drag=(2.0, 3.0, 6.0)), traced=1)
    first = np.array([_normals(seed, 1)[0] for seed in _seeds(8)])
    lean = -2.0 * 0.3 * first / X_CELL.weight
    gain = one.gains[-1]  # of the rotor's pitch, on place and lean along the gust
    away = -gain[2, 4] / gain[2, 0] * lean
    found = outcomes.traces[:, -1] - one.positions[-1]
    assert np.abs(away).max() > 0.02
    assert_allclose(found[:, 0], away, rtol=0.01)
    assert_allclose(found[:, 1], 0.0, atol=0.01 * np.abs(away).max())


@pytest.mark.parametrize("turned", [0.0, 1.0, math.pi / 2.0])
def test_gusts_push_along_the_axes_of_the_body(turned):
    """The gust blows eastward and meets a drag that differs between the axes of the vehicle."""
    one = plan(HOVER, 25.0, heading=turned)
    found = flown(one, disturbances=steady(0.3, drag=(2.0, 6.0, 1.0)), traced=1, count=4)
    first = np.array([_normals(seed, 1)[0] for seed in _seeds(4)])
    forward = 2.0 * 0.3 * first * math.cos(turned) * one.gains[-1, 2, 4] / one.gains[-1, 2, 0]
    left = -6.0 * 0.3 * first * math.sin(turned) * -one.gains[-1, 3, 3] / one.gains[-1, 3, 1]
    c, s = math.cos(turned), math.sin(turned)
    away = (found.traces[:, -1] - one.positions[-1]) * X_CELL.weight
    expected = np.column_stack([c * forward - s * left, s * forward + c * left])
    assert_allclose(away[:, :2], expected, atol=0.01 * np.abs(expected).max())


def test_a_gust_carries_no_faster_than_it_blows():
    """Beyond what lifts of 0.2 to 2 weights can hold: C (w - v) + lift - m g = 0 in the end."""
    one = plan(HOVER, 20.0, position=(500.0, 500.0, 500.0))
    outcomes = flown(one, disturbances=Vertical(12.0, 40.0), traced=1, count=12)
    numbers = np.array([_normals(seed, 5) for seed in _seeds(12)])
    wind = 12.0 * (0.5**0.5 * 3.0**0.5 * numbers[:, 3])
    wind += 12.0 * (1.0 - 3.0**0.5) * 0.125**0.5 * (numbers[:, 3] + numbers[:, 4])
    speeds = (outcomes.traces[:, -1, 2] - outcomes.traces[:, -2, 2]) / one.dt
    most = X_CELL.weight / 40.0
    carried = np.minimum(wind + most, 0.0) + np.maximum(wind - 0.8 * most, 0.0)
    assert (carried < -1.0).sum() >= 2
    assert_allclose(speeds, carried, atol=0.02)


class Vertical:
    """Disturbances by constant upward gusts alone."""

    navigation = terrain = None

    def __init__(self, speed, drag):
        self.gusts, self.speed, self.drag = self, speed, (0.0, 0.0, drag)

    def filters(self, heights, speeds, headings, dt):
        rows = np.zeros((len(heights), gusts.FILTER))
        rows[:, gusts.UP] = rows[:, gusts.COSINE] = 1.0
        rows[:, gusts.UP_SIGMA] = self.speed
        return rows


def _seeds(count):
    return Draws.make(count, 0, Disturbances()).seeds


def _normals(seed, count):
    found = np.empty(count)
    normals.fill_normal(np.array([seed], np.uint64), found)
    return found


@pytest.mark.parametrize("key", [HOVER, CRUISE])
def test_a_vehicle_that_believes_a_wrong_place_flies_beside_its_plan(key):
    """With a constant error of the position, in world axes, by exactly that much."""
    far = Drift((2.0, 3.0, 1.0), (0.0, 0.0, 0.0), 1e12)
    errors = NavigationError(far, NOTHING, NOTHING)
    one = plan(key, 16.0, heading=0.8)
    outcomes = flown(one, disturbances=Disturbances(navigation=errors), traced=1)
    found = outcomes.traces[:, -1] - one.positions[-1]
    numbers = np.array([_normals(seed ^ closed_loop.ASIDE, 3) for seed in _seeds(8)])
    assert_allclose(found, -numbers * [2.0, 3.0, 1.0], atol=0.01)


def test_navigation_is_updated_at_its_rate():
    """Every ten seconds: by then the vehicle is where the last update has it."""
    one = plan(HOVER, 20.0)
    noise = Drift((0.0, 0.0, 0.0), (1.0, 2.0, 0.5), 1.0)
    errors = NavigationError(noise, NOTHING, NOTHING, 0.1)
    traces = flown(one, disturbances=Disturbances(navigation=errors), traced=500).traces
    numbers = np.array([_normals(seed ^ closed_loop.ASIDE, 45) for seed in _seeds(8)])
    for row, first in ((1, 9), (2, 27)):  # nine of the first biases, eighteen of an update
        expected = -numbers[:, first + 1 : first + 7 : 2] * [1.0, 2.0, 0.5]
        assert_allclose(traces[:, row] - one.positions[0], expected, atol=0.02)


def test_noise_of_the_navigation_is_not_amplified():
    """What the vehicle does because of it is less than the noise of the position itself."""
    noise = Drift((0.0, 0.0, 0.0), (0.5, 0.5, 0.5), 1.0)
    one = plan(CRUISE, 20.0)
    disturbances = Disturbances(navigation=NavigationError(noise, NOTHING, NOTHING))
    away = flown(one, disturbances=disturbances, traced=1, count=20).traces - one.positions
    assert (away[:, 250:].std(axis=(0, 1)) < noise.noise).all()


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), size=st.floats(0.0, 100.0))
def test_inputs_and_their_rates_stay_within_the_limits(seed, size):
    rng = np.random.default_rng(seed)
    one, limits = _limited(), Limits()
    low, high = limits.controls(X_CELL)
    before = rng.uniform(low, high)
    control = correct(one, size * rng.normal(size=12), before)
    assert (control >= low).all()
    assert (control <= high).all()
    most = limits.control_rates(X_CELL) * one.dt
    assert (np.abs(control - before) <= most * (1.0 + 1e-12)).all()


@cache
def _limited():
    return plan(TURN, 0.1)


@pytest.mark.parametrize(
    ("component", "tilt", "share", "sign"),
    [(0, 2, 0.6, -1), (6, 2, 1.0, -1), (1, 3, 0.6, 1), (7, 3, 1.0, 1)],
)
def test_far_from_the_plan_the_law_asks_for_a_lean_and_no_more(component, tilt, share, sign):
    """Where the vehicle leans by half a radian, or 0.6 of it, the input is as planned again."""
    one, rests = _limited(), _limited().flight.controls[0]
    e = np.zeros(12)
    e[component] = 1e4
    assert abs(correct(one, e, rests)[tilt] - rests[tilt]) > 0.01
    e[6 - tilt] = sign * share * 0.5  # nose down to go forward, to the right to go right
    assert abs(correct(one, e, rests)[tilt] - rests[tilt]) < 1e-9


@pytest.mark.parametrize("level", ["calm", "moderate", "severe"])
def test_no_rollout_is_lost_in_any_level(level):
    one = plan(TURN, 20.0, position=(500.0, 500.0, 150.0))
    level = Disturbances.level(level)
    high = Disturbances(gusts=level.gusts, navigation=level.navigation)
    outcomes = flown(one, disturbances=high, count=40)
    assert not outcomes.lost.any()
