"""Flying beside a reference, within the limits of the inputs."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from ompl_risk._kernels import rigid_body, track
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.tracking import (
    EFFORT,
    TOLERATED,
    Tracker,
    _gains,
    trim_sensitivities,
    units,
)
from ompl_risk.helicopter.trims import solve_trim

DT = 0.02
X_CELL, LIMITS = Helicopter(), Limits()
TRACKER = Tracker(X_CELL, LIMITS, DT)
KEYS = [(0.0, 0.0, 0.0), (30.0, 0.0, 0.0), (20.0, 6.0, 0.0), (10.0, 0.0, -0.8), (0.0, 0.0, 0.3)]
TRIMS = {key: solve_trim(X_CELL, *key) for key in KEYS}


def along(trim, steps):
    """States of a trim from the origin on, by its closed form."""
    ways = [trim.displacement(k * DT) for k in range(steps + 1)]
    return np.array([trim.state(way[:3], way[3]) for way in ways])


@pytest.mark.parametrize("key", KEYS)
def test_the_gain_of_a_trim_is_that_of_an_endless_flight(key):
    """The Riccati equation iterated from nothing, instead of scipy's solution."""
    trim = TRIMS[key]
    a, b = trim_sensitivities(X_CELL, trim, DT, units(LIMITS, X_CELL) * EFFORT)
    n = 3000
    gains = track.backward_gains(
        np.tile(a, (n, 1, 1)), np.tile(b, (n, 1, 1)), TOLERATED**-2.0, np.zeros((12, 12))
    )
    gain = _gains(TRACKER, trim)[0]
    assert_allclose(gains[0], gain, rtol=1e-5, atol=1e-5 * np.abs(gain).max())
    assert np.abs(np.linalg.eigvals(a - b @ gain)).max() < 0.995


def test_gains_minimise_the_cost():
    """Any other input than the gains' costs more: completing the square, for three steps."""
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=(3, 12, 12)) / 4, rng.normal(size=(3, 12, 4))
    weights, last = rng.uniform(0.5, 2.0, 12), np.diag(rng.uniform(0.5, 2.0, 12))
    gains = track.backward_gains(a, b, weights, last)

    def cost(e, changes):
        total = 0.0
        for k in range(3):
            u = -gains[k] @ e + changes[k]
            total += e @ (weights * e) + u @ u
            e = a[k] @ e + b[k] @ u
        return total + e @ last @ e

    e = rng.normal(size=12)
    for _ in range(20):
        changes = 1e-3 * rng.normal(size=(3, 4))
        assert cost(e, changes) > cost(e, 0.0 * changes)
        slope = (cost(e, changes) - cost(e, -changes)) / 2.0
        assert abs(slope) < 1e-10


@pytest.mark.parametrize("key", KEYS)
def test_tracking_leads_back_onto_a_trim(key):
    trim, steps = TRIMS[key], 1400
    references = along(trim, steps)
    start = references[0] + np.repeat([0.3, 0.0, 0.1, 0.0], [3, 4, 3, 3])
    controls, states = TRACKER.track(trim, trim.control[None], references, start, trim.control)
    again = np.empty_like(states)
    rigid_body.rollout(start, controls, DT, X_CELL.given, again)
    assert (again == states).all()
    gap = np.linalg.norm((states - references)[:, :3], axis=1)
    assert gap.max() < 0.8
    assert gap[-1] < 1e-3


def test_tracking_leads_back_during_a_manoeuvre():
    library = default_library()
    tracker = Tracker(library.helicopter, library.limits, library.dt)
    first = library.trim(30.0)
    one = library.manoeuvre(first, library.trim(20.0))
    start = one.states[0] + np.eye(13)[1] * 0.3
    _, states = tracker.track(one, one.controls, one.states, start, first.control)
    held = np.empty_like(states)
    rigid_body.rollout(start, one.controls, library.dt, library.helicopter.given, held)
    assert np.abs(held[-1, 1] - one.states[-1, 1]) > 0.29  # it stays beside if nothing is done
    assert np.abs(states[-1, 1] - one.states[-1, 1]) < 0.27


@given(st.lists(st.floats(-30.0, 30.0), min_size=9, max_size=9), st.integers(0, 4))
@settings(deadline=None, max_examples=30)
def test_inputs_stay_within_the_limits_however_far_it_is(offset, which):
    trim = TRIMS[KEYS[which]]
    references = along(trim, 60)
    x, y, z, *rest = offset
    start = references[0] + np.array([x, y, z, 0, 0, 0, 0, *rest]) * np.repeat(
        [1.0, 0.3, 0.1], [7, 3, 3]
    )
    controls, _ = TRACKER.track(trim, trim.control[None], references, start, trim.control)
    low, high = LIMITS.controls(X_CELL)
    assert (controls >= low).all()
    assert (controls <= high).all()
    changes = np.abs(np.diff(np.vstack([trim.control, controls]), axis=0)) / DT
    assert (changes <= LIMITS.control_rates(X_CELL) * (1.0 + 1e-9)).all()


RAMPS = st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=30)


@given(RAMPS, st.floats(0.1, 3.0))
def test_eased_inputs_change_no_faster_than_allowed(values, most):
    inputs = np.column_stack([values] * 4)
    eased = track.eased(inputs, np.full(4, most))
    assert (np.abs(np.diff(eased, axis=0)) <= most + 1e-12).all()
    assert_allclose(track.eased(inputs[::-1].copy(), np.full(4, most)), eased[::-1], atol=1e-12)
    assert_allclose(track.eased(-inputs, np.full(4, most)), -eased, atol=1e-12)
    if (np.abs(np.diff(inputs, axis=0)) <= most).all():
        assert_allclose(eased, inputs, atol=1e-12)


def test_a_join_that_is_too_steep_is_eased_on_both_sides():
    ramp = np.array([-2.0, -1.0, 1.0, 2.0])
    eased = track.eased(np.column_stack([ramp] * 4), np.ones(4))[:, 0]
    assert_allclose(eased, [-1.5, -0.5, 0.5, 1.5])
    assert math.isclose(eased.sum(), ramp.sum(), abs_tol=1e-15)


def test_manoeuvres_in_a_row_are_eased_together():
    a, b = np.zeros((3, 4)), np.full((2, 4), 0.3)
    first, second = TRACKER.eased([a, b])
    assert first.shape == a.shape
    assert second.shape == b.shape
    change = LIMITS.control_rates(X_CELL) * DT
    assert np.abs(second[0] - first[-1])[2:] == pytest.approx(change[2:])
    assert TRACKER.eased([]) == []
