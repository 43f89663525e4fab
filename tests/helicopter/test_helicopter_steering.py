"""The helicopter's steering: vertices, ways between them as users see them, and its duties."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ompl_risk as risk
from ompl_risk import terrains
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.helicopter.trims import Trim
from ompl_risk.motion import Risk

STEERING = HelicopterSteering()
LIBRARY = default_library()


def random_vertices(n, seed, span=600.0):
    rng = np.random.default_rng(seed)
    low, high = np.array([2000.0, -3000.0, 200.0]), np.array([span, span, 50.0])
    indices = rng.integers(0, len(LIBRARY.speeds), n)
    return np.column_stack([low + rng.random((n, 3)) * high, rng.uniform(-9, 9, n), indices])


def test_every_point_becomes_a_vertex_at_each_speed():
    low, high = np.array([0.0, 100.0, 50.0]), np.array([10.0, 300.0, 60.0])
    unit = np.array([[0.0, 0.5, 0.25, 0.75], [0.5, 0.0, 0.0, 0.0]])
    found = HelicopterSteering(cruise=(10.0, 20.0, 30.0)).vertices(unit, low, high)
    assert found.shape == (6, STEERING.width)
    np.testing.assert_allclose(found[:3, :4], [[0.0, 200.0, 52.5, 1.5 * math.pi]] * 3)
    np.testing.assert_allclose(found[3:, :4], [[5.0, 100.0, 50.0, 0.0]] * 3)
    assert sorted(LIBRARY.speeds[found[:3, 4].astype(int)]) == [10.0, 20.0, 30.0]
    one = HelicopterSteering(speeds=(30.0,)).vertices(unit, low, high)
    assert one[:, 4].tolist() == [3.0, 3.0]
    assert HelicopterSteering(cruise=(20.0,)).vertices(unit, low, high)[:, 4].tolist() == [2.0, 2.0]


def test_places_weigh_heights_and_headings():
    steering = HelicopterSteering(height_weight=7.0, reach=100.0)
    a, b = np.array([10.0, 20.0, 30.0, 0.4, 1.0]), np.array([13.0, 24.0, 32.0, 0.41, 2.0])
    p, q = steering.places(np.stack([a, b]))
    assert np.linalg.norm(q - p) == pytest.approx(math.sqrt(25.0 + 14.0**2 + 1.0), rel=1e-6)
    turned = np.stack([a, np.add(a, [0.0, 0.0, 0.0, 2.0 * math.pi, 0.0])])
    np.testing.assert_allclose(*steering.places(turned), atol=1e-9)


@given(
    st.tuples(*[st.floats(-1e4, 1e4)] * 3), st.floats(-20.0, 20.0), st.integers(0, 3), st.booleans()
)
@settings(deadline=None)
def test_a_vertex_and_its_state_stand_for_each_other(position, heading, index, negated):
    speed = float(LIBRARY.speeds[index])
    vertex = STEERING.vertex_at(position, heading, speed=speed)
    state = STEERING.state(vertex)
    assert state.shape == (STEERING.state_width,)
    if negated:
        state[3:7] *= -1.0
    found = STEERING.vertex(state)
    np.testing.assert_array_equal(found[:3], position)
    assert abs(math.remainder(found[3] - heading, 2.0 * math.pi)) < 1e-9
    assert -math.pi <= found[3] <= math.pi
    assert found[4] == index


def test_ways_begin_and_end_in_the_states_of_their_vertices():
    a, b = random_vertices(60, 1), random_vertices(60, 2)
    durations = STEERING.durations(a, b)
    assert np.isfinite(durations).sum() > 50
    for p, q, duration in zip(a, b, durations, strict=True):
        way = STEERING.connect(p, q)
        assert way.exists == math.isfinite(duration)
        assert way.duration == duration
        if not way.exists:
            continue
        times, states = way.samples(0.2)
        np.testing.assert_allclose(np.diff(times[:-1]), 0.2)
        assert times[0] == 0.0
        assert times[-1] == duration
        ends = [STEERING.state(p), STEERING.state(q)]
        for state, wanted in zip(states[[0, -1]], ends, strict=True):
            if state[3:7] @ wanted[3:7] < 0.0:
                state[3:7] *= -1.0
            np.testing.assert_allclose(state, wanted, rtol=0.0, atol=1e-8)
        assert np.linalg.norm(states[:, 7:10], axis=1).max() <= STEERING.speed
        chords = np.linalg.norm(np.diff(states[:, :3], axis=0), axis=1)
        assert (chords <= STEERING.speed * np.diff(times) + 1e-9).all()


@pytest.mark.parametrize("cruise", [(10.0,), (10.0, 20.0)])
def test_slower_cruise_speeds_keep_their_limit(cruise):
    steering = HelicopterSteering(cruise=cruise)
    a = steering.vertex_at((0.0, 0.0, 100.0), 0.0, speed=max(cruise))
    b = steering.vertex_at((500.0, 80.0, 160.0), 1.0, speed=0.0)
    states = steering.connect(a, b).samples(0.02).states
    assert np.linalg.norm(states[:, 7:10], axis=1).max() == pytest.approx(max(cruise), abs=1.5)
    trims = [leg.motion for leg in steering.connect(a, b).legs if isinstance(leg.motion, Trim)]
    assert {trim.speed for trim in trims} <= {0.0, *cruise}
    assert steering.connect(a, b).duration > STEERING.connect(a, b).duration


def test_a_way_can_be_read():
    a = STEERING.vertex_at((0.0, 0.0, 100.0), 0.0, speed=0.0)
    b = STEERING.vertex_at((600.0, 0.0, 104.0), 0.0, speed=30.0)
    way = STEERING.connect(a, b)
    lines = str(way).splitlines()
    assert len(lines) == 1 + len(way.legs) == 1 + len(way.pieces)
    assert "change to 30 m/s for" in lines[1]
    assert "hold 30 m/s, climb 2 m/s for" in lines[3]
    assert repr(way) == f"PrimitivePath({len(way.pieces)} pieces, {way.duration:.6g} s)"
    with pytest.raises(ValueError, match="read-only"):
        way.pieces[0, 0] = 1.0


def test_no_way_and_nothing_to_fly_are_ways_too():
    a = STEERING.vertex_at((0.0, 0.0, 100.0), 0.0, speed=30.0)
    none = STEERING.connect(a, STEERING.vertex_at((50.0, 0.0, 400.0), 0.0, speed=30.0))
    assert not none.exists
    assert none.duration == math.inf
    assert str(none) == "no way"
    assert none.samples().states.shape == (0, 13)
    assert none.legs == ()
    still = STEERING.connect(a, a)
    assert still.exists
    assert still.duration == 0.0
    assert still.legs == ()
    np.testing.assert_allclose(still.samples().states, STEERING.state(a)[None])


def test_a_flight_leads_along_a_chain_of_vertices():
    chain = np.stack(
        [
            STEERING.vertex_at((0.0, 0.0, 100.0), 0.0, speed=0.0),
            STEERING.vertex_at((500.0, 100.0, 120.0), 1.0, speed=20.0),
            STEERING.vertex_at((700.0, 600.0, 120.0), 2.0, speed=30.0),
        ]
    )
    flight = STEERING.flight(chain)
    np.testing.assert_allclose(flight.states[0], STEERING.state(chain[0]), atol=1e-12)
    np.testing.assert_allclose(flight.goal[:3], chain[-1, :3], atol=1e-6)
    planned = sum(STEERING.connect(a, b).duration for a, b in pairwise(chain))
    assert flight.duration == pytest.approx(planned, abs=0.2)


def test_the_batch_answers_with_the_same_durations():
    heights = np.zeros((50, 50))
    terrain = terrains.Terrain(heights, spacing=(100.0, 100.0), origin=(0.0, -4000.0))
    clearance = risk.TerrainClearance(terrain, radius=1.0)
    batch = STEERING.batch(clearance, Risk(speed=STEERING.speed), threads=1)
    a, b = random_vertices(50, 3), random_vertices(50, 4)
    durations = STEERING.durations(a, b)
    np.testing.assert_array_equal(batch.durations(a, b), durations)
    assert (batch.least_durations(a, b) <= durations).all()


def changed(place, value, speed=20.0):
    """A state of level flight, one number of which is changed."""
    state = STEERING.state(STEERING.vertex_at((0.0, 0.0, 100.0), 0.5, speed=speed))
    state[place] = value
    return state


def turned_over():
    state = changed(0, 0.0)
    state[3:7] = [1.0, 0.0, 0.0, 0.0]
    return state


A = STEERING.vertex_at((0.0, 0.0, 100.0), 0.0, speed=30.0)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: STEERING.vertex(changed(7, 36.0)), r"speed of state .*36.*at most limits.speed"),
        (lambda: STEERING.vertex(changed(7, 15.0)), r"15.0: must be one of 0, 10, 20, 30 m/s"),
        (lambda: STEERING.vertex(changed(12, 0.3)), r"yaw rate .* of state = 0.3: must be 0"),
        (lambda: STEERING.vertex(changed(9, 2e-6)), "upward speed .* of state = 2e-06"),
        (lambda: STEERING.vertex(changed(3, 0.5)), r"norm of state\[3:7\]"),
        (lambda: STEERING.vertex(turned_over()), "quaternion . of state"),
        (lambda: STEERING.vertex(changed(0, math.nan)), r"state\[0\]"),
        (lambda: STEERING.vertex(np.zeros(12)), r"state.shape = \(12,\)"),
        (lambda: STEERING.vertex_at((0, 0, 0), 0.0, speed=15.0), "speed = 15.0: must be one of"),
        (lambda: STEERING.vertex_at((0, 0, 0), math.inf, speed=10.0), "heading = inf"),
        (lambda: STEERING.vertex_at((0, 0), 0.0, speed=10.0), r"position.shape = \(2,\)"),
        (lambda: STEERING.state(np.array([0, 0, 0, 0, 4.0])), r"vertex\[4\] = 4.0.*0 to 3"),
        (lambda: STEERING.connect(A, [0, 0, 0, 0, 0.5]), r"b\[4\] = 0.5"),
        (lambda: STEERING.connect(A[:4], A), r"a.shape = \(4,\)"),
        (lambda: STEERING.connect(A, [0, 0, math.inf, 0, 0]), r"b\[2\] = inf"),
        (lambda: STEERING.durations([A], [A, A]), r"len\(b\) = 2: must be 1"),
        (lambda: STEERING.durations([A], [np.add(A, [0, 0, 0, 0, 1])]), r"b\[0, 4\] = 4.0"),
        (lambda: STEERING.connect(A, A).samples(0.0), "step = 0.0"),
        (lambda: STEERING.flight(np.stack([A])), r"len\(vertices\) = 1: must be 2"),
        (
            lambda: STEERING.flight(np.stack([A, np.add(A, [9, 0, 300, 0, 0])])),
            r"vertices\[1\] = .*a way from vertices\[0\]",
        ),
        (lambda: HelicopterSteering(speeds=()), "speeds"),
        (lambda: HelicopterSteering(speeds=(10.0, 12.0)), r"speeds\[1\] = 12.0: must be one of 0,"),
        (lambda: HelicopterSteering(cruise=(12.0,)), r"cruise\[0\] = 12.0: must be one of 10,"),
        (lambda: HelicopterSteering(longest_ratio=0.5), "longest_ratio = 0.5"),
        (lambda: HelicopterSteering(height_weight=0.0), "height_weight = 0.0"),
        (lambda: HelicopterSteering(reach=-1.0), "reach = -1.0"),
        (lambda: HelicopterSteering("xcell60.npz"), "library = 'xcell60.npz'"),  # pyright: ignore
    ],
)
def test_errors_name_what_is_wrong_with_a_vertex_or_an_option(call, message):
    with pytest.raises(ArgumentError, match=message):
        call()


def test_hover_at_the_goal_puts_right_what_is_left():
    chain = [
        HelicopterSteering().vertex_at((0.0, 0.0, 100.0), 0.0, speed=0.0),
        HelicopterSteering().vertex_at((90.0, 25.0, 101.0), 1.0, speed=0.0),
    ]
    plain = HelicopterSteering().flight(np.array(chain))
    settled = HelicopterSteering(hover=8.0).flight(np.array(chain))
    assert plain.at_goal.distance > 1e-3
    assert settled.at_goal.distance < 1e-9
    assert settled.duration == pytest.approx(plain.duration + 8.0, abs=0.05)


@pytest.mark.parametrize("hover", [-1.0, float("inf"), float("nan"), "long"])
def test_an_impossible_hover_is_named(hover):
    with pytest.raises(ArgumentError, match="hover"):
        HelicopterSteering(hover=hover)
