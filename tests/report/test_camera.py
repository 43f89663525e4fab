"""Where points come to lie in a picture, and what the ground hides."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk.report.camera import Camera, ground_below
from ompl_risk.report.flight_lines import draw_flight
from ompl_risk.report.style import new_figure
from ompl_risk.terrains import Terrain

SOUTH = np.array([0.0, -10.0, 0.0])


@pytest.fixture(scope="module")
def ridge():
    """A ridge with a sharp top of 100 m at x = 500 m, along y, on flat ground."""
    x = np.arange(0.0, 1001.0, 20.0)
    profile = np.clip(100.0 - np.abs(x - 500.0), 0.0, None)
    return Terrain(np.tile(profile, (51, 1)), spacing=(20.0, 20.0), name="ridge")


@pytest.mark.parametrize("exaggeration", [1.0, 3.0])
def test_a_camera_in_the_south_has_east_on_the_right(exaggeration):
    camera = Camera(SOUTH, np.zeros(3), exaggeration=exaggeration)
    places, depth = camera.project(np.array([[1.0, 0.0, 2.0], [1.0, 10.0, 2.0]]))
    z = 2.0 * exaggeration
    np.testing.assert_allclose(places, [[0.1, z / 10.0], [0.05, z / 20.0]], atol=1e-15)
    np.testing.assert_allclose(depth, [10.0, 20.0])


def test_what_is_behind_the_camera_has_no_place():
    places, depth = Camera(SOUTH, np.zeros(3)).project(np.array([[0.0, -11.0, 0.0]]))
    assert depth[0] == -1.0
    assert np.isnan(places).all()


@given(st.floats(0.0, 6.28), st.floats(-1.4, 1.4), st.floats(1.0, 5.0))
def test_from_afar_looks_at_its_target_from_where_it_should(azimuth, elevation, exaggeration):
    target = np.array([3.0, 4.0, 5.0])
    camera = Camera.from_afar(
        target, azimuth=azimuth, elevation=elevation, distance=7.0, exaggeration=exaggeration
    )
    places, depth = camera.project(target[None])
    np.testing.assert_allclose(places, 0.0, atol=1e-12)
    np.testing.assert_allclose(depth, 7.0)
    away = (camera.position - target) * [1.0, 1.0, exaggeration]
    assert math.asin(away[2] / 7.0) == pytest.approx(elevation)
    assert math.cos(math.atan2(away[1], away[0]) - azimuth) == pytest.approx(1.0)
    np.testing.assert_allclose(camera.axes @ camera.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(camera.axes) == pytest.approx(-1.0)  # right, up, forward
    assert camera.axes[0, 2] == 0.0  # the horizon is level
    assert camera.axes[1, 2] > 0.0


@pytest.mark.parametrize("exaggeration", [1.0, 4.0])
def test_a_ridge_hides_what_is_below_the_line_over_its_top(ridge, exaggeration):
    camera = Camera(np.array([1000.0, 500.0, 20.0]), np.zeros(3), exaggeration=exaggeration)
    heights = np.array([1.0, 100.0, 176.0, 184.0, 300.0])  # the line over the top is at 180 m
    points = np.stack([0.0 * heights, 0.0 * heights + 500.0, heights], axis=1)
    assert camera.sees(points, ridge).tolist() == [False, False, False, True, True]
    in_front = np.array([[800.0, 500.0, 1.0]])
    assert camera.sees(in_front, ridge).all()


def test_beyond_the_map_nothing_hides_and_heights_are_those_of_the_edge(ridge):
    camera = Camera(np.array([500.0, -3000.0, 50.0]), np.zeros(3))
    assert camera.sees(np.array([[500.0, -1000.0, -50.0]]), ridge).all()
    outside = np.array([[-10.0, 500.0, 0.0], [500.0, 2000.0, 0.0]])
    np.testing.assert_array_equal(ground_below(ridge, outside), [0.0, 100.0])
    assert (ground_below(ridge, outside, outside=-1.0) == -1.0).all()


def test_hidden_parts_are_dotted_and_the_rest_is_whole(ridge):
    camera = Camera(np.array([1000.0, 500.0, 60.0]), np.array([500.0, 500.0, 60.0]))
    x = np.linspace(50.0, 950.0, 91)
    curve = np.stack([x, 500.0 + 0.0 * x, 50.0 + 0.0 * x], axis=1)
    axes = new_figure(4, 4).add_subplot()
    hidden, whole = draw_flight(axes, camera, ridge, curve, "red", casing=False)
    places, _ = camera.project(curve)
    seen = camera.sees(curve, ridge)
    assert 0 < seen.sum() < len(seen)
    drawn = {tuple(p) for run in whole.get_segments() for p in run}
    assert {tuple(p) for p in places[seen]} <= drawn
    dotted = {tuple(p) for run in hidden.get_segments() for p in run}
    assert {tuple(p) for p in places[~seen]} <= dotted
    # together they draw every step, and only the steps at the border twice
    steps = sum(len(run) - 1 for lines in (hidden, whole) for run in lines.get_segments())
    assert steps == len(curve) - 1 + np.count_nonzero(np.diff(seen.astype(int)))
    assert hidden.get_linestyle() != whole.get_linestyle()
