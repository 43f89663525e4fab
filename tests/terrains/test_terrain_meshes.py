import numpy as np
import pytest

from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain


@pytest.fixture(params=[(2, 2), (2, 5), (5, 2), (6, 4)])
def terrain(request):
    heights = np.random.default_rng(2).uniform(-50.0, 50.0, request.param)
    return Terrain(heights, spacing=(20.0, 30.0), origin=(1000.0, -500.0))


def test_the_surface_has_the_posts_and_the_documented_triangles(terrain):
    ny, nx = terrain.shape
    mesh = terrain.surface()
    xmin, xmax, ymin, ymax = terrain.extent
    x, y = np.meshgrid(np.linspace(xmin, xmax, nx), np.linspace(ymin, ymax, ny))
    posts = np.stack([x, y, terrain.heights], axis=-1).reshape(-1, 3)
    np.testing.assert_allclose(mesh.vertices, posts, rtol=0, atol=1e-9)
    expected = set()
    for j in range(ny - 1):
        for i in range(nx - 1):
            sw, se, nw, ne = (j * nx + i, j * nx + i + 1, (j + 1) * nx + i, (j + 1) * nx + i + 1)
            expected |= {(sw, se, ne), (sw, ne, nw)}
    assert {tuple(face) for face in mesh.faces.tolist()} == expected
    assert (mesh.face_normals[:, 2] > 0).all()


@pytest.mark.parametrize("base", [None, -60.0, -1000.0])
def test_the_solid_is_a_volume_of_the_size_of_its_prisms(terrain, base):
    mesh = terrain.solid(base)
    assert mesh.is_volume  # watertight, consistently wound, finite, volume > 0
    assert mesh.euler_number == 2
    bottom = mesh.bounds[0, 2]
    assert base is None or bottom == base
    assert bottom < terrain.heights.min()
    corners = terrain.surface().triangles
    prisms = 0.5 * 20.0 * 30.0 * (corners[:, :, 2].mean(axis=1) - bottom)
    assert mesh.volume == pytest.approx(prisms.sum(), rel=1e-9)
    xmin, xmax, ymin, ymax = terrain.extent
    np.testing.assert_allclose(mesh.bounds[:, :2], [[xmin, ymin], [xmax, ymax]], rtol=0, atol=1e-9)


def test_normals_point_outwards():
    flat = Terrain(np.zeros((3, 4)), spacing=(1.0, 1.0)).solid(base=-2.0)
    outward = flat.triangles_center - np.array([1.5, 1.0, -1.0])
    assert (np.einsum("ij,ij->i", flat.face_normals, outward) > 0).all()
    assert flat.area == pytest.approx(2 * 3 * 2 + 2 * 2 * (3 + 2))


@pytest.mark.parametrize("base", [0.0, 5.0, np.nan, -np.inf, "deep"])
def test_a_base_that_is_not_below_the_ground_is_refused(base):
    with pytest.raises(ArgumentError, match="base"):
        Terrain([[0.0, 1.0], [1.0, 2.0]], spacing=(1.0, 1.0)).solid(base)
