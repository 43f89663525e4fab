import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from small_library import GRID, X_CELL, grid_with, left_turn, library, lifting

from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.helicopter.library import SHIPPED, PrimitiveLibrary, default_library
from ompl_risk.helicopter.library_file import read_library
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT, mirrored_controls


@pytest.fixture(scope="module")
def shipped():
    return default_library()


def test_shipped_trims_cover_the_grid_and_are_found_by_what_they_are(shipped):
    keys = [trim.key for trim in shipped.trims]
    wanted = {
        (speed, climb, turn)
        for speed, turns, climbs in zip(shipped.speeds, shipped.turns, shipped.climbs, strict=True)
        for climb in (0.0, *climbs)
        for turn in (0.0, *turns)
    }
    assert len(keys) == len(set(keys)) == 15 + 3 * 25
    assert set(keys) == wanted
    assert keys == sorted(keys)
    assert all(shipped.trim(*key).key == key for key in keys)
    assert max(trim.residual for trim in shipped.trims) <= 1e-10


def test_shipped_manoeuvres_join_what_they_should(shipped):
    ends = {(m.first.key, m.last.key) for m in shipped.manoeuvres}
    wanted = set()
    for speed, turns, climbs in zip(shipped.speeds, shipped.turns, shipped.climbs, strict=True):
        level = (speed, 0.0, 0.0)
        other = [(speed, 0.0, turn) for turn in turns] + [(speed, climb, 0.0) for climb in climbs]
        wanted |= {(level, key) for key in other} | {(key, level) for key in other}
        wanted |= {(level, (to, 0.0, 0.0)) for to in shipped.speeds if to != speed}
    assert ends == wanted
    assert len(shipped.manoeuvres) == len(wanted) == 72
    assert [m.number for m in shipped.manoeuvres] == list(range(72))
    assert all(shipped.manoeuvre(m.first, m.last) is m for m in shipped.manoeuvres)


def test_shipped_manoeuvres_end_in_their_last_trim(shipped):
    for m in shipped.manoeuvres:
        np.testing.assert_array_equal(m.states[0], m.first.state())
        R = Rotation.from_quat(m.states[-1, 3:7])
        psi, theta, phi = R.as_euler("ZYX")
        body = [phi, theta, *m.states[-1, 7:]]
        wanted = [m.last.roll, m.last.pitch, *m.last.velocity, *m.last.rates]
        np.testing.assert_allclose(body, wanted, rtol=0, atol=1e-9, err_msg=str(m.number))
        assert psi == pytest.approx(m.displacement[3], abs=1e-12)
        np.testing.assert_array_equal(m.displacement[:3], m.states[-1, :3])


def test_shipped_manoeuvres_keep_height_and_plane(shipped):
    for m in shipped.manoeuvres:
        if m.first.climb == m.last.climb == 0.0:
            assert abs(m.displacement[2]) <= 1e-9
        if m.first.turn == m.last.turn == 0.0:
            assert not m.track[:, [1, 3]].any()
            assert not m.controls[:, [1, 3]].any()


def test_shipped_manoeuvres_keep_the_limits(shipped):
    low, high = shipped.limits.controls(X_CELL)
    most = shipped.limits.control_rates(X_CELL) * DT
    for m in shipped.manoeuvres:
        controls = np.vstack([m.first.control, m.controls, m.last.control])
        assert (controls >= low).all()
        assert (controls <= high).all()
        assert (np.abs(np.diff(controls, axis=0)) <= most).all()
        up = Rotation.from_quat(m.states[:, 3:7]).as_matrix()[:, 2, 2]
        assert np.arccos(up.clip(-1.0, 1.0)).max() <= shipped.limits.attitude
        assert np.abs(m.states[:, 10:]).max() <= shipped.limits.rate
        assert np.linalg.norm(m.states[:, 7:10], axis=1).max() == pytest.approx(m.fastest)
        assert m.fastest <= shipped.limits.speed


def test_right_is_the_mirror_image_of_left(shipped):
    turning = [m for m in shipped.manoeuvres if m.first.turn > 0.0 or m.last.turn > 0.0]
    assert len(turning) == 16
    for m in turning:
        first, last = (shipped.trim(t.speed, t.climb, -t.turn) for t in (m.first, m.last))
        right = shipped.manoeuvre(first, last)
        np.testing.assert_array_equal(right.controls, m.controls * [1, -1, 1, -1])
        np.testing.assert_array_equal(right.track, m.track * [1, -1, 1, -1])


def test_default_library_is_read_once_and_for_the_default_helicopter(shipped):
    assert default_library() is shipped
    assert shipped.helicopter == Helicopter()
    assert shipped.limits == Limits()
    assert shipped.dt == DT == 0.02


def test_asking_for_what_there_is_not_names_what_there_is():
    lib = library(lifting(10.0, 0.0, 2.0), lifting(10.0, 0.0, -2.0), lifting(0.0, 2.0, 0.0))
    with pytest.raises(ArgumentError, match=r"speed = 11: must be one of 0, 10$"):
        lib.trim(11)
    with pytest.raises(ArgumentError, match=r"climb = 3: must be one of -2, 0, 2 at speed 10$"):
        lib.trim(10, 3)
    with pytest.raises(ArgumentError, match=r"turn = 0.25: .* -0.2, 0, 0.2, 0.6 at .* climb -2$"):
        lib.trim(10, -2, 0.25)
    with pytest.raises(ArgumentError, match="speed = nan"):
        lib.trim(math.nan)
    with pytest.raises(ArgumentError, match=r"last = \(10.*turn 0 rad/s\): .*climb 2 .*climb -2"):
        lib.manoeuvre(lib.trim(10), lib.trim(10, 0, 0.6))
    with pytest.raises(ArgumentError, match=r"first = \(0.0, 0.0, 0.0\).*begins: \(10 m.*\(0 m/s"):
        lib.manoeuvre(lib.trim(0), lib.trim(10))
    with pytest.raises(ArgumentError, match="there is none"):
        library().manoeuvre(lib.trim(0), lib.trim(10))


def test_rounding_of_a_turn_rate_does_not_matter():
    lib = library()
    assert lib.trim(10, 0, 0.6 * (1 + 1e-15)) is lib.trim(10, 0, 0.6)
    assert lib.trim(10.0, -0.0, 1e-16) is lib.trim(10)
    with pytest.raises(ArgumentError, match="turn"):
        lib.trim(10, 0, 0.6 * (1 + 1e-8))


def test_trims_that_break_a_limit_are_left_out():
    steep = library(turns=[GRID["turns"][0], [-2.0, -0.2, 0.2, 2.0]])  # 64 deg of bank
    assert [t.turn for t in steep.trims if t.key[:2] == (10.0, 0.0)] == [-0.2, 0.0, 0.2]
    with pytest.raises(ArgumentError, match=r"turn = 2.0: must be one of -0.2, 0, 0.2 at"):
        steep.trim(10.0, 0.0, 2.0)


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"speeds": [10.0, 0.0]}, r"speeds = \[10.0, 0.0\]: must be 0 or more and increasing"),
        ({"speeds": [-1.0, 10.0]}, "speeds"),
        ({"speeds": []}, "speeds"),
        ({"speeds": [0.0, 40.0]}, r"speed 40, not 0 to 35 m/s"),
        ({"turns": [[-0.8, -0.3, 0.3, 0.8]]}, r"turns\.shape = \(1, 4\): must be \(2, 4\)"),
        (
            {"turns": [[-0.8, -0.3, 0.3, 0.8], [-0.6, -0.2, 0.2, 0.7]]},
            r"turns\[1\].*-hard, -gentle",
        ),
        ({"turns": [[-0.3, -0.8, 0.8, 0.3], [-0.6, -0.2, 0.2, 0.6]]}, r"turns\[0\]"),
        ({"turns": [[-0.3, 0.0, 0.0, 0.3], [-0.6, -0.2, 0.2, 0.6]]}, r"turns\[0\]"),
        ({"climbs": [[-2.0, 2.0]]}, r"len\(climbs\) = 1: must be 2, one for each speed"),
        ({"climbs": [[2.0, -2.0], []]}, r"climbs\[0\].*increasing"),
        ({"climbs": [[-2.0, 2.0], [0.0]]}, r"climbs\[1\] = \[0.0\].*other than 0"),
        ({"dt": 0.0}, "dt = 0.0"),
        ({"dt": math.nan}, "dt = nan"),
    ],
)
def test_wrong_grids(changed, named):
    with pytest.raises(ArgumentError, match=named):
        library(**changed)


def test_wrong_ends_of_manoeuvres(shipped):
    good = lifting(0.0, 0.0, 2.0)
    with pytest.raises(ArgumentError, match=r"climb = 1\.0: must be one of -2, 0, 2 at speed 0"):
        library(lifting(0.0, 0.0, 1.0))
    with pytest.raises(ArgumentError, match=r"first key of manoeuvre 1\.shape = \(2,\)"):
        library(good, ((0.0, 0.0), (0.0, 2.0, 0.0), good[2]))
    with pytest.raises(ArgumentError, match=r"manoeuvre 1.*given once"):
        library(good, good)
    left = left_turn(shipped)
    first, last, controls = left
    grid, right = (
        grid_with(last.turn),
        (first, (10.0, 0.0, -last.turn), mirrored_controls(controls)),
    )
    with pytest.raises(ArgumentError, match="not to the right as well"):
        library(left, right, **grid)
    assert len(library(right, **grid).manoeuvres) == 2


def test_wind_is_refused():
    with pytest.raises(ArgumentError, match=r"helicopter\.wind"):
        PrimitiveLibrary(Helicopter(wind=(1.0, 0.0, 0.0)), Limits(), **GRID)


def test_summary_has_a_line_for_everything(shipped):
    lines = shipped.summary().splitlines()
    trims, manoeuvres = lines[2:92], lines[95:]
    assert lines[92] == ""
    assert len(manoeuvres) == 72
    for line, trim in zip(trims, shipped.trims, strict=True):
        numbers = [float(word) for word in line.split()]
        angles = [math.degrees(a) for a in (trim.turn, trim.roll, trim.pitch)]
        wanted = [trim.speed, trim.climb, *angles, *trim.control[:2], *np.degrees(trim.control[2:])]
        np.testing.assert_allclose(numbers, wanted, atol=0.006)
    for line, m in zip(manoeuvres, shipped.manoeuvres, strict=True):
        numbers = [float(word) for word in line.split()]
        wanted = [m.number, m.first.speed, m.first.climb, math.degrees(m.first.turn)]
        wanted += [m.last.speed, m.last.climb, math.degrees(m.last.turn), m.duration]
        wanted += [*m.displacement[:3], math.degrees(m.displacement[3]), m.fastest]
        np.testing.assert_allclose(numbers, wanted, atol=0.051)
    assert "-0.00 " not in shipped.summary()


def test_what_is_read_makes_the_same_library(shipped):
    made = read_library(SHIPPED)
    again = PrimitiveLibrary(
        made.helicopter, made.limits,
        speeds=made.speeds, turns=made.turns, climbs=made.climbs, manoeuvres=made.manoeuvres,
    )  # fmt: skip
    for a, b in zip(again.manoeuvres, shipped.manoeuvres, strict=True):
        np.testing.assert_array_equal(a.states, b.states)


def test_no_library_for_another_helicopter_or_other_limits():
    heavy = Helicopter(9.0)
    with pytest.raises(FileError, match=r"is made for Helicopter\(mass=8\.2.*asked .*mass=9\.0"):
        PrimitiveLibrary.load(helicopter=heavy)
    with pytest.raises(FileError, match=r"is made for Limits\(.*asked for is .*tilt=0\.1"):
        PrimitiveLibrary.load(limits=Limits(tilt=0.1))
    same = PrimitiveLibrary.load(helicopter=Helicopter(), limits=Limits())
    assert same.helicopter == Helicopter()
