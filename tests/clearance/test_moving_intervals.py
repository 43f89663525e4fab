"""When a place among moving obstacles is free."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from moving_scene import circling, wandering

from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingMesh, MovingSphere
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain


def ball(radius=2.0):
    """Flies along x at 10 m/s from t = 0 to t = 10."""
    return MovingSphere(radius, [0.0, 10.0], [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])


def test_a_ball_passing_by_in_closed_form():
    clearance = MovingClearance(ball(), radius=1.0)
    places = [[50.0, 0.0, 0.0], [50.0, 0.0, 2.4], [50.0, 3.1, 0.0], [0.0, 0.0, 0.0], [100.0, 0, 0]]
    found = clearance.free_intervals(places, 0.0, 20.0, resolution=1e-5)
    half = math.sqrt(9.0 - 2.4**2) / 10.0
    expected = [
        [(0.0, 4.7), (5.3, 20.0)],
        [(0.0, 5.0 - half), (5.0 + half, 20.0)],
        [(0.0, 20.0)],
        [(0.3, 20.0)],
        [(0.0, 9.7)],
    ]
    assert [len(spans) for spans in found] == [len(spans) for spans in expected]
    for spans, true in zip(found, expected, strict=True):
        # Within 1 mm of contact a place counts as blocked: that is 0.2 ms at these angles.
        assert np.ravel(spans) == pytest.approx(np.ravel(true), abs=3e-4)


def test_a_turning_bar_blocks_twice_a_turn():
    bar = circling([20.0, 1.0, 1.0], 2.0, 3)  # three turns of pi seconds
    clearance = MovingClearance(bar)
    spans = clearance.free_intervals([[5.0, 0.0, 0.0]], 0.1, 3.0 * math.pi - 0.2)[0]
    blocked = 0.5 * math.asin(0.5 / 5.0)
    begins = [0.1] + [0.5 * math.pi * k + blocked for k in range(1, 6)]
    ends = [0.5 * math.pi * k - blocked for k in range(1, 6)] + [3.0 * math.pi - 0.2]
    assert [begin for begin, _ in spans] == pytest.approx(begins, abs=2e-3)
    assert [end for _, end in spans] == pytest.approx(ends, abs=2e-3)


def test_for_ever():
    clearance = MovingClearance(ball())
    places = [[50.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 30.0, 0.0]]
    safe = clearance.safe_intervals(places, 5.0, math.inf)
    assert safe.first.tolist() == [0, 1, 2, 3]
    assert safe.begin == pytest.approx([5.2, 5.0, 5.0], abs=2e-3)
    assert safe.end == pytest.approx([math.inf, 9.8, math.inf], abs=2e-3)
    assert clearance.free_intervals([[100.0, 0.0, 0.0]], 50.0, math.inf) == [[]]
    assert clearance.free_intervals([[0.0, 0.0, 0.0]], -9.0, -1.0) == [[]]  # before it leaves


def test_several_obstacles_and_the_ground():
    other = MovingSphere(2.0, [0.0, 10.0], [[50.0, -40.0, 10.0], [50.0, 60.0, 10.0]])
    flat = Terrain(np.zeros((11, 21)), spacing=(10.0, 10.0), origin=(-50.0, -50.0))
    low = MovingSphere(2.0, [0.0, 10.0], [[0.0, 0.0, 10.0], [100.0, 0.0, 10.0]])
    clearance = MovingClearance([low, other], static=TerrainClearance(flat))
    found = clearance.free_intervals([[50.0, 0.0, 10.0], [50.0, 0.0, 0.0]], 0.0, 10.0)
    assert np.ravel(found[0]) == pytest.approx([0.0, 3.8, 4.2, 4.8, 5.2, 10.0], abs=2e-3)
    assert found[1] == []


@given(seed=st.integers(0, 10_000), power=st.floats(-4.0, -1.0))
@settings(max_examples=40, deadline=None)
def test_law_intervals_are_free_and_leave_out_little(seed, power):
    clearance = MovingClearance(wandering(seed, spread=10.0, boxes=3), radius=0.3)
    points = np.random.default_rng(seed).uniform(-10, 10, (8, 3))
    resolution = 10.0**power
    safe = clearance.safe_intervals(points, -1.0, 12.0, resolution=resolution)
    slack = 1e-3 + clearance.speed_bound(-1.0, 12.0) * resolution
    times = np.linspace(-1.0, 12.0, 700)
    for k, spans in enumerate(safe.as_lists()):
        begin, end = np.array(spans).reshape(-1, 2).T
        assert (begin < end).all()
        assert (end[:-1] < begin[1:]).all()
        within = ((begin[:, None] <= times) & (times <= end[:, None])).any(axis=0)
        d = clearance(np.tile(points[k], (len(times), 1)), times)
        assert (d[within] > 0.0).all()
        assert within[d > slack].all()
        stay = np.tile(points[k], (len(begin), 1))
        assert clearance.are_free(stay, begin, stay, end).all()


def test_a_mesh_of_a_box_blocks_as_the_box_does():
    box = wandering(5, spheres=0, boxes=1, spread=6.0)[0]
    mesh = MovingMesh(trimesh.creation.box(box.extents), box.times, box.positions, box.orientations)
    points = np.random.default_rng(5).uniform(-6, 6, (30, 3))
    plain = MovingClearance(box).free_intervals(points, 0.0, math.inf, resolution=1e-4)
    found = MovingClearance(mesh).free_intervals(points, 0.0, math.inf, resolution=1e-4)
    assert sum(len(spans) for spans in plain) > 30
    assert [len(spans) for spans in found] == [len(spans) for spans in plain]
    for spans, true in zip(found, plain, strict=True):
        assert np.ravel(spans) == pytest.approx(np.ravel(true), abs=2e-3)


def test_the_hole_of_a_ring_is_free_while_it_passes():
    ring = trimesh.creation.annulus(r_min=2.0, r_max=3.0, height=1.0, sections=48)
    flight = MovingMesh(ring, [0.0, 10.0], [[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]])
    spans = MovingClearance(flight).free_intervals([[0.0, 0.0, 0.0]], 0.0, math.inf)[0]
    assert np.ravel(spans) == pytest.approx([0.0, 3.5, 4.0, 6.0, 6.5, math.inf], abs=5e-3)
    parked = MovingMesh(ring, [0.0, 1.0], [[-2.5, 0.0, 0.0], [-2.5, 0.0, 0.0]])
    assert MovingClearance(parked).free_intervals([[0.0, 0.0, 0.0]], 0.0, math.inf) == [[]]
    assert MovingClearance(parked).free_intervals([[-2.5, 0.0, 0.0]], 0.0, math.inf) == [
        [(0.0, math.inf)]
    ]


def test_many_short_spans_find_room():
    t = np.arange(401) * 0.5
    there = np.zeros((401, 3))
    there[::2, 0] = 50.0  # in and out 200 times
    shuttle = MovingBox([2.0, 2.0, 2.0], t, there)
    spans = MovingClearance(shuttle).free_intervals([[0.0, 0.0, 0.0]], 0.0, 200.0)[0]
    assert len(spans) == 201
    assert spans[1] == pytest.approx((0.51, 1.49), abs=2e-3)


@pytest.mark.parametrize(
    ("t0", "t1", "resolution", "argument"),
    [
        (0.0, 0.0, 1e-3, "t1"),
        (1.0, 0.0, 1e-3, "t1"),
        (math.inf, math.inf, 1e-3, "t0"),
        (math.nan, 1.0, 1e-3, "t0"),
        (0.0, 1.0, 0.0, "resolution"),
    ],
)
def test_wrong_times(t0, t1, resolution, argument):
    with pytest.raises(ArgumentError) as caught:
        MovingClearance(ball()).free_intervals([[0, 0, 0]], t0, t1, resolution=resolution)
    assert caught.value.argument == argument
