import math
import random

import numpy as np
import pytest

from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.library import SHIPPED, PrimitiveLibrary
from ompl_risk.helicopter.library_file import ARRAYS, FORMAT, read_library, write_library
from ompl_risk.helicopter.parameters import Helicopter, Limits

DRAGGED = Helicopter(7.5, inertia=(0.2, 0.35, 0.3), hub=0.25, tail=0.9, drag=(0.1, 0.2, 0.3))
LIMITS = Limits(lift=(0.1, 1.9), yaw_force=7.0, tilt=0.21, lift_rate=4.5, yaw_force_rate=31.0,
                tilt_rate=2.1, speed=33.0, rate=1.9, attitude=1.05)  # fmt: skip
GRID = {
    "speeds": [0.0, 10.0, 17.5],
    "turns": [[-0.8, -0.3, 0.3, 0.8], [-0.6, -0.2, 0.2, 0.6], [-0.3, -0.1, 0.1, 0.3]],
    "climbs": [[-2.0, 2.0], [], [-4.0, 1.0, 5.0]],
}
rng = np.random.default_rng(5)
MANOEUVRES = [
    ((0.0, 0.0, 0.0), (0.0, 0.0, 0.3), rng.normal(size=(7, 4))),
    ((0.0, 0.0, 0.3), (0.0, 0.0, 0.0), rng.normal(size=(1, 4))),
    ((10.0, 0.0, 0.0), (17.5, 0.0, 0.0), rng.normal(size=(12, 4))),
]


def write(path, manoeuvres=MANOEUVRES, dt=0.02, **changed):
    write_library(path, DRAGGED, LIMITS, dt, manoeuvres=manoeuvres, **{**GRID, **changed})
    return path


@pytest.fixture
def arrays():
    with np.load(SHIPPED) as file:
        return {name: file[name] for name in file.files}


def saved(path, arrays):
    np.savez(path, **arrays)
    return path


def test_what_is_written_is_read_to_the_last_digit(tmp_path):
    made = read_library(write(tmp_path / "made.npz"))
    assert (made.helicopter, made.limits, made.dt) == (DRAGGED, LIMITS, 0.02)
    assert made.speeds.tolist() == GRID["speeds"]
    assert made.turns.tolist() == GRID["turns"]
    assert [rates.tolist() for rates in made.climbs] == GRID["climbs"]
    for read, (first, last, controls) in zip(made.manoeuvres, MANOEUVRES, strict=True):
        assert (read.first, read.last) == (first, last)
        np.testing.assert_array_equal(read.controls, controls)


def test_a_library_may_have_no_manoeuvres_yet(tmp_path):
    path = write(tmp_path / "trims.npz", manoeuvres=[])
    loaded = PrimitiveLibrary.load(path)
    assert loaded.manoeuvres == ()
    assert len(loaded.trims) == 5 * (3 + 1 + 4)
    assert loaded.helicopter == DRAGGED


def test_writing_the_same_twice_gives_the_same_bytes(tmp_path):
    one, two = write(tmp_path / "one.npz"), write(tmp_path / "two.npz")
    assert one.read_bytes() == two.read_bytes()


def test_shipped_file_is_of_this_version_and_needs_no_pickle(arrays):
    assert set(arrays) == set(ARRAYS)
    assert arrays["format"] == FORMAT
    assert not any(array.dtype.hasobject for array in arrays.values())


def test_another_version_is_refused(tmp_path, arrays):
    with pytest.raises(FileError, match=r"format = 2: this version reads 1; make it anew"):
        PrimitiveLibrary.load(saved(tmp_path / "next.npz", {**arrays, "format": np.array(2)}))
    del arrays["limits"]  # the version is what explains it
    with pytest.raises(FileError, match="format = 2"):
        PrimitiveLibrary.load(saved(tmp_path / "next.npz", {**arrays, "format": np.array(2)}))


@pytest.mark.parametrize("name", sorted(ARRAYS))
def test_a_missing_array_is_named(tmp_path, arrays, name):
    del arrays[name]
    with pytest.raises(FileError, match=rf"no array {name} among \["):
        PrimitiveLibrary.load(saved(tmp_path / "less.npz", arrays))


@pytest.mark.parametrize("name", sorted(set(ARRAYS) - {"format"}))
def test_arrays_of_another_shape_or_not_finite_are_named(tmp_path, arrays, name):
    deeper = {**arrays, name: arrays[name][None]}
    with pytest.raises(FileError, match=rf"{name}\.shape = \(1,.*: must be (\(|a single number)"):
        PrimitiveLibrary.load(saved(tmp_path / "shape.npz", deeper))
    spoilt = arrays[name].astype(float)
    spoilt[(0,) * spoilt.ndim] = math.nan
    with pytest.raises(FileError, match=rf"{name}\[.*\] = nan: must be finite"):
        PrimitiveLibrary.load(saved(tmp_path / "nan.npz", {**arrays, name: spoilt}))


def first_is(array, value):
    changed = array.astype(float)
    changed.flat[0] = value
    return changed


@pytest.mark.parametrize(
    ("name", "value", "named"),
    [
        (
            "lengths",
            9,
            r"lengths = .*: must be whole numbers, .*add up to the \d+ rows of controls",
        ),
        ("lengths", 10.5, "lengths = .* whole numbers"),
        ("lengths", -10, "lengths = .* 0 or more"),
        ("climb_counts", 1e300, "climb_counts = .* rows of climbs"),
        ("helicopter", 0.0, r"mass = 0\.0: must be a positive finite number"),
        ("helicopter", 8.3, r"end of manoeuvre 0, .* = [\d.e-]+: must be within 1e-09"),
        ("limits", 1.5, r"lift = .*low < 1"),
        ("dt", 0.021, "end of manoeuvre 0"),
        ("dt", -0.02, "dt"),
        ("speeds", 5.0, r"speed = 0\.0: must be one of 5, 10, 20, 30"),
        ("speeds", -5.0, "speeds = "),
        ("turns", -0.9, r"turns\[0\] = "),
        ("climbs", 1.0, r"climb = -2\.0: must be one of 0, 1, 2"),
        ("controls", 0.0, "end of manoeuvre 0"),
        ("last", 7.0, r"speed = 7\.0: must be one of 0, 10, 20, 30"),
    ],
)
def test_damaged_contents_are_refused_by_name(tmp_path, arrays, name, value, named):
    damaged = {**arrays, name: first_is(arrays[name], value)}
    with pytest.raises(FileError, match=named) as caught:
        PrimitiveLibrary.load(saved(tmp_path / "damaged.npz", damaged))
    assert "python -m ompl_risk.helicopter.optimal_control" in str(caught.value)


def test_keys_of_another_number_than_inputs(tmp_path, arrays):
    less = {**arrays, "first": arrays["first"][:-1]}
    with pytest.raises(FileError, match=r"first\.shape = \(\d+, 3\)"):
        PrimitiveLibrary.load(saved(tmp_path / "less.npz", less))


def test_files_of_another_kind(tmp_path):
    text, single, pickled = (tmp_path / name for name in ("a.npz", "b.npy", "c.npz"))
    text.write_text("speed,climb,turn\n")
    np.save(single, np.zeros(3))
    np.savez(pickled, format=np.array([{}], dtype=object))
    empty = tmp_path / "empty.npz"
    empty.write_bytes(b"")
    for path in (text, single, pickled, empty):
        with pytest.raises(FileError, match="is no NPZ file of plain arrays"):
            PrimitiveLibrary.load(path)
    with pytest.raises(FileError, match=r"none\.npz: No such file or directory"):
        PrimitiveLibrary.load(str(tmp_path / "none.npz"))
    with pytest.raises(FileError, match="Is a directory"):
        PrimitiveLibrary.load(tmp_path)


def test_damaged_bytes_never_raise_anything_else(tmp_path):
    whole, chance = SHIPPED.read_bytes(), random.Random(3)
    path, refused = tmp_path / "damaged.npz", 0
    for trial in range(250):
        damaged = bytearray(whole)
        if trial % 5 == 0:
            del damaged[chance.randrange(len(whole)) :]
        else:  # half of them near the end, in the directory
            low = len(whole) - 1500 if trial % 2 else 0
            damaged[chance.randrange(low, len(whole))] ^= 1 << chance.randrange(8)
        path.write_bytes(damaged)
        try:
            read_library(path)
        except FileError:
            refused += 1
    assert refused > 200


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"turns": [[0.1, 0.2]]}, r"turns\.shape"),
        ({"speeds": [0.0, math.nan, 1.0]}, r"speeds\[1\] = nan"),
        ({"speeds": [0.0, 10.0]}, r"turns\.shape = \(3, 4\): must be \(2, 4\)"),
        ({"climbs": [[1.0], [[2.0]], []]}, r"climbs\[1\]\.shape"),
        ({"climbs": [[1.0]]}, r"len\(climbs\) = 1: must be 3"),
        (
            {"manoeuvres": [((0.0, 0.0), (0.0, 0.0, 0.3), np.zeros((2, 4)))]},
            r"first\.shape = \(2,\)",
        ),
        (
            {"manoeuvres": [((0, 0, 0), (0, 0, 0.3), np.zeros((2, 3)))]},
            r"controls\.shape = \(2, 3\)",
        ),
        (
            {"manoeuvres": [((0, 0, 0), (0, 0, 0.3), [[0, 0, 0, math.inf]])]},
            r"controls\[0, 3\] = inf",
        ),
        ({"dt": 0.0}, "dt = 0.0"),
    ],
)
def test_nothing_wrong_is_written(tmp_path, changed, named):
    path = tmp_path / "wrong.npz"
    with pytest.raises(ArgumentError, match=named):
        write(path, **changed)
    assert not path.exists()


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(FileError, match="No such file or directory"):
        write(tmp_path / "nowhere" / "made.npz")
