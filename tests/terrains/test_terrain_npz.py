"""Terrain kept as npz: everything comes back, and what is no terrain is refused."""

import numpy as np
import pytest
from written_posts import HEIGHTS, UTM, same

from ompl_risk import terrains
from ompl_risk.errors import ArgumentError, FileError, TerrainError, VoidError
from ompl_risk.terrains import Terrain


def everything(terrain):
    keys = ("spacing", "origin", "crs", "name", "source", "scale_error", "geo", "extent")
    return {key: getattr(terrain, key) for key in keys}


def test_npz_keeps_everything(tmp_path):
    path = tmp_path / "terrain.npz"
    plain = Terrain(HEIGHTS, spacing=(10.0, 20.0), origin=(-5.0, 7.0), name="n", source="s")
    for terrain in (terrains.load("jacksboro"), plain):
        terrain.to_npz(path)
        back = terrains.load(path)
        np.testing.assert_array_equal(back.heights, terrain.heights)
        assert everything(back) == everything(terrain)
    part = terrains.load(path, bounds=(0.0, 30.0, 20.0, 60.0))
    assert part.extent == (-5.0, 25.0, 27.0, 67.0)
    for wrong in ({"crs": UTM}, {"band": 2}):
        with pytest.raises(ArgumentError, match=next(iter(wrong))):
            terrains.load(path, **wrong)
    with pytest.raises(ArgumentError, match="npz"):
        plain.to_npz(tmp_path / "terrain.dat")
    with pytest.raises(FileError, match="cannot be written"):
        plain.to_npz(tmp_path / "no" / "such.npz")


def test_npz_of_others(tmp_path):
    path = tmp_path / "mine.npz"
    np.savez(path, heights=HEIGHTS, spacing=(5.0, 5.0))
    terrain = terrains.load(path)
    same(terrain, origin=(0.0, 0.0), spacing=(5.0, 5.0))
    assert (terrain.name, terrain.source) == ("mine", str(path))
    holed = HEIGHTS.copy()
    holed[2, 3] = np.nan
    np.savez(path, heights=holed, spacing=(5.0, 5.0))
    with pytest.raises(VoidError) as caught:
        terrains.load(path)
    assert caught.value.first == (2, 3)
    assert np.isfinite(terrains.load(path, fill="interpolate").heights).all()


@pytest.mark.parametrize(
    ("content", "error", "message"),
    [
        ({"elevation": HEIGHTS, "dx": 1.0}, FileError, "lacks heights, spacing .*dx, elevation"),
        ({"heights": HEIGHTS}, FileError, "lacks spacing"),
        ({"heights": HEIGHTS[0], "spacing": (1.0, 1.0)}, TerrainError, "shape"),
        ({"heights": HEIGHTS, "spacing": 1.0}, ArgumentError, "spacing"),
        ({"heights": HEIGHTS, "spacing": (0.0, 1.0)}, ArgumentError, "spacing"),
        ({"heights": np.array([[None]]), "spacing": (1.0, 1.0)}, FileError, "cannot be read"),
    ],
)
def test_npz_that_is_no_terrain(tmp_path, content, error, message):
    path = tmp_path / "other.npz"
    np.savez(path, **content)
    with pytest.raises(error, match=message):
        terrains.load(path)


def test_npz_that_is_no_npz(tmp_path):
    path = tmp_path / "other.npz"
    for content in (b"", b"junk", b"PK\x03\x04junk"):
        path.write_bytes(content)
        with pytest.raises(FileError, match="NPZ"):
            terrains.load(path)
    with path.open("wb") as file:
        np.save(file, HEIGHTS)  # one array, not an archive
    with pytest.raises(FileError, match="NPZ"):
        terrains.load(path)
