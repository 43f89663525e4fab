"""The small helicopter has the shape, place and attitude that it should have."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ompl_risk.report.camera import Camera
from ompl_risk.report.faces import Faces, draw_faces
from ompl_risk.report.helicopter_glyph import (
    HUB,
    LENGTH,
    ROTOR,
    draw_helicopter,
    helicopter_faces,
)
from ompl_risk.report.style import new_figure

UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])
quaternions = st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4).filter(
    lambda q: np.linalg.norm(q) > 0.1
)


def turned(q, v):
    """q v q*, written out: R v = v + 2 w (u x v) + 2 u x (u x v)."""
    u, w = np.asarray(q[:3]), q[3]
    cross = np.cross(u, v)
    return v + 2.0 * w * cross + 2.0 * np.cross(u, cross)


@given(quaternions, st.floats(0.5, 900.0), st.floats(1.0, 4.0))
def test_corners_are_the_upright_ones_turned_and_scaled(q, scale, exaggeration):
    q = np.array(q) / np.linalg.norm(q)
    position = np.array([10.0, -20.0, 300.0])
    placed = helicopter_faces(position, q, "red", scale=scale, exaggeration=exaggeration)
    for part, upright in zip(placed, helicopter_faces(np.zeros(3), UPRIGHT, "red"), strict=True):
        expected = scale * turned(q, upright.corners) / [1.0, 1.0, exaggeration]
        np.testing.assert_allclose(part.corners - position, expected, atol=1e-9 * scale)


def test_it_has_the_size_of_the_real_one_and_its_parts_in_place():
    body, rotor = helicopter_faces(np.zeros(3), UPRIGHT, "red")
    whole = np.concatenate([body.corners, rotor.corners])
    assert np.ptp(whole[:, 0]) == pytest.approx(LENGTH, rel=0.02)
    disc = rotor.corners[: rotor.ends[0]]
    np.testing.assert_allclose(np.linalg.norm(disc - HUB, axis=1), ROTOR)
    assert body.corners[:, 0].min() < -0.9  # the tail is behind
    assert whole[:, 2].max() < 0.35
    np.testing.assert_allclose(body.corners[:, 1].max(), -body.corners[:, 1].min())


def test_in_a_right_bank_the_right_side_of_the_rotor_is_low():
    bank = Rotation.from_euler("ZYX", [np.pi / 2, 0.0, 0.5]).as_quat()  # towards north
    _, rotor = helicopter_faces(np.zeros(3), bank, "red")
    disc = rotor.corners[: rotor.ends[0]]
    east = disc[np.argmax(disc[:, 0])]  # its right
    west = disc[np.argmin(disc[:, 0])]
    assert west[2] - east[2] == pytest.approx(2.0 * ROTOR * np.sin(0.5), rel=1e-6)


def test_the_side_towards_the_sun_is_bright():
    for q in (UPRIGHT, np.array([1.0, 0.0, 0.0, 0.0])):  # also upside down
        body, _ = helicopter_faces(np.zeros(3), q, "red")
        red = (body.colours[:, 0] > 0.3) & (body.centres[:, 0] > -0.3)
        high = red & (body.centres[:, 2] > 0.1)
        low = red & (body.centres[:, 2] < -0.1)
        assert body.colours[high, 0].mean() > body.colours[low, 0].mean() + 0.1


def test_exaggerated_heights_change_neither_shape_nor_attitude():
    q = Rotation.from_euler("ZYX", [0.7, 0.2, -0.6]).as_quat()
    pictures = []
    for exaggeration in (1.0, 3.0):
        axes = new_figure(4, 4).add_subplot()
        camera = Camera.from_afar(
            np.zeros(3), azimuth=1.0, elevation=0.6, distance=9.0, exaggeration=exaggeration
        )
        parts = draw_helicopter(axes, camera, np.zeros(3), q, "red")
        pictures.append(np.concatenate([p.vertices for c in parts for p in c.get_paths()]))
    np.testing.assert_allclose(*pictures, atol=1e-12)


@pytest.mark.parametrize(("elevation", "rotor_on_top"), [(0.5, True), (-0.5, False)])
def test_the_rotor_hides_the_body_only_from_above(elevation, rotor_on_top):
    axes = new_figure(4, 4).add_subplot()
    camera = Camera.from_afar(np.zeros(3), azimuth=1.0, elevation=elevation, distance=9.0)
    body, rotor = draw_helicopter(axes, camera, np.zeros(3), UPRIGHT, "red", opacity=0.5)
    assert (rotor.get_zorder() > body.get_zorder()) == rotor_on_top
    assert body.get_facecolor()[:, 3].max() == 0.5


def test_faces_are_drawn_from_far_to_near_and_none_behind_the_camera():
    square = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
    triangle = square[:3]
    places = [(square, 0), (triangle, 5), (square, -50), (square, 9)]
    faces = Faces.of([np.add(face, (0, y, 0)) for face, y in places], np.eye(4) * 0.5 + 0.5)
    np.testing.assert_allclose(faces.centres[1], [1 / 3, 5.0, -1 / 3])
    axes = new_figure(4, 4).add_subplot()
    camera = Camera(np.array([0.0, -10.0, 0.0]), np.zeros(3))
    for seam in (0.0, 0.5):
        drawn = draw_faces(axes, camera, faces, seam=seam)
        np.testing.assert_array_equal(drawn.get_facecolor(), faces.colours[[3, 1, 0]])
        sizes = [np.ptp(path.vertices[:, 0]) for path in drawn.get_paths()]
        np.testing.assert_allclose(sizes, [2 / 19, 2 / 15, 2 / 10])
