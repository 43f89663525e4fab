"""MeshClearance and UnionClearance against closed forms."""

import math
import pickle

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from ompl_risk.clearance import (
    MeshClearance,
    MovingClearance,
    MovingSphere,
    TerrainClearance,
    UnionClearance,
)
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain


def box_distance(points, centre, size):
    """Signed distance to an axis-aligned box."""
    q = np.abs(np.asarray(points) - centre) - np.asarray(size) / 2
    return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)


def box(centre=(0, 0, 0), size=(2, 2, 2)):
    mesh = trimesh.creation.box(size)
    mesh.apply_translation(centre)
    return mesh


def poses(positions, rotations=None):
    positions = np.atleast_2d(positions).astype(float)
    quaternions = np.tile([0.0, 0, 0, 1], (len(positions), 1)) if rotations is None else rotations
    return np.hstack([positions, np.atleast_2d(quaternions)])


def test_box_in_closed_form_inside_outside_edges_and_corners():
    rng = np.random.default_rng(0)
    points = rng.uniform(-4, 4, (2000, 3))
    points[:40] = np.round(points[:40])  # faces, edges, corners and symmetry planes
    d = MeshClearance(box(size=(2, 3, 4)), radius=0.25)(points)
    assert d == pytest.approx(box_distance(points, 0, (2, 3, 4)) - 0.25, abs=1e-9)


def test_non_convex_solid_has_the_right_sign_everywhere():
    solid = trimesh.creation.annulus(r_min=1.0, r_max=2.0, height=1.0, sections=96)
    points = np.random.default_rng(1).uniform((-2.5, -2.5, -1), (2.5, 2.5, 1), (1500, 3))
    d = MeshClearance(solid)(points)
    rho = np.hypot(points[:, 0], points[:, 1])
    q = np.column_stack([np.abs(rho - 1.5) - 0.5, np.abs(points[:, 2]) - 0.5])
    smooth = np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)
    assert d == pytest.approx(smooth, abs=2.0 * (1 - math.cos(math.pi / 96)) + 1e-9)


def test_overlapping_obstacles_are_inside_where_any_is():
    a, b = box((0, 0, 0), (4, 4, 4)), box((1.5, 0, 0), (2, 2, 2))
    points = np.random.default_rng(2).uniform(-3, 3, (800, 3))
    d = MeshClearance([a, b])(points)
    both = np.minimum(
        box_distance(points, (0, 0, 0), (4, 4, 4)), box_distance(points, (1.5, 0, 0), (2, 2, 2))
    )
    assert d == pytest.approx(both, abs=1e-9)


def test_many_disjoint_obstacles_share_one_search():
    boxes = [box((5 * i, 5 * j, 0)) for i in range(4) for j in range(4)]
    clearance = MeshClearance(boxes)
    assert len(clearance._groups) == 1
    points = np.random.default_rng(3).uniform(-3, 18, (500, 3))
    expected = np.min([box_distance(points, b.centroid, (2, 2, 2)) for b in boxes], axis=0)
    assert clearance(points) == pytest.approx(expected, abs=1e-9)


def test_mesh_body_uses_the_full_pose():
    rod = trimesh.creation.box((4.0, 0.2, 0.2))
    clearance = MeshClearance(box(), body=rod)
    assert clearance.uses_orientation
    assert clearance.reach == pytest.approx(math.sqrt(4 + 0.01 + 0.01))
    turn = Rotation.from_euler("z", 90, degrees=True).as_quat()
    d = clearance(poses([[5, 0, 0], [5, 0, 0]], [[0, 0, 0, 1], turn]))
    assert d == pytest.approx([5 - 1 - 2, 5 - 1 - 0.1], abs=1e-9)


def test_mesh_body_in_a_random_pose_against_its_corners():
    cube = trimesh.creation.box((1, 1, 1))
    clearance = MeshClearance(box((0, 0, -50), (1000, 1000, 100)), body=cube)
    rotations = Rotation.random(100, random_state=1)
    positions = np.random.default_rng(4).uniform((-5, -5, 2), (5, 5, 9), (100, 3))
    corners = np.array([r.apply(cube.vertices) for r in rotations]) + positions[:, None]
    d = clearance(poses(positions, rotations.as_quat()))
    assert d == pytest.approx(corners[:, :, 2].min(axis=1), abs=1e-9)


@pytest.mark.parametrize(
    ("x", "what"),
    [(1.2, "overlapping"), (0.0, "body inside"), (1.5, "touching from inside to outside")],
)
def test_mesh_body_in_collision_is_negative(x, what):
    clearance = MeshClearance(box(), body=trimesh.creation.box((1, 1, 1)))
    assert clearance(poses([[x, 0, 0]]))[0] <= 0, what


def test_mesh_body_that_encloses_an_obstacle_is_in_collision():
    shell = trimesh.creation.box((6, 6, 6))
    assert MeshClearance(box(size=(1, 1, 1)), body=shell)(poses([[0, 0, 0]]))[0] < 0


def test_open_mesh_is_refused_or_taken_as_a_surface():
    sheet = trimesh.Trimesh([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], [[0, 1, 2], [0, 2, 3]])
    with pytest.raises(ArgumentError, match="surfaces=True"):
        MeshClearance(sheet)
    d = MeshClearance(sheet, radius=0.5, surfaces=True)([[1, 1, 2], [1, 1, -2], [6, 1, 0]])
    assert d == pytest.approx([1.5, 1.5, 1.5])


def test_inverted_mesh_is_refused():
    inverted = box()
    inverted.invert()
    with pytest.raises(ArgumentError, match="fix_normals"):
        MeshClearance(inverted)


@pytest.mark.parametrize(
    ("make", "names"),
    [
        (lambda: MeshClearance([]), "obstacles"),
        (lambda: MeshClearance("box"), "obstacles[0]"),
        (lambda: MeshClearance(box(), radius=-1), "radius = -1"),
        (lambda: MeshClearance(box(), 1.0, body=box()), "radius = 1.0"),
        (lambda: MeshClearance(box(), body=box())([[0, 0, 0]]), "poses.shape = (1, 3)"),
        (lambda: MeshClearance(box(), body=box())([[0, 0, 0, 0, 0, 0, 2.0]]), "unit quaternion"),
        (lambda: UnionClearance([]), "members"),
        (lambda: UnionClearance([3]), "members[0] = 3"),
        (
            lambda: UnionClearance(
                [MovingClearance(MovingSphere(1.0, [0.0, 1.0], np.zeros((2, 3))))]
            ),
            "stands still",
        ),
        (lambda: UnionClearance([lambda p: np.zeros(3)])([[0, 0, 0]]), "members[0](points).shape"),
    ],
)
def test_bad_input_is_named(make, names):
    with pytest.raises(ArgumentError) as error:
        make()
    assert names in str(error.value)


def test_union_is_the_minimum_and_says_whose():
    ground = TerrainClearance(Terrain(np.zeros((5, 5)), spacing=(10.0, 10.0)), radius=1.0)
    tower = MeshClearance(box((20, 20, 5), (2, 2, 10)), radius=1.0)
    union = UnionClearance([ground, tower])
    points = np.array([[5.0, 5, 6], [23, 20, 9], [20, 20, 30]])
    assert union(points) == pytest.approx([5, 1, 19])
    assert union.which(points).tolist() == [0, 1, 1]


def test_union_of_a_posed_and_a_point_member_takes_poses():
    ground = TerrainClearance(Terrain(np.zeros((5, 5)), spacing=(10.0, 10.0)))
    rod = MeshClearance(box((20, 20, 5), (2, 2, 10)), body=trimesh.creation.box((4, 0.2, 0.2)))
    union = UnionClearance([ground, rod])
    assert union.uses_orientation
    assert union.reach == rod.reach
    assert union(poses([[26, 20, 4], [30, 20, 2]])) == pytest.approx([3, 2])


def test_every_piece_of_a_body_counts():
    parts = trimesh.util.concatenate([box(), box((50, 0, 0))])
    clearance = MeshClearance(box(size=(20, 20, 20)), body=parts)
    d = clearance(poses([[0, 0, 0], [-50, 0, 0], [-200, 0, 0]]))
    assert (d < 0).tolist() == [True, True, False]


def test_meshes_and_unions_survive_pickling():
    mesh = MeshClearance([box(), box((9, 0, 0))], radius=0.25)
    rod = MeshClearance(box(), body=trimesh.creation.box((4, 0.2, 0.2)))
    points = np.random.default_rng(5).uniform(-4, 12, (50, 3))
    for clearance, queries in (
        (mesh, points),
        (rod, poses(points)),
        (UnionClearance([mesh, mesh.of_point()]), points),
    ):
        copy = pickle.loads(pickle.dumps(clearance))
        assert np.array_equal(copy(queries), clearance(queries))
