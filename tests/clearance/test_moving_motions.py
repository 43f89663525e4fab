"""Straight timed motions among moving obstacles, certified between the samples."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st
from moving_scene import along, circling, motions, wandering

from ompl_risk.clearance import MeshClearance, TerrainClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingMesh, MovingSphere
from ompl_risk.clearance.moving.search import TimedMotions
from ompl_risk.clearance.moving.travel import Travel, lowest
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain

FINE = np.linspace(0.0, 1.0, 2001)


def ball(radius=2.0):
    """Flies along x at 10 m/s from t = 0 to t = 10."""
    return MovingSphere(radius, [0.0, 10.0], [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])


def test_a_ball_passing_by_in_closed_form():
    clearance = MovingClearance(ball(), radius=1.0)
    a, b = np.array([[60.0, -50.0, 3.0]]), np.array([[60.0, 50.0, 3.0]])
    # Relative position (60 - 10 t, -50 + 10 t, 3): least where 60 - 10 t = -50 + 10 t.
    d, t = clearance.approach(a, 0.0, b, 10.0, tolerance=1e-9)
    assert d == pytest.approx([math.sqrt(50.0 + 9.0) - 3.0], abs=1e-9)
    assert t == pytest.approx([5.5], abs=1e-3)
    assert clearance.least_between(a, 0.0, b, 10.0, tolerance=1e-9) == pytest.approx(d, abs=0)


def test_head_on_in_step_and_at_rest():
    clearance = MovingClearance(ball())
    a = np.array([[100.0, 0.0, 0.0], [0.0, 5.0, 0.0], [40.0, 7.0, 0.0], [40.0, 7.0, 0.0]])
    b = np.array([[0.0, 0.0, 0.0], [100.0, 5.0, 0.0], [40.0, 7.0, 0.0], [40.0, 7.0, 0.0]])
    d, t = clearance.approach(a, [0, 0, 0, 8], b, [10, 10, 10, 8], tolerance=1e-6)
    assert d == pytest.approx([-2.0, 3.0, 5.0, math.hypot(40, 7) - 2.0], abs=1e-6)
    assert t[[0, 2, 3]] == pytest.approx([5.0, 4.0, 8.0], abs=2e-3)


@pytest.mark.parametrize("seed", range(4))
def test_tumbling_boxes_against_brute_force_over_dense_times(seed):
    clearance = MovingClearance(wandering(seed, spheres=1, boxes=3), radius=0.2)
    a, ta, b, tb = motions(seed, 25)
    found, when = clearance.approach(a, ta, b, tb, tolerance=1e-4)
    for k in range(len(a)):
        points, times = along(a[k], ta[k], b[k], tb[k], FINE)
        d = clearance(points, times)
        way = np.linalg.norm(b[k] - a[k]) + clearance.speed_bound(ta[k], tb[k]) * (tb[k] - ta[k])
        assert found[k] <= d.min() + 1e-4
        assert found[k] >= d.min() - way / (2 * (len(FINE) - 1))
        share = (when[k] - ta[k]) / (tb[k] - ta[k])
        there = clearance(a[k : k + 1] + share * (b[k] - a[k]), when[k])
        assert there == pytest.approx([found[k]], abs=1e-9)


@given(seed=st.integers(0, 10_000), power=st.floats(-4.0, 1.0))
@settings(max_examples=60, deadline=None)
@example(seed=100, power=0.0)  # the first obstacle leaves a threshold below 0 to the second
def test_law_the_least_distance_is_too_great_by_the_tolerance_at_most(seed, power):
    clearance = MovingClearance(wandering(seed, samples=4))
    a, ta, b, tb = motions(seed, 6)
    found = clearance.least_between(a, ta, b, tb, tolerance=10.0**power)
    fine = clearance.least_between(a, ta, b, tb, tolerance=1e-7)
    assert (found >= fine - 1e-7).all()
    assert (found <= fine + 10.0**power).all()


@pytest.mark.parametrize("kind", ["box", "mesh"])
def test_box_that_spins_fast_and_far_out_is_followed(kind):
    # 40 rad/s: the tip passes the point once in 79 ms, and it is there for half a millisecond.
    bar = circling([20.0, 0.2, 0.2], 40.0, 10)
    if kind == "mesh":
        mesh = trimesh.creation.box(bar.extents)
        bar = MovingMesh(mesh, bar.times, bar.positions, bar.orientations)
    clearance = MovingClearance(bar)
    p, phase = np.array([[9.9 * math.cos(1.0), 9.9 * math.sin(1.0), 0.0]]), 1.0 / 40.0
    d, t = clearance.approach(p, 0.0, p, 0.06, tolerance=1e-6)
    assert d == pytest.approx([-0.1], abs=1e-6)
    assert t == pytest.approx([phase], abs=1e-4)
    assert not clearance.are_free(p, 0.0, p, 0.06)[0]
    assert clearance.are_free(p, phase + 0.01, p, phase + 0.06)[0]


@pytest.mark.parametrize("kind", ["ball", "box", "mesh"])
def test_a_fast_small_obstacle_between_the_samples_is_caught(kind):
    # 1,000 m/s and 10 cm: it is near the hovering vehicle for a tenth of a millisecond.
    t, p = [0.0, 10.0], [[-5000.0, 0.0, 0.0], [5000.0, 0.0, 0.0]]
    obstacle = {
        "ball": lambda: MovingSphere(0.05, t, p),
        "box": lambda: MovingBox([0.1, 0.1, 0.1], t, p),
        "mesh": lambda: MovingMesh(trimesh.creation.box((0.1, 0.1, 0.1)), t, p),
    }[kind]()
    clearance, hover = MovingClearance(obstacle), np.array([[123.4, 0.0, 0.0], [123.4, 0.1, 0.0]])
    assert clearance(hover, 0.0).min() > 5000.0
    assert clearance.are_free(hover, 0.0, hover, 10.0).tolist() == [False, True]
    d, when = clearance.approach(hover, 0.0, hover, 10.0, tolerance=1e-4)
    assert d == pytest.approx([-0.05, 0.05], abs=1e-4)
    assert when == pytest.approx(5.1234, abs=2e-4)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_law_free_motions_are_free_and_clear_ones_are_called_so(seed):
    clearance = MovingClearance(wandering(seed), radius=0.5)
    a, ta, b, tb = motions(seed, 20)
    free, least = clearance.are_free(a, ta, b, tb), clearance.least_between(a, ta, b, tb)
    for k in np.flatnonzero(free):
        assert clearance(*along(a[k], ta[k], b[k], tb[k], FINE[::10])).min() > 0.0
    assert free[least > 0.011].all()
    assert not free[least <= 0.0].any()


@pytest.mark.parametrize("gap", [-1e-3, 1e-6, 1.1e-3, 5e-3])
def test_freedom_is_decided_within_a_millimetre_of_contact(gap):
    clearance = MovingClearance([ball(), circling([1.0, 1.0, 1.0], 1.0, 3, (50.0, 99.0, 0.0))])
    hover = np.array([[50.0, 2.0 + gap, 0.0]])
    free = clearance.are_free(hover, 0.0, hover, 10.0)[0]
    assert free == (gap > 1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_meshes_of_boxes_are_as_free_as_the_boxes(seed):
    boxes = wandering(seed, spheres=0, boxes=2, samples=3)
    meshes = [
        MovingMesh(trimesh.creation.box(b.extents), b.times, b.positions, b.orientations)
        for b in boxes
    ]
    a, ta, b, tb = motions(seed, 12)
    plain, mixed = MovingClearance(boxes), MovingClearance([meshes[0], boxes[1], meshes[1]])
    exact = plain.least_between(a, ta, b, tb, tolerance=1e-6)
    found = mixed.least_between(a, ta, b, tb, tolerance=0.05)
    assert (found >= exact - 1e-6).all()
    assert (found <= exact + 0.05 + 1e-6).all()
    clear = np.abs(exact) > 2e-3
    same = mixed.are_free(a, ta, b, tb) == plain.are_free(a, ta, b, tb)
    assert same[clear].all()


def test_flying_through_a_ring_that_moves_and_turns():
    ring = trimesh.creation.annulus(r_min=2.0, r_max=3.0, height=0.5, sections=48)
    quarter = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)]]
    flight = MovingMesh(ring, [0.0, 10.0], [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]], quarter)
    clearance = MovingClearance(flight, radius=1.0)
    a = np.array([[10.0, 0.0, -10.0], [8.0, 0.0, -10.0]])
    b = np.array([[10.0, 0.0, 10.0], [8.0, 0.0, 10.0]])
    assert clearance.are_free(a, 4.5, b, 5.5).tolist() == [True, False]
    d = clearance.least_between(a[:1], 4.5, b[:1], 5.5, tolerance=1e-3)
    points, times = along(a[0], 4.5, b[0], 5.5, FINE)
    assert d == pytest.approx([clearance(points, times).min()], abs=1e-2)


def test_what_stands_still_is_checked_by_terrain_meshes_and_plain_functions_alike():
    flat = Terrain(np.zeros((5, 21)), spacing=(10.0, 10.0), origin=(-100.0, -20.0))
    block = trimesh.creation.box((200.0, 40.0, 10.0))
    block.apply_translation((0.0, 0.0, -5.0))
    far = MovingSphere(1.0, [0.0, 1.0], [[0.0, 0.0, 500.0], [0.0, 0.0, 600.0]])
    a = np.array([[-50.0, 0.0, 1.0], [-50.0, 0.0, 5.0], [-50.0, 0.0, 30.0], [0.0, 0.0, -2.0]])
    b = np.array([[50.0, 0.0, 40.0], [50.0, 0.0, 2.0005], [50.0, 3.0, 4.0], [0.0, 0.0, 50.0]])
    statics = (
        TerrainClearance(flat, radius=2.0),
        MeshClearance(block, radius=2.0),
        lambda points: points[:, 2] - 2.0,
    )
    for static in statics:
        clearance = MovingClearance(far, static=static, radius=2.0)
        assert clearance.are_free(a, 0.0, b, 9.0).tolist() == [False, False, True, False]
        d, t = clearance.approach(a, 0.0, b, 9.0, tolerance=1e-3)
        assert d == pytest.approx([-1.0, 0.0005, 2.0, -4.0], abs=1e-3)
        assert t == pytest.approx([0.0, 9.0, 9.0, 0.0], abs=0.1)


@given(
    share=st.floats(-0.2, 1.2),
    aside=st.floats(0.0, 30.0),
    tolerance=st.floats(1e-4, 20.0),
    kind=st.sampled_from(["static", "mesh"]),
)
@settings(max_examples=100, deadline=None)
def test_law_tolerance_of_what_is_asked_from_python(share, aside, tolerance, kind):
    """The least distance from a point, or from a small octahedron on its way, to a straight way."""
    a, b = np.array([[0.0, 0.0, 0.0]]), np.array([[40.0, 0.0, 0.0]])
    centre, far = np.array([40.0 * share, aside, 0.0]), [[0.0, 0.0, 500.0], [0.0, 0.0, 600.0]]
    true = math.hypot(40.0 * (np.clip(share, 0.0, 1.0) - share), aside)
    if kind == "static":
        mover = MovingSphere(1.0, [0.0, 1.0], far)
        clearance = MovingClearance(
            mover, static=lambda points: np.linalg.norm(points - centre, axis=1)
        )
        found = clearance.least_between(a, 0.0, b, 7.0, tolerance=tolerance)[0]
    else:  # the same in the frame of the point: it moves and the vehicle waits
        tiny = trimesh.creation.icosphere(subdivisions=0, radius=1e-6)
        mover = MovingMesh(tiny, [0.0, 7.0], [centre, centre - b[0]])
        found = MovingClearance(mover).least_between(a, 0.0, a, 7.0, tolerance=tolerance)[0]
    assert true - 1e-5 <= found <= true + tolerance + 1e-5


def test_level_flight_over_flat_ground_takes_few_queries():
    asked = 0

    def ground(points):
        nonlocal asked
        asked += len(points)
        return points[:, 2]

    far = MovingSphere(1.0, [0.0, 1.0], [[0.0, 0.0, 500.0], [0.0, 0.0, 600.0]])
    clearance = MovingClearance(far, static=ground)
    a, b = np.array([[0.0, 0.0, 50.0]]), np.array([[1000.0, 0.0, 50.0]])
    assert clearance.least_between(a, 0.0, b, 30.0, tolerance=0.01) == pytest.approx([50.0])
    assert asked < 1000  # by Lipschitz bounds alone 50,000


@given(seed=st.integers(0, 100_000), bent=st.booleans(), turning=st.floats(0.0, 1.0))
@settings(max_examples=150, deadline=None)
def test_law_of_two_empty_balls(seed, bent, turning):
    """No obstacle, wherever it is and however it shifts, comes nearer than the bound."""
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(3, 3)) * 10.0 ** rng.uniform(-1, 0.5)
    if not bent:
        corners[1] = 0.5 * (corners[0] + corners[2])
    obstacles = rng.normal(size=(5, 3)) * 2.0
    shifts = turning * rng.uniform(0, 1, 41)[:, None] * np.array([0.0, 0.6, 0.8])
    shifts[0], shifts[-1] = 0.0, turning * np.array([0.0, 0.6, 0.8])
    path = np.array([np.interp(np.linspace(0, 2, 41), [0, 1, 2], c) for c in corners.T]).T
    gaps = path[:, None] - (obstacles + shifts[:, None])
    d = np.linalg.norm(gaps, axis=2).min(axis=1)
    length = np.linalg.norm(np.diff(corners, axis=0), axis=1).sum()
    chord = np.linalg.norm(corners[2] - corners[0])
    travel = Travel(*(np.array([value]) for value in (length, chord, turning)))
    assert lowest(d[:1], d[-1:], travel)[0] <= d.min() + 1e-9


def test_two_empty_balls_in_closed_form():
    zero = np.zeros(4)
    c = np.array([6.0, 5.0, 8.0, 0.0])
    bound = lowest(
        np.array([5.0, 5.0, 3.0, 2.0]), np.array([5.0, 9.0, 3.0, 2.0]), Travel(c, c, zero)
    )
    assert bound == pytest.approx([4.0, 5.0, -1.0, 2.0])


def test_relative_travel_in_closed_form():
    near = MovingClearance(ball())
    a, b = np.array([[0.0, 5.0, 0.0], [0.0, 5.0, 0.0]]), np.array([[100.0, 5.0, 0.0], [0, 5.0, 0]])
    assert near.travels(a, 0.0, b, 10.0) == pytest.approx([0.0, 100.0])
    assert near.travels(a, 0.0, b, 10.0, far=2.9) == pytest.approx([0.0, 0.0])
    still = MovingClearance(ball(), static=lambda points: points[:, 2] + 50.0)
    assert still.travels(a, 0.0, b, 10.0) == pytest.approx([100.0, 100.0])
    spin = MovingClearance(circling([6.0, 8.0, 24.0], 0.5, 2))
    assert spin.travels(b[1:], 0.0, b[1:], 4.0) == pytest.approx([0.5 * 4.0 * 13.0])


@given(seed=st.integers(0, 10_000), far=st.floats(0.5, 40.0))
@settings(max_examples=40, deadline=None)
def test_law_min_of_d_and_far_changes_by_the_relative_travel_at_most(seed, far):
    clearance = MovingClearance(wandering(seed, samples=8), radius=0.4)
    a, ta, b, tb = motions(seed, 15)
    travels = clearance.travels(a, ta, b, tb, far=far)
    for k in range(len(a)):
        d = np.minimum(clearance(*along(a[k], ta[k], b[k], tb[k], FINE[::20])), far)
        assert np.ptp(d) <= travels[k] + 1e-9
        assert d.min() >= 0.5 * (d[0] + d[-1] - travels[k]) - 1e-9


@pytest.mark.parametrize(
    ("given_", "argument"),
    [
        (([[0, 0, 0]], 0.0, [[1, 0, 0]], 0.0), "tb[0]"),
        (([[0, 0, 0]], 1.0, [[0, 0, 0]], 0.0), "tb[0]"),
        (([[0, 0, 0]], 0.0, [[1, 0, 0], [2, 0, 0]], 1.0), "b.shape"),
        (([[0, 0]], 0.0, [[1, 0, 0]], 1.0), "a.shape"),
        (([[0, 0, 0]], math.nan, [[1, 0, 0]], 1.0), "ta"),
        (([[0, 0, 0]], 0.0, [[1, 0, 0]], [1.0, 2.0]), "tb.shape"),
        (([[0, 0, math.inf]], 0.0, [[1, 0, 0]], 1.0), "a[0]"),
    ],
)
def test_wrong_motions(given_, argument):
    clearance = MovingClearance(ball())
    for method in (clearance.are_free, clearance.least_between, clearance.travels):
        with pytest.raises(ArgumentError) as caught:
            method(*given_)
        assert caught.value.argument == argument


def test_wrong_tolerance_and_no_motions():
    clearance = MovingClearance(
        [ball(), MovingMesh(trimesh.creation.box(), [0, 1], np.zeros((2, 3)))]
    )
    with pytest.raises(ArgumentError, match="tolerance"):
        clearance.least_between([[0, 0, 0]], 0.0, [[1, 0, 0]], 1.0, tolerance=0.0)
    none = np.empty((0, 3))
    assert clearance.least_between(none, 0.0, none, 1.0).shape == (0,)
    assert clearance.are_free(none, 0.0, none, 1.0).shape == (0,)
    assert len(TimedMotions(none, none[:, 0], none, none[:, 0]).chosen(slice(0, 0)).a) == 0
