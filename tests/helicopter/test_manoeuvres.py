import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from small_library import GRID, X_CELL, grid_with, left_turn, library, lifting

from ompl_risk._kernels import rigid_body
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.library import PrimitiveLibrary, default_library
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT, mirrored_controls, mirrored_states, replay
from ompl_risk.helicopter.trims import solve_trim


def test_climb_at_constant_acceleration():
    made = library(lifting(10.0, 0.0, 2.0)).manoeuvres[0]
    assert made.duration == pytest.approx(3.2)
    np.testing.assert_allclose(made.displacement, [32.0, 0.0, 3.2, 0.0], atol=1e-12)
    assert made.fastest == pytest.approx(math.hypot(10.0, 2.0))
    t = np.arange(161) * DT
    wanted = np.stack([10 * t, 0 * t, 0.3125 * t * t, 0 * t], axis=1)
    np.testing.assert_allclose(made.track, wanted, atol=1e-12)
    assert made.controls.shape == (160, 4)
    assert made.states.shape == (161, 13)


def test_headings_are_unwrapped_along_the_track():
    hover = solve_trim(X_CELL, 0.0, turn=0.8)
    spun = replay(X_CELL, hover, hover, [hover.control] * 1000)
    np.testing.assert_allclose(spun.track[:, 3], 0.8 * DT * np.arange(1001), atol=1e-8)
    assert spun.displacement[3] == pytest.approx(16.0)


def test_a_spinning_hover_stays_where_it_is():
    """Stages of a spin are of another norm than 1; gravity must not be scaled with them."""
    hover = solve_trim(X_CELL, 0.0, turn=0.8)
    spun = replay(X_CELL, hover, hover, [hover.control] * 1000)
    assert spun.miss <= 1e-12
    np.testing.assert_allclose(spun.states[:, [0, 1, 2, 7, 8, 9, 10, 11]], 0.0, atol=1e-12)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 71), *[st.floats(-100.0, 100.0)] * 3, st.floats(-6.0, 6.0))
def test_flown_elsewhere_it_ends_at_the_displacement(number, x, y, z, heading):
    m = default_library().manoeuvres[number]
    states = np.empty_like(m.states)
    start = m.first.state([x, y, z], heading)
    rigid_body.rollout(start, m.controls, DT, X_CELL.given, states)
    dx, dy, dz, turned = m.displacement
    along = (dx + 1j * dy) * np.exp(1j * heading)
    wanted = m.last.state([x + along.real, y + along.imag, z + dz], heading + turned)
    wanted[3:7] *= np.sign(wanted[3:7] @ states[-1, 3:7])
    np.testing.assert_allclose(states[-1], wanted, rtol=0, atol=1e-9)


def turned(state, heading):
    """A state with the world about it turned about the vertical."""
    turn = Rotation.from_euler("z", heading)
    attitude = (turn * Rotation.from_quat(state[3:7])).as_quat()
    return np.concatenate([turn.apply(state[:3]), attitude, state[7:]])


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 2**32 - 1), st.floats(-math.pi, math.pi), st.sampled_from([DT, 0.1]))
def test_a_step_commutes_with_a_turn_of_the_world_about_the_vertical(seed, heading, dt):
    rng = np.random.default_rng(seed)
    state = rng.normal(size=13) * ([5.0] * 3 + [1.0] * 4 + [15.0] * 3 + [2.0] * 3)
    state[3:7] /= np.linalg.norm(state[3:7])
    control = rng.normal(size=4) * [20.0, 2.0, 0.1, 0.1] + [80.0, 0.0, 0.0, 0.0]
    wind, drag = rng.normal(size=3) * 4.0, rng.uniform(size=3)
    there = Rotation.from_euler("z", heading).apply(wind)
    before, after = np.empty(13), np.empty(13)
    rigid_body.propagate(state, control, dt, Helicopter(drag=drag, wind=wind).given, before)
    windy = Helicopter(drag=drag, wind=there)
    rigid_body.propagate(turned(state, heading), control, dt, windy.given, after)
    wanted = turned(before, heading)
    wanted[3:7] *= np.sign(wanted[3:7] @ after[3:7])
    np.testing.assert_allclose(after, wanted, rtol=0, atol=1e-12)


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_replay_of_mirrored_inputs_is_the_mirror_image(seed):
    rng = np.random.default_rng(seed)
    start = rng.normal(size=13)
    start[3:7] /= np.linalg.norm(start[3:7])
    controls = rng.normal(size=(30, 4)) * [20.0, 2.0, 0.1, 0.1] + [80.0, 0.0, 0.0, 0.0]
    here, there = np.empty((31, 13)), np.empty((31, 13))
    rigid_body.rollout(start, controls, DT, X_CELL.given, here)
    rigid_body.rollout(mirrored_states(start), mirrored_controls(controls), DT, X_CELL.given, there)
    np.testing.assert_array_equal(there, mirrored_states(here))
    reflect = np.diag([1.0, -1.0, 1.0])
    R, mirrored = (Rotation.from_quat(s[-1, 3:7]).as_matrix() for s in (here, there))
    np.testing.assert_allclose(mirrored, reflect @ R @ reflect, atol=1e-14)
    np.testing.assert_array_equal(there[:, :3], here[:, :3] @ reflect)
    np.testing.assert_array_equal(there[:, 7:10], here[:, 7:10] @ reflect)
    np.testing.assert_array_equal(there[:, 10:], -here[:, 10:] @ reflect)


def test_a_manoeuvre_that_misses_is_refused_and_says_by_how_much():
    first, last, controls = left_turn(default_library())
    grid = grid_with(last.turn)
    assert len(library((first, last, controls), **grid).manoeuvres) == 2
    touched = controls.copy()
    touched[3, 3] += 1e-6
    miss = replay(X_CELL, solve_trim(X_CELL, *first), solve_trim(X_CELL, *last), touched).miss
    assert 1e-8 < miss < 1e-3
    with pytest.raises(ArgumentError) as caught:
        library(lifting(10.0, 0.0, 2.0), (first, last, touched), **grid)
    assert caught.value.value == miss
    assert "end of manoeuvre 1, (10 m/s, climb 0 m/s, turn 0 rad/s) to" in caught.value.argument
    assert caught.value.allowed.startswith("within 1e-09 of its last trim")


@pytest.mark.parametrize("part", [3, 7, 10], ids=["attitude", "velocity", "rates"])
def test_miss_is_the_greatest_difference(part):
    trim = solve_trim(X_CELL, 10.0, turn=0.3)
    flown = replay(X_CELL, trim, trim, [trim.control] * 5)
    assert flown.miss < 1e-11
    states = flown.states.copy()
    states[-1, 3:7] *= -1.0  # the same attitude
    states[-1, part] += 1e-4 * (1.0 if part > 3 else 1e-2)
    moved = type(flown)(0, trim, trim, flown.controls, states, DT)
    assert moved.miss == pytest.approx(1e-4 * (1.0 if part > 3 else 1e-2), rel=0.02)


OVERSHOT = (
    (10.0, 0.0, 0.0),
    (10.0, 2.0, 0.0),
    [[X_CELL.weight + 4.1, 0.0, 0.0, 0.0]] * 240 + [[X_CELL.weight - 4.1, 0.0, 0.0, 0.0]] * 40,
)
"""Climbs at 2.4 m/s before it climbs at 2 m/s."""


@pytest.mark.parametrize(
    ("limits", "manoeuvre", "named"),
    [
        (
            Limits(lift=(0.2, 1.05)),
            lifting(10.0, 0.0, 2.0),
            r"^collective at step 0 of manoeuvre 0, .* = 85\.567: must be 16\.0884 to 84\.4641 N$",
        ),
        (
            Limits(speed=10.2),
            OVERSHOT,
            r"^speed at step 240 of manoeuvre 0, .* = 10\.28\d+: must be 0 to 10\.2 m/s$",
        ),
        (
            Limits(lift_rate=3.0),
            lifting(10.0, 0.0, 2.0),
            r"^change of the collective at step 0.* = 256\.25.* -241\.326 to 241\.326 N/s$",
        ),
    ],
    ids=["collective", "speed", "change"],
)
def test_a_manoeuvre_that_breaks_a_limit_is_refused(limits, manoeuvre, named):
    with pytest.raises(ArgumentError, match=named):
        PrimitiveLibrary(X_CELL, limits, manoeuvres=[manoeuvre], **GRID)


@pytest.mark.parametrize(
    ("place", "value", "name"),
    [(10, -2.1, "angular velocity"), (3, 0.6, "attitude"), (4, -0.6, "attitude")],
)
def test_limits_of_rate_and_attitude_within_a_manoeuvre(place, value, name):
    hover = solve_trim(X_CELL, 0.0)
    flown = replay(X_CELL, hover, hover, [hover.control] * 5)
    states = flown.states.copy()
    states[2, place] = value
    states[2, 3:7] /= np.linalg.norm(states[2, 3:7])
    broken = type(flown)(0, hover, hover, flown.controls, states, DT).broken_limit(
        X_CELL, Limits(attitude=1.0)
    )
    assert broken is not None
    assert (broken.name, broken.step) == (name, 2)
    assert flown.broken_limit(X_CELL, Limits()) is None


def test_changes_of_inputs_count_from_and_to_the_trims():
    rate = Limits(lift_rate=1.0)
    controls = [[X_CELL.weight * 1.1, 0, 0, 0]] * 10
    hover = solve_trim(X_CELL, 0.0)
    rising = solve_trim(X_CELL, 0.0, 0.981 * 10 * DT)
    held = replay(X_CELL, hover, rising, controls)
    broken = held.broken_limit(X_CELL, rate)
    assert held.miss < 1e-12
    assert broken is not None
    assert (broken.name, broken.step) == ("change of the collective", 0)
    assert broken.value == pytest.approx(0.1 * X_CELL.weight / DT)
    assert held.broken_limit(X_CELL, Limits(lift_rate=5.0)) is None


@pytest.mark.parametrize(
    ("controls", "named"),
    [
        (np.empty((0, 4)), r"controls\.shape = \(0, 4\).*n >= 1"),
        ([[80.0, 0.0, 0.0]], r"controls\.shape = \(1, 3\)"),
        ([[80.0, 0.0, 0.0, math.nan]], r"controls\[0, 3\] = nan: must be finite"),
        ("up", "controls = 'up'"),
    ],
)
def test_wrong_controls(controls, named):
    with pytest.raises(ArgumentError, match=named):
        library(((0.0, 0.0, 0.0), (0.0, 2.0, 0.0), controls))


def test_manoeuvres_are_read_only():
    made = library(lifting(0.0, 0.0, 2.0)).manoeuvres[0]
    for name in ("controls", "states", "track", "displacement"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(made, name)[0] = 1.0
