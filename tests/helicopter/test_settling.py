"""Corrections that lead from near a trim into it."""

import math

import numpy as np
import pytest
from flown_routes import apart
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from ompl_risk._kernels import deviations, rigid_body, settle
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.settling import Settler
from ompl_risk.helicopter.tracking import trim_sensitivities, units
from ompl_risk.helicopter.trims import solve_trim

DT = 0.02
X_CELL = Helicopter()
SETTLER = Settler(X_CELL, Limits(), DT)
UNITS = units(Limits(), X_CELL)
KEYS = [
    (0.0, 0.0, 0.0),
    (20.0, 0.0, 0.0),
    (30.0, -6.0, 0.0),
    (0.0, 0.0, 0.8),
    (10.0, 2.0, -0.4),
    (30.0, 0.0, 0.274),
]
TRIMS = {key: solve_trim(X_CELL, *key) for key in KEYS}


def ahead(trim, seconds, pose=(0.0, 0.0, 0.0, 0.0)):
    """The pose that a trim leads to."""
    x, y, z, turn = trim.displacement(seconds)
    c, s = math.cos(pose[3]), math.sin(pose[3])
    return np.array([pose[0] + c * x - s * y, pose[1] + s * x + c * y, pose[2] + z, pose[3] + turn])


def shifted(reference, e):
    """The state that deviates by ``e``, by scipy's rotations."""
    body = Rotation.from_quat(reference[3:7])
    turned = (body * Rotation.from_rotvec(e[3:6])).as_quat()
    return np.concatenate([reference[:3] + body.apply(e[:3]), turned, reference[7:] + e[6:]])


def difference(state, reference):
    body = Rotation.from_quat(reference[3:7])
    turn = (body.inv() * Rotation.from_quat(state[3:7])).as_rotvec()
    return np.concatenate(
        [body.inv().apply(state[:3] - reference[:3]), turn, (state - reference)[7:]]
    )


@pytest.mark.parametrize("key", KEYS)
def test_sensitivities_predict_a_step_from_anywhere(key):
    trim, rng = TRIMS[key], np.random.default_rng(1)
    a, b = trim_sensitivities(X_CELL, trim, DT, UNITS)
    for _ in range(5):
        pose = rng.uniform(-3.0, 3.0, 4)
        end = ahead(trim, DT, pose)
        e, du = 1e-6 * rng.normal(size=12), 1e-6 * rng.normal(size=4)
        out = np.empty(13)
        start = shifted(trim.state(pose[:3], pose[3]), e)
        rigid_body.propagate(start, trim.control + UNITS * du, DT, X_CELL.given, out)
        assert_allclose(difference(out, trim.state(end[:3], end[3])), a @ e + b @ du, atol=2e-11)


@given(st.lists(st.floats(-0.8, 0.8), min_size=12, max_size=12))
@settings(deadline=None, max_examples=30)
def test_deviation_is_what_scipy_says(e):
    reference = TRIMS[10.0, 2.0, -0.4].state((3.0, -4.0, 5.0), 2.0)
    out, e = np.empty(13), np.array(e)
    deviations.deviated(reference, e, out)
    assert_allclose(out, shifted(reference, e), atol=1e-14)
    back = np.empty(12)
    deviations.deviation(out, reference, back)
    assert_allclose(back, e, atol=1e-14)
    deviations.deviation(out * np.repeat([1.0, -1.0, 1.0], [3, 4, 6]), reference, back)
    assert_allclose(back, e, atol=1e-14)  # q and -q are one attitude


@pytest.mark.parametrize("key", KEYS)
def test_settling_ends_in_the_trim(key):
    trim, steps = TRIMS[key], 250
    pose = np.array([1200.0, -3400.0, 80.0, 2.5])
    end = ahead(trim, steps * DT, pose)
    e = np.repeat([0.1, 0.003, 0.03, 0.01], 3) * np.tile([1.0, -1.0, 1.0], 4)
    start = shifted(trim.state(pose[:3], pose[3]), e)
    found = SETTLER.settle(trim, start, end, steps)
    states = np.empty((steps + 1, 13))
    rigid_body.rollout(start, found.controls, DT, X_CELL.given, states)
    assert (states == found.states).all()
    wanted = trim.state(end[:3], end[3])
    wanted[3:7] *= np.sign(wanted[3:7] @ states[-1, 3:7])
    assert_allclose(states[-1], wanted, rtol=0.0, atol=3e-11)
    assert found.succeeded
    assert (found.controls[[0, -1]] == trim.control).all()


def test_settling_tells_how_far_it_strays():
    trim, steps = TRIMS[30.0, 0.0, 0.274], 200
    start = shifted(trim.state(), np.eye(12)[1] * 0.3)
    found = SETTLER.settle(trim, start, ahead(trim, steps * DT), steps)
    beside = apart(
        found.states, [trim.state(p[:3], p[3]) for p in (ahead(trim, k * DT) for k in range(201))]
    )
    assert_allclose([found.distance, found.angle], beside.max(axis=0), rtol=1e-9)
    low, high = Limits().controls(X_CELL)
    share = np.abs(2.0 * found.controls - low - high) / (high - low)
    rates = np.abs(np.diff(found.controls, axis=0)) / DT / Limits().control_rates(X_CELL)
    assert_allclose(found.effort, max(share.max(), rates.max()), rtol=1e-12)


@pytest.mark.parametrize("key", KEYS)
def test_the_change_of_the_inputs_is_the_least(key):
    """Least squares by numpy on the matrix C itself; the correction is linear if it is tiny."""
    trim, steps = TRIMS[key], 150
    a, b = trim_sensitivities(X_CELL, trim, DT, UNITS)
    weights = np.sqrt([settle.share(j, steps) for j in range(steps)])
    powers = [np.linalg.matrix_power(a, steps - 1 - j) @ b * weights[j] for j in range(steps)]
    e = 1e-6 * np.random.default_rng(2).normal(size=12)
    found = SETTLER.settle(trim, shifted(trim.state(), e), ahead(trim, steps * DT), steps)
    free = np.linalg.matrix_power(a, steps) @ e
    du = np.linalg.lstsq(np.hstack(powers), -free, rcond=None)[0].reshape(steps, 4)
    expected = du * weights[:, None]
    actual = (found.controls - trim.control) / UNITS
    assert_allclose(actual, expected, rtol=0.0, atol=1e-3 * np.abs(expected).max())


def test_in_the_trim_nothing_is_changed():
    trim = TRIMS[20.0, 0.0, 0.0]
    found = SETTLER.settle(trim, trim.state(), ahead(trim, 2.0), 100)
    assert (found.controls == trim.control).all()
    assert found.left <= 1.0


def test_more_time_makes_it_gentler():
    trim = TRIMS[20.0, 0.0, 0.0]
    start = shifted(trim.state(), np.eye(12)[0] * 0.3)
    angles = [
        SETTLER.settle(trim, start, ahead(trim, n * DT), n).angle for n in (100, 150, 250, 500)
    ]
    assert (np.diff(angles) < 0.0).all()
    assert angles[2] < math.radians(1.0)  # five seconds for half a step at 30 m/s


def test_too_little_time_breaks_the_limits_and_is_no_success():
    trim = TRIMS[20.0, 0.0, 0.0]
    start = shifted(trim.state(), np.eye(12)[1] * 0.5)
    found = SETTLER.settle(trim, start, ahead(trim, 0.5), 25)
    assert found.effort > 1.0
    assert not found.succeeded


def test_a_jump_from_the_input_before_counts():
    trim = TRIMS[20.0, 0.0, 0.0]
    pose = ahead(trim, 2.0)
    calm = SETTLER.settle(trim, trim.state(), pose, 100, trim.control)
    jump = SETTLER.settle(trim, trim.state(), pose, 100, trim.control + np.eye(4)[2] * 0.1)
    assert calm.succeeded
    assert not jump.succeeded
    assert jump.effort == pytest.approx(0.1 / DT / 2.0)


def test_the_shipped_trims_can_be_settled():
    library = default_library()
    settler = Settler(library.helicopter, library.limits, library.dt)
    for trim in library.trims[::7]:
        start = shifted(trim.state(), np.repeat([0.1, 0.002, 0.0, 0.0], 3))
        assert settler.settle(trim, start, ahead(trim, 4.0), 200).succeeded, trim.key


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        ({"steps": 14}, "steps = 14"),
        ({"state": np.zeros(12)}, r"state\.shape"),
        ({"state": np.full(13, np.nan)}, r"state\[0\]"),
        ({"pose": np.zeros(3)}, r"pose\.shape"),
        ({"before": np.zeros(3)}, r"before\.shape"),
    ],
)
def test_wrong_arguments_are_named(changed, name):
    trim = TRIMS[20.0, 0.0, 0.0]
    fields = {"state": trim.state(), "pose": ahead(trim, 1.0), "steps": 50} | changed
    with pytest.raises(ArgumentError, match=name):
        SETTLER.settle(trim, **fields)


def test_a_time_step_must_be_positive():
    with pytest.raises(ArgumentError, match="dt"):
        Settler(X_CELL, Limits(), 0.0)
