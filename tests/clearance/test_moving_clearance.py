"""d(q, t) of moving obstacles: closed forms, another way to compute it, laws, wrong arguments."""

import math
import pickle

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from moving_scene import circling, true_distance, wandering
from scipy.spatial.transform import Rotation

from ompl_risk.clearance import Clearance, MeshClearance, TerrainClearance, UnionClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingMesh, MovingSphere
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain

FLAT = Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0), origin=(-50.0, -50.0))


def ball(radius=2.0):
    """Flies along x at 10 m/s from t = 0 to t = 10."""
    return MovingSphere(radius, [0.0, 10.0], [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])


def test_ball_in_closed_form_before_during_and_after_its_flight():
    clearance = MovingClearance(ball(), radius=1.0)
    points = np.tile([50.0, 8.0, 0.0], (4, 1))
    d = clearance(points, [-3.0, 5.0, 8.0, 99.0])
    assert d == pytest.approx(np.hypot([50.0, 0.0, 30.0, 50.0], 8.0) - 3.0, abs=1e-12)


def test_turning_box_in_closed_form():
    clearance = MovingClearance(circling([4.0, 2.0, 2.0], 1.0, 1))
    d = clearance(np.tile([5.0, 0.0, 0.0], (3, 1)), [0.0, math.pi / 4, math.pi / 2])
    corner = math.hypot(5.0 * math.sqrt(0.5) - 2.0, 5.0 * math.sqrt(0.5) - 1.0)
    assert d == pytest.approx([3.0, corner, 4.0], abs=1e-12)
    assert clearance([[0.5, 0.0, 0.0]], 0.0) == pytest.approx([-1.0], abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_distances_agree_with_another_way_to_compute_them(seed):
    obstacles = wandering(seed, spheres=2, boxes=3)
    rng = np.random.default_rng(100 + seed)
    points, times = rng.uniform(-25, 25, (120, 3)), rng.uniform(-2, 12, 120)
    clearance = MovingClearance(obstacles, radius=0.5)
    true = [true_distance(obstacles, p, t) - 0.5 for p, t in zip(points, times, strict=True)]
    assert clearance(points, times) == pytest.approx(true, abs=1e-9)
    for p, t, which in zip(points, times, clearance.which(points, times), strict=True):
        assert true_distance([obstacles[which]], p, t) == pytest.approx(
            true_distance(obstacles, p, t), abs=1e-9
        )


def test_threads_change_nothing():
    obstacles, rng = wandering(7), np.random.default_rng(7)
    points, times = rng.uniform(-25, 25, (5000, 3)), rng.uniform(0, 10, 5000)
    one, four = (MovingClearance(obstacles, threads=n)(points, times) for n in (1, 4))
    assert (one == four).all()


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (1.0, -2.0, 0.5)])
def test_a_mesh_of_a_box_is_the_box(shift):
    rng = np.random.default_rng(3)
    t, p = np.array([0.0, 2.0, 5.0]), rng.uniform(-5, 5, (3, 3))
    turned = Rotation.random(3, random_state=3)
    box = MovingBox([2.0, 3.0, 4.0], t, p, turned.as_quat())
    mesh = trimesh.creation.box((2.0, 3.0, 4.0))
    points, times = rng.uniform(-8, 8, (400, 3)), rng.uniform(-1, 6, 400)
    if any(shift):  # a mesh away from its origin swings about it: compare at the samples
        mesh.apply_translation(shift)
        p, times = p - turned.apply(shift), t[rng.integers(0, 3, 400)]
    clearance = MovingClearance([MovingMesh(mesh, t, p, turned.as_quat()), ball()], radius=0.1)
    plain = MovingClearance([box, ball()], radius=0.1)
    assert clearance(points, times) == pytest.approx(plain(points, times), abs=1e-9)
    assert (clearance.which(points, times) == plain.which(points, times)).all()


def test_a_mesh_that_is_not_convex_has_a_hole():
    ring = trimesh.creation.annulus(r_min=2.0, r_max=3.0, height=1.0, sections=64)
    flight = MovingMesh(ring, [0.0, 10.0], [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0]])
    d = MovingClearance(flight)(
        [[0.0, 0.0, 5.0], [2.5, 0.0, 5.0], [0.0, 0.0, 5.0]], [5.0, 5.0, 0.0]
    )
    assert d == pytest.approx([2.0, -0.5, math.hypot(2.0, 4.5)], abs=3e-3)


def test_what_stands_still_counts_too():
    ground = TerrainClearance(FLAT, radius=1.0)
    clearance = MovingClearance(ball(), static=ground)
    points = np.array([[20.0, 0.0, 6.0], [20.0, 0.0, 6.0], [20.0, 0.0, 40.0]])
    times = np.array([2.0, 9.0, 2.0])
    assert clearance(points, times) == pytest.approx([3.0, 5.0, 37.0], abs=1e-12)
    assert clearance.which(points, times).tolist() == [0, -1, 0]
    assert clearance([[500.0, 0.0, 6.0]], 0.0) == [-math.inf]  # off the map


@pytest.mark.parametrize(
    "static",
    [
        TerrainClearance(FLAT, radius=1.0),
        lambda points: points[:, 2] - 1.0,
        UnionClearance([TerrainClearance(FLAT, radius=1.0), lambda points: points[:, 2] + 9.0]),
    ],
)
def test_another_radius_is_for_all_parts(static):
    points, times = np.array([[3.0, 4.0, 7.0], [3.0, 0.0, 30.0]]), np.array([0.0, 0.3])
    for_one = MovingClearance(ball(), static=static, radius=1.0)
    grown, point = for_one.with_radius(2.5), for_one.of_point()
    assert grown(points, times) == pytest.approx(for_one(points, times) - 1.5, abs=1e-12)
    assert point(points, times) == pytest.approx(for_one(points, times) + 1.0, abs=1e-12)
    assert point.with_radius(1.0)(points, times) == pytest.approx(for_one(points, times))
    assert (for_one.radius, grown.radius, point.radius) == (1.0, 2.5, 0.0)


def test_a_moment_is_an_ordinary_clearance():
    clearance = MovingClearance(ball(), static=TerrainClearance(FLAT, radius=1.0))
    moment, points = clearance.at(3.0), np.array([[30.0, 5.0, 8.0], [0.0, 0.0, 8.0]])
    assert isinstance(moment, Clearance)
    assert not moment.uses_orientation
    assert (moment(points) == clearance(points, 3.0)).all()
    assert (moment.of_point()(points) == clearance.of_point()(points, 3.0)).all()
    assert (moment.with_radius(2.0)(points) == clearance.with_radius(2.0)(points, 3.0)).all()
    union = UnionClearance([moment, lambda points: np.full(len(points), 2.0)])
    assert union([[30.0, 5.0, 8.0]]) == pytest.approx([2.0])


def test_speed_bounds_in_closed_form():
    box = circling([6.0, 8.0, 24.0], 0.5, 1)  # half its diagonal is 13 m
    clearance = MovingClearance([ball(), box])
    assert ball().speed_bound(0.0, 10.0) == pytest.approx(10.0)
    assert ball().speed_bound(10.0, math.inf) == 0.0
    assert ball().speed_bound(-math.inf, 0.0) == 0.0
    assert box.speed_bound(1.0, 2.0) == pytest.approx(6.5)
    found = clearance.speed_bound([0.0, 10.5, -5.0, 20.0], [10.0, 11.0, -1.0, 30.0])
    assert found == pytest.approx([10.0, 6.5, 0.0, 0.0])
    shifted = trimesh.creation.box((2.0, 2.0, 2.0))
    shifted.apply_translation((11.0, 0.0, 0.0))  # the farthest corner is at (12, 1, 1)
    mesh = MovingMesh(shifted, box.times, box.positions, box.orientations)
    assert mesh.speed_bound(0.0, 1.0) == pytest.approx(0.5 * math.sqrt(146.0))


def test_speed_bound_takes_only_the_pieces_in_its_time():
    steps = MovingSphere(1.0, [0.0, 1.0, 2.0, 3.0], [[0, 0, 0], [1, 0, 0], [9, 0, 0], [11, 0, 0]])
    found = steps.speed_bound([0.0, 0.5, 2.0, 1.0, 1.0], [1.0, 1.5, 9.0, 1.0, 2.0])
    assert found == pytest.approx([1.0, 8.0, 2.0, 8.0, 8.0])


@given(seed=st.integers(0, 10_000), step=st.floats(-6.0, 1.0))
@settings(max_examples=60, deadline=None)
def test_law_d_is_lipschitz_in_place_and_in_time(seed, step):
    rng = np.random.default_rng(seed)
    clearance = MovingClearance(wandering(seed % 7), radius=0.3)
    points, times = rng.uniform(-25, 25, (30, 3)), rng.uniform(-2, 12, 30)
    moved = points + rng.normal(size=(30, 3)) * 10.0**step
    length = np.linalg.norm(moved - points, axis=1)
    change = np.abs(clearance(moved, times) - clearance(points, times))
    assert (change <= length + 1e-9).all()
    later = times + rng.uniform(0, 1, 30) * 10.0**step
    change = np.abs(clearance(points, later) - clearance(points, times))
    assert (change <= clearance.speed_bound(times, later) * (later - times) + 1e-9).all()


def test_pickle_and_repr():
    mesh = MovingMesh(trimesh.creation.icosphere(), [0.0, 1.0], np.zeros((2, 3)))
    ground = TerrainClearance(FLAT, radius=1.0)
    clearance = MovingClearance([mesh, *wandering(1)], static=ground)
    points = np.random.default_rng(0).uniform(-20, 20, (50, 3))
    again = pickle.loads(pickle.dumps(clearance))
    assert (again(points, 3.0) == clearance(points, 3.0)).all()
    assert repr(again) == repr(clearance)
    assert "4 obstacles" in repr(clearance)
    assert not again.obstacles[1].positions.flags.writeable


def test_arrays_are_read_only_copies():
    times = np.array([0.0, 1.0])
    obstacle = MovingSphere(1.0, times, np.zeros((2, 3)))
    times[0] = -5.0
    assert obstacle.times[0] == 0.0
    for array in (obstacle.times, obstacle.positions, obstacle.orientations):
        assert not array.flags.writeable


def test_without_a_time_there_is_no_distance():
    clearance = MovingClearance(ball())
    assert clearance.moves
    with pytest.raises(ArgumentError, match=r"times = None.*clearance\.at\(t\)"):
        clearance([[0.0, 0.0, 0.0]])
    with pytest.raises(ArgumentError, match=r"static="):
        UnionClearance([clearance, TerrainClearance(FLAT)])([[0.0, 0.0, 5.0]])
    assert not clearance.at(0.0).moves


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: MovingClearance([]), "obstacles"),
        (lambda: MovingClearance([ball(), "ball"]), "obstacles[1]"),
        (lambda: MovingClearance(ball(), radius=-1.0), "radius"),
        (lambda: MovingClearance(ball(), threads=0), "threads"),
        (lambda: MovingClearance(ball(), static=3.0), "static"),
        (lambda: MovingClearance(ball(), static=MovingClearance(ball())), "static"),
        (
            lambda: MovingClearance(
                ball(),
                static=UnionClearance([TerrainClearance(FLAT), MovingClearance(ball())]),
            ),
            "members[1]",
        ),
        (
            lambda: MovingClearance(
                ball(),
                static=MeshClearance(trimesh.creation.box(), body=trimesh.creation.box()),
            ),
            "static",
        ),
        (
            lambda: MovingClearance(ball(), static=TerrainClearance(FLAT, radius=5.0), radius=1.0),
            "radius",
        ),
        (lambda: MovingSphere(0.0, [0, 1], np.zeros((2, 3))), "radius"),
        (lambda: MovingSphere(1.0, [0, 0], np.zeros((2, 3))), "times[1]"),
        (lambda: MovingSphere(1.0, [0, 1], np.zeros((3, 3))), "positions.shape"),
        (lambda: MovingSphere(1.0, [0, math.inf], np.zeros((2, 3))), "times[1]"),
        (lambda: MovingBox([1, 0, 1], [0, 1], np.zeros((2, 3))), "extents"),
        (
            lambda: MovingBox([1, 1, 1], [0, 1], np.zeros((2, 3)), np.ones((2, 4))),
            "orientations[0]",
        ),
        (lambda: MovingMesh("box", [0, 1], np.zeros((2, 3))), "mesh"),
        (lambda: MovingMesh([trimesh.creation.box()], [0, 1], np.zeros((2, 3))), "mesh"),
        (lambda: MovingClearance(ball())([[0.0, 0.0]], 0.0), "points.shape"),
        (lambda: MovingClearance(ball())([[0.0, 0.0, 0.0]], [0.0, 1.0]), "times.shape"),
        (lambda: MovingClearance(ball())([[0.0, 0.0, 0.0]], math.nan), "times"),
        (lambda: MovingClearance(ball()).at(math.inf), "time"),
        (lambda: MovingClearance(ball()).speed_bound(1.0, 0.0), "(t0, t1)"),
        (lambda: MovingClearance(ball()).speed_bound(math.nan, 0.0), "(t0, t1)"),
        (lambda: MovingClearance(ball()).speed_bound([0.0, 1.0], [1.0, 2.0, 3.0]), "t1.shape"),
        (
            lambda: MovingClearance(ball(), static=lambda p: np.zeros(7))([[0.0, 0.0, 0.0]], 0.0),
            "static(points)",
        ),
    ],
)
def test_wrong_arguments(make, argument):
    with pytest.raises(ArgumentError) as caught:
        make()
    assert caught.value.argument == argument
