"""Where the vehicle is on a piece: arcs against quadrature, tracks against their points."""

import numpy as np
import pytest
from flown_pieces import DT, PARTS, TRACKS, Way
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad_vec

from ompl_risk._kernels.extents import extent_of
from ompl_risk._kernels.pieces import fastest_on, joined_tracks, position_at
from ompl_risk.helicopter.library import default_library

rates = st.one_of(st.sampled_from([0.0, 1e-300, 1e-12, -1e-7, 5e-6, 1e-4]), st.floats(-1.2, 1.2))


def any_way(heading=0.7):
    way = Way(3.0, -2.0, 50.0, heading).manoeuvre(0).trim(20.0, 0.0, 0.4, 6.0)
    return way.manoeuvre(2).trim(20.0, -6.0, 0.0, 3.0).manoeuvre(1).trim(0.0, 2.0, -0.8, 2.0)


@given(
    speed=st.floats(0.0, 30.0), climb=st.floats(-6.0, 6.0), turn=rates,
    heading=st.floats(-10.0, 10.0), t=st.floats(0.0, 60.0),
)  # fmt: skip
@example(speed=30.0, climb=0.0, turn=1e-5, heading=0.0, t=19.9)
@example(speed=30.0, climb=0.0, turn=1e-5, heading=0.0, t=20.1)
@settings(max_examples=60, deadline=None)
def test_a_trim_is_the_integral_of_its_velocity(speed, climb, turn, heading, t):
    row = Way(5.0, 7.0, 40.0, heading).trim(speed, climb, turn, 60.0).rows[0]

    def velocity(s):
        angle = heading + turn * s
        return np.array([speed * np.cos(angle), speed * np.sin(angle), climb, turn])

    expected = quad_vec(velocity, 0.0, t, epsabs=1e-10)[0] + [5.0, 7.0, 40.0, heading]
    assert position_at(row, TRACKS, t) == pytest.approx(expected, rel=1e-9, abs=1e-8)


@given(number=st.integers(0, 3), heading=st.floats(-7.0, 7.0), s=st.floats(0.0, 1.0))
@settings(max_examples=60, deadline=None)
def test_a_manoeuvre_passes_the_points_of_its_track_and_is_straight_between(number, heading, s):
    row = Way(5.0, 7.0, 40.0, heading).manoeuvre(number).rows[0]
    track = PARTS[number]
    place = (track[:, 0] + 1j * track[:, 1]) * np.exp(1j * heading) + (5.0 + 7.0j)
    expected = np.column_stack([place.real, place.imag, 40.0 + track[:, 2], heading + track[:, 3]])
    for k in (0, 1, len(track) // 2, len(track) - 2):
        both = (1.0 - s) * expected[k] + s * expected[k + 1]
        assert position_at(row, TRACKS, (k + s) * DT) == pytest.approx(both, abs=1e-11)
    end = position_at(row, TRACKS, row[1] * (1.0 + 1e-15))
    assert end == pytest.approx(expected[-1], abs=1e-12)


def test_no_time_is_faster_than_the_fastest_which_is_reached():
    for row in any_way().rows:
        t = np.linspace(0.0, row[1], 1501)
        places = np.array([position_at(row, TRACKS, s)[:3] for s in t])
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(t)
        assert 0.999 * speeds.max() < fastest_on(row, TRACKS) > 0.0
        assert speeds.max() <= fastest_on(row, TRACKS) * (1.0 + 1e-9)
        assert speeds.max() >= fastest_on(row, TRACKS) * (1.0 - 1e-4)


@pytest.mark.parametrize("heading", [0.0, 0.7, -2.9, np.pi / 2])
@pytest.mark.parametrize("turn", [0.4, -0.4, 1.2, 0.0])
def test_the_extent_of_a_piece_is_that_of_all_its_positions(heading, turn):
    rows = any_way(heading).trim(20.0, 1.0, turn, 4.0).trim(0.0, 0.0, turn, 2.0).rows
    for row in rows:
        places = [position_at(row, TRACKS, s)[:3] for s in np.linspace(0.0, row[1], 2001)]
        low, high = np.min(places, axis=0), np.max(places, axis=0)
        expected = np.column_stack([low, high]).ravel()
        assert extent_of(row, TRACKS) == pytest.approx(expected, abs=1e-4)
        assert (np.array(extent_of(row, TRACKS))[::2] <= low + 1e-12).all()
        assert (np.array(extent_of(row, TRACKS))[1::2] >= high - 1e-12).all()


def test_tracks_are_joined_one_after_the_other():
    assert TRACKS.first.tolist() == np.cumsum([0, *(len(part) for part in PARTS)]).tolist()
    for k, part in enumerate(PARTS):
        assert np.array_equal(TRACKS.points[TRACKS.first[k] : TRACKS.first[k + 1]], part)
    assert TRACKS.fastest[0] == pytest.approx(20.0, rel=1e-4)
    assert not any(array.flags.writeable for array in TRACKS[:3])
    empty = joined_tracks([], DT)
    assert (len(empty.fastest), empty.points.shape) == (0, (0, 4))


def test_straight_pieces_of_a_track_stay_within_a_millimetre_of_the_flight():
    """Half-way between two states the curve is, to fourth order, where Hermite's cubic is."""
    library = default_library()
    for manoeuvre in library.manoeuvres:
        velocity = np.gradient(manoeuvre.states[:, :3], DT, axis=0, edge_order=2)
        beside = np.diff(velocity, axis=0) * DT / 8.0
        assert np.abs(beside).max() < 1e-3
