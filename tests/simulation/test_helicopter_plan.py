"""The helicopter's plan: its gains, and that the loop they close is stable and well damped."""

import pickle

import numpy as np
import pytest
from loop_scene import CLIMB, CRUISE, HOVER, TURN, X_CELL, flight, flown, linear_step, plan, steady
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import solve_discrete_are

from ompl_risk._kernels import deviations
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.parameters import Limits
from ompl_risk.helicopter.tracking import units
from ompl_risk.simulation.loop.helicopter_plan import EFFORT, TOLERATED, HelicopterPlan

KEYS = [HOVER, CRUISE, TURN, CLIMB]
SPANS = EFFORT * units(Limits(), X_CELL)


@pytest.mark.parametrize("key", KEYS)
def test_gains_in_a_trim_are_those_of_the_riccati_equation(key):
    """A and B by scipy's rotations; the last step, where nothing but the trim follows."""
    one = flight(key, 0.2)
    a, b = linear_step(one)
    b = b * SPANS
    cost = solve_discrete_are(a, b, np.diag(TOLERATED**-2.0), np.eye(4))
    gain = SPANS[:, None] * np.linalg.solve(np.eye(4) + b.T @ cost @ b, b.T @ cost @ a)
    found = HelicopterPlan(one).gains
    assert found.shape == (10, 4, 12)
    size = np.abs(gain).max(axis=1, keepdims=True)
    for row in found[[0, -1]]:
        assert_allclose(row / size, gain / size, rtol=0.0, atol=1e-4)


def test_gains_along_a_manoeuvre_follow_the_recursion():
    """Changing inputs, and the recursion written down once more, by the cost of a closed loop."""
    one = flight(CRUISE, 0.8)
    ramp = np.linspace(0.0, 1.0, 40)[:, None]
    changed = Flight(0.02, one.states, one.controls + ramp * [8.0, 0.3, 0.02, 0.02], one.states)
    changed = Flight(0.02, changed.replay(), changed.controls, one.states)
    steps = [linear_step(changed, k) for k in range(40)]
    weights = np.diag(TOLERATED**-2.0)
    a, b = steps[-1][0], steps[-1][1] * SPANS
    cost = solve_discrete_are(a, b, weights, np.eye(4))
    found = HelicopterPlan(changed).gains
    for k in range(39, -1, -1):
        a, b = steps[k][0], steps[k][1] * SPANS
        gain = np.linalg.inv(np.eye(4) + b.T @ cost @ b) @ b.T @ cost @ a
        left = a - b @ gain
        cost = weights + left.T @ cost @ left + gain.T @ gain  # Joseph's form
        size = np.abs(SPANS[:, None] * gain).max(axis=1, keepdims=True)
        assert_allclose(found[k] / size, SPANS[:, None] * gain / size, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize("key", KEYS)
def test_the_closed_loop_is_well_damped(key):
    one = flight(key, 0.1)
    a, b = linear_step(one)
    poles = np.linalg.eigvals(a - b @ HelicopterPlan(one).gains[0])
    assert np.abs(poles).max() < 1.0
    s = np.log(poles.astype(complex)) / one.dt
    assert -s.real.max() > 0.5  # the slowest mode is gone after some seconds
    assert (-s.real / np.abs(s)).min() > 0.5  # no mode swings
    assert np.abs(s).max() < 0.3 * np.pi / one.dt  # nor is one too fast for 50 Hz


@pytest.mark.parametrize("key", KEYS)
def test_after_a_push_the_vehicle_comes_back(key):
    """A gust of a second throws it off its way by metres; ten seconds later by centimetres."""
    one = plan(key, 14.0, position=(500.0, 500.0, 200.0))
    outcomes = flown(one, disturbances=steady(12.0, until=1.0), traced=1, count=6)
    away = np.linalg.norm(outcomes.traces - one.positions, axis=2)
    assert away.max(axis=1).max() > 1.0
    assert_allclose(away[:, -1] / away.max(axis=1), 0.0, atol=0.01)


def test_a_plan_says_where_it_flies():
    one = flight(TURN, 1.0, heading=0.4)
    found = HelicopterPlan(one, name="A")
    assert found.name == "A"
    assert found.dt == one.dt
    assert_allclose(found.times, one.t)
    assert_allclose(found.positions, one.states[:, :3])
    assert_allclose(found.velocities, deviations.velocities_in_world(one.states))
    between = np.diff(found.positions, axis=0) / one.dt
    assert_allclose(0.5 * (found.velocities[1:] + found.velocities[:-1]), between, atol=1e-3)
    for array in (found.positions, found.velocities, found.gains):
        assert not array.flags.writeable


def test_limits_that_the_plan_breaks_are_refused():
    one = flight(TURN, 0.2)
    with pytest.raises(ArgumentError, match=r"flight\.controls\[0\].*collective"):
        HelicopterPlan(one, Limits(lift=(0.9, 1.1)))
    jump = one.controls.copy()
    jump[3:, 2] += 0.1
    broken = Flight(one.dt, one.states, jump, one.states)
    with pytest.raises(ArgumentError, match=r"flight\.controls\[\d\].*rotor pitch"):
        HelicopterPlan(broken)


def test_a_plan_that_is_pickled_is_the_same():
    one = HelicopterPlan(flight(TURN, 0.2), Limits(speed=30.0), "A")
    other = pickle.loads(pickle.dumps(one))
    assert (other.name, other.limits) == ("A", one.limits)
    assert_array_equal(other.gains, one.gains)
    assert not other.positions.flags.writeable
    assert repr(other) == repr(one) == f"HelicopterPlan({one.flight!r}, name='A')"
