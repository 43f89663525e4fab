import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import ompl_risk.trajectory as module
from ompl_risk.errors import ArgumentError
from ompl_risk.trajectory import Trajectory, register_path_reader

T = [0.0, 1.0, 3.0]
X = [[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 12.0]]
TURN = Rotation.from_euler("z", [[0], [90], [180]], degrees=True).as_quat()


@pytest.fixture
def full():
    return Trajectory(T, X, "A", orientations=TURN, velocities=X, controls=[[1.0], [2.0], [4.0]])


def test_duration_length_steps(full):
    assert full.duration == 3.0
    assert full.length == 17.0
    np.testing.assert_array_equal(full.steps, [5.0, 12.0])
    assert len(full) == 3
    assert repr(full) == "Trajectory('A', 3 samples, 3 s, 17 m)"


def test_poses(full):
    np.testing.assert_array_equal(full.poses, np.hstack([X, TURN]))
    upright = Trajectory(T, X).poses
    np.testing.assert_array_equal(upright[:, 3:], [[0, 0, 0, 1]] * 3)


def test_arrays_are_read_only_copies(full):
    source = np.array(X)
    trajectory = Trajectory(T, source)
    source[0, 0] = 99.0
    assert trajectory.positions[0, 0] == 0.0
    for array in (full.t, full.positions, full.orientations, full.velocities, full.controls):
        assert array.dtype == np.float64
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    for array in (full.poses, full.steps):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(AttributeError):
        full.name = "B"


def test_survives_pickling(full):
    again = pickle.loads(pickle.dumps(full))
    np.testing.assert_array_equal(again.poses, full.poses)
    assert again.name == "A"
    with pytest.raises(ValueError, match="read-only"):
        again.positions[0] = 1.0


def test_resample_interpolates(full):
    new = full.resample([0.5, 1.0, 2.0])
    np.testing.assert_allclose(new.positions, [[1.5, 2, 0], [3, 4, 0], [3, 4, 6]])
    np.testing.assert_allclose(new.velocities, new.positions)
    np.testing.assert_allclose(new.controls, [[1.5], [2.0], [3.0]])
    angles = Rotation.from_quat(new.orientations).as_euler("zyx", degrees=True)[:, 0]
    np.testing.assert_allclose(angles, [45, 90, 135], atol=1e-12)
    assert new.name == "A"


def test_resample_holds_controls_given_for_intervals():
    new = Trajectory(T, X, controls=[[1.0], [2.0]]).resample([0.0, 0.5, 1.0, 2.5, 3.0])
    np.testing.assert_array_equal(new.controls, [[1.0], [1.0], [2.0], [2.0]])


@pytest.mark.parametrize(("step", "samples"), [(1.0, 4), (0.7, 6), (3.0, 2), (50.0, 2), (0.3, 11)])
def test_resample_by_step_keeps_the_ends_and_equal_steps(full, step, samples):
    new = full.resample(step=step)
    assert (new.t[0], new.t[-1], len(new)) == (0.0, 3.0, samples)
    np.testing.assert_allclose(np.diff(new.t), 3.0 / (samples - 1))


def test_densify_keeps_samples_and_bounds_steps(full):
    dense = full.densify(2.5)
    assert len(dense) == 1 + 2 + 5
    assert dense.steps.max() <= 2.5
    np.testing.assert_array_equal(dense.positions[[0, 2, 7]], X)
    np.testing.assert_array_equal(dense.t[[0, 2, 7]], T)
    np.testing.assert_allclose(dense.length, 17.0)
    assert full.densify(12.0) is full


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=6),
    st.floats(1, 1e3),
    st.floats(0, 2e9),
)
def test_densify_is_the_same_motion(xs, max_step, start):
    t = start + np.arange(len(xs))
    trajectory = Trajectory(t, [[x, -x, 0.5 * x] for x in xs])
    dense = trajectory.densify(max_step)
    # Times are rounded, to 2e-7 s near 2e9 s, and positions with them.
    rounding = 2 * np.spacing(t[-1]) * (trajectory.steps / np.diff(t)).max()
    assert dense.steps.max() <= max_step * (1 + 1e-9) + rounding
    assert set(t) <= set(dense.t)
    back = dense.resample(t)
    np.testing.assert_array_equal(back.positions, trajectory.positions)


@pytest.mark.parametrize("max_step", [0.1, 0.25, 1.0, 3.0])
def test_densify_again_changes_nothing(max_step):
    """3 m a step, far from the origin: rounding makes parts of 1 m longer than that."""
    t = 0.1 * np.arange(300)
    along = 30.0 * t[:, None] * np.array([np.cos(0.3), np.sin(0.3), 0.0])
    dense = Trajectory(t, along + np.array([20700.3, 11000.7, 333.1])).densify(max_step)
    assert len(dense) == 1 + 299 * round(3.0 / max_step)
    assert dense.densify(max_step) is dense


def test_subdivide_refuses_what_is_no_division(full):
    for parts in ([1], [1, 0], [2, 2, 2]):
        with pytest.raises(ArgumentError, match=r"parts = .*2 whole numbers >= 1"):
            full.subdivide(parts)


def test_at_constant_speed():
    corners = [[0, 0, 0], [0, 0, 0], [30, 40, 0], [30, 40, 0], [30, 40, 20]]
    trajectory = Trajectory.at_constant_speed(corners, 10.0, name="B")
    np.testing.assert_array_equal(trajectory.t, [0, 5, 7])
    np.testing.assert_array_equal(trajectory.positions, [corners[0], corners[2], corners[4]])
    assert trajectory.name == "B"


def test_at_constant_speed_refuses():
    with pytest.raises(ArgumentError, match="at least two different"):
        Trajectory.at_constant_speed([[1, 2, 3], [1, 2, 3]], 10.0)
    with pytest.raises(ArgumentError, match=r"speed = 0.0"):
        Trajectory.at_constant_speed(X, 0.0)
    with pytest.raises(ArgumentError, match=r"positions.shape = \(2,\)"):
        Trajectory.at_constant_speed([1, 2], 1.0)


@pytest.mark.parametrize(
    ("t", "positions", "options", "words"),
    [
        ([0, 1, 1], X, {}, r"t\[2\] = 1.0: must be greater than the time before it, 1.0"),
        ([0, 2, 1], X, {}, r"t\[2\] = 1.0"),
        ([0, 1, math.nan], X, {}, r"t\[2\] = nan: must be finite"),
        ([0], [[0, 0, 0]], {}, r"t.shape = \(1,\): must be \(n,\), n >= 2"),
        (T, np.zeros((3, 2)), {}, r"positions.shape = \(3, 2\): must be \(3, 3\)"),
        (T, np.zeros((2, 3)), {}, r"positions.shape = \(2, 3\)"),
        (T, [[0, 0, 0], [0, math.inf, 0], [1, 1, 1]], {}, r"positions\[1, 1\] = inf"),
        (T, "abc", {}, "array of real numbers"),
        (T, X, {"velocities": np.zeros((3, 2))}, r"velocities.shape = \(3, 2\)"),
        (T, X, {"orientations": np.zeros((3, 3))}, r"orientations.shape = \(3, 3\)"),
        (
            T,
            X,
            {"orientations": TURN * [[1], [1.00001], [1]]},
            r"orientations\[1\].*norm is 1.00001",
        ),
        (T, X, {"orientations": np.zeros((3, 4))}, r"orientations\[0\]"),
        (T, X, {"controls": np.zeros((4, 2))}, r"controls.shape = \(4, 2\)"),
        (T, X, {"controls": np.zeros((3, 0))}, r"controls.shape = \(3, 0\)"),
        (T, X, {"controls": np.zeros(3)}, r"controls.shape = \(3,\)"),
    ],
)
def test_what_is_refused(t, positions, options, words):
    with pytest.raises(ArgumentError, match=words):
        Trajectory(t, positions, **options)


def test_what_resample_and_densify_refuse(full):
    for arguments in ({}, {"times": [0, 1], "step": 1.0}):
        with pytest.raises(ArgumentError, match="exactly one"):
            full.resample(**arguments)
    with pytest.raises(ArgumentError, match=r"times = '-1.0 to 1.0 s'.*0.0 to 3.0 s"):
        full.resample([-1, 1])
    with pytest.raises(ArgumentError, match="step = -1"):
        full.resample(step=-1)
    with pytest.raises(ArgumentError, match="max_step = nan"):
        full.densify(math.nan)


def test_from_path_asks_the_registered_reader(monkeypatch, full):
    monkeypatch.setattr(module, "_path_reader", None)
    with pytest.raises(ArgumentError, match=r"path = 'dict'.*import ompl_risk.bridge"):
        Trajectory.from_path({})
    calls = []
    register_path_reader(lambda *given: calls.append(given) or full)
    assert Trajectory.from_path("a path", speed=30.0, name="A") is full
    assert calls == [("a path", 30.0, "A")]
