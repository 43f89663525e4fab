"""The drawn ground is the terrain's surface, without gaps or overlaps."""

import numpy as np
import pytest

from ompl_risk.report.ground import ACROSS, MOST, RINGS, WALL, Paint, around, block
from ompl_risk.terrains import Terrain


def bumpy(ny=41, nx=61):
    rng = np.random.default_rng(5)
    return Terrain(rng.uniform(0, 50, (ny, nx)), spacing=(50.0, 40.0), origin=(100.0, 200.0))


def quads(faces):
    return faces.corners.reshape(-1, 4, 3)


def area(cells):
    x, y = np.moveaxis(cells[..., :2], -1, 0)
    return 0.5 * np.abs(
        (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    )  # shoelace formula


def test_a_block_has_every_post_and_walls_down_to_its_base():
    terrain = bumpy()
    faces = block(terrain, base=-30.0)
    wall = (faces.colours[:, :3] == WALL).all(axis=1)
    top = quads(faces)[~wall]
    assert len(top) == 40 * 60
    corners = top.reshape(-1, 3)
    np.testing.assert_allclose(corners[:, 2], terrain.height(*corners[:, :2].T))
    assert area(top).sum() == pytest.approx(3000.0 * 1600.0)
    assert wall.sum() == 2 * (40 + 60)
    assert (quads(faces)[wall][:, 2:, 2] == -30.0).all()


def test_a_large_block_is_drawn_with_fewer_posts_up_to_its_edges():
    terrain = bumpy(402, 300)
    faces = block(terrain, base=-30.0)
    top = quads(faces)[~(faces.colours[:, :3] == WALL).all(axis=1)]
    assert len(top) <= 1.05 * MOST
    assert area(top).sum() == pytest.approx(299 * 50.0 * 401 * 40.0)
    corners = top.reshape(-1, 3)
    np.testing.assert_allclose(corners[:, 2], terrain.height(*corners[:, :2].T))


@pytest.mark.parametrize("centre", [(1600.0, 1000.0), (130.0, 1790.0), (1777.0, 333.3)])
def test_the_ground_around_a_place_has_no_gap_and_no_overlap(centre):
    terrain = bumpy()
    cells = quads(around(terrain, Paint(terrain), np.array(centre), 3.0))
    xmin, xmax, ymin, ymax = terrain.extent
    reach = 0.5 * ACROSS * 3.0 * 2.0 ** (RINGS - 1)
    assert reach > 3000.0  # so all of the terrain is shown
    assert area(cells).sum() == pytest.approx((xmax - xmin) * (ymax - ymin))
    corners = cells.reshape(-1, 3)
    np.testing.assert_allclose(corners[:, 2], terrain.height(*corners[:, :2].T))
    near = np.linalg.norm(cells[..., :2].mean(axis=1) - centre, axis=1) < 0.4 * ACROSS * 3.0
    assert (area(cells[near]) <= 9.0 + 1e-9).all()


def test_cells_stay_where_they_are_when_the_place_moves():
    terrain = bumpy()
    paint = Paint(terrain)
    first, second = (
        around(terrain, paint, np.array([1600.0 + s, 1000.0]), 5.0) for s in (0.0, 37.0)
    )
    shades = [
        {tuple(c.mean(axis=0)): tuple(s) for c, s in zip(quads(f), f.colours, strict=True)}
        for f in (first, second)
    ]
    common = shades[0].keys() & shades[1].keys()
    near = [c for c in common if abs(c[0] - 1620) < 60 and abs(c[1] - 1000) < 60]
    assert len(near) == 24 * 24
    assert all(shades[0][c] == shades[1][c] for c in common)


def test_paint_is_bright_towards_the_sun_and_dark_behind_a_hill():
    x = np.arange(0.0, 1001.0, 50.0)
    hill = 300.0 * np.exp(-(((x - 500) / 200) ** 2 + ((x[:, None] - 500) / 200) ** 2))
    paint = Paint(Terrain(hill, spacing=(50.0, 50.0)))
    north_west, south_east = paint.colours(np.array([[375.0, 625, 150], [625, 375, 150]]))
    assert (north_west > south_east + 0.2).all()
