"""Climbs and hover in connections: what is flown between different heights, and on a spot."""

import math

import numpy as np
import pytest
from connecting import assert_flies, connected
from toy_primitives import ToyLibrary, bent, likely

from ompl_risk._kernels import connect_tables as columns
from ompl_risk._kernels import pieces as piece
from ompl_risk.helicopter.tables import connect_tables

TOY = ToyLibrary(likely)
TABLES = connect_tables(TOY, longest_ratio=1e6)


def climbs_of(pieces):
    """Climb rates of the trims, in order."""
    trims = pieces[pieces[:, piece.KIND] == piece.TRIM]
    return [rate for rate in trims[:, piece.CLIMB].tolist() if rate]


@pytest.mark.parametrize(
    ("rise", "rates"), [(15.0, [2.0]), (-15.0, [-2.0]), (50.0, [6.0]), (-50.0, [-6.0]), (0.0, [])]
)
def test_the_gentlest_climb_that_fits_is_flown(rise, rates):
    only = TABLES._replace(cruise=np.array([2]))
    a, b = np.array([0, 0, 50, 0, 2.0]), np.array([300, 0, 50 + rise, 0, 2.0])
    pieces, duration = connected(only, a, b)
    assert climbs_of(pieces) == rates
    assert_flies(TOY, a, b, pieces, duration)
    # up at once and down late: high in between
    level = pieces[(pieces[:, piece.CLIMB] == 0.0) & (pieces[:, piece.KIND] == piece.TRIM)]
    assert level[:, piece.Z] == pytest.approx(max(50.0, 50.0 + rise))


def test_a_gentle_climb_is_flown_though_a_steep_one_saves_time():
    hasty = bent(lambda a, b: [3.0 * (max(abs(a[1]), abs(b[1])) == 6.0), 0.0, 0.0, 0.0])
    tables = connect_tables(hasty, cruise=[20.0])
    a, b = np.array([0, 0, 50, 0, 2.0]), np.array([300, 0, 60, 0, 2.0])
    pieces, duration = connected(tables, a, b)
    assert climbs_of(pieces) == [2.0]
    assert_flies(hasty, a, b, pieces, duration)
    climbs = tables.climbs.copy()
    climbs[:, :, 0, columns.CLIMB_TIME] = np.inf
    assert connected(tables._replace(climbs=climbs), a, b)[1] < duration


def test_too_steep_is_no_way_and_slower_flight_climbs_steeper():
    a, b = np.array([0, 0, 0, 0, 1.0]), np.array([300, 0, 100, 0, 1.0])
    fast, slow = (TABLES._replace(cruise=np.array([k]), longest_ratio=1.0) for k in (3, 1))
    assert connected(fast, a, b)[1] > 100.0 / 6.0 + 3.0  # a detour that gives time to climb
    assert climbs_of(connected(slow, a, b)[0]) == [6.0]
    climbs = TABLES.climbs.copy()
    climbs[..., columns.CLIMB_TIME] = np.inf
    assert connected(TABLES._replace(climbs=climbs), a, b) == (
        pytest.approx(np.empty((0, 10))),
        math.inf,
    )


@pytest.mark.parametrize("rise", [0.2, -0.2, 1e-6, 1e-9])
@pytest.mark.parametrize("higher", [0.0, 0.3, -0.3])
def test_small_changes_of_height_go_up_and_down_again(rise, higher):
    uneven = bent(lambda a, b: [0.0, 0.0, higher * (max(a[1], b[1]) > 0.0), 0.0])
    a, b = np.array([0, 0, 50, 0, 3.0]), np.array([400, 0, 50 + rise, 0, 3.0])
    pieces, duration = connected(connect_tables(uneven), a, b)
    numbers = pieces[pieces[:, piece.KIND] == piece.MANOEUVRE, piece.NUMBER]
    climbs = [uneven.manoeuvres[int(n)] for n in numbers]
    assert [m.last[1] for m in climbs] == [2.0, 0.0, -2.0, 0.0]
    assert len(climbs_of(pieces)) == 1  # one of them held
    assert_flies(uneven, a, b, pieces, duration)


def test_hover_leads_straight_up_and_down():
    a, b = np.array([0, 0, 50, 0.5, 0.0]), np.array([0, 0, 80, 0.5, 0.0])
    pieces, duration = connected(TABLES, a, b)
    assert climbs_of(pieces) == [2.0]
    assert duration > 15.0
    assert_flies(TOY, a, b, pieces, duration)
    pieces, duration = connected(TABLES, b, a)
    assert_flies(TOY, b, a, pieces, duration)


def test_turning_on_the_spot_is_a_way_if_manoeuvres_stay_on_it():
    a, b = np.array([0, 0, 50, 0.5, 0.0]), np.array([0, 0, 50, 2.5, 0.0])
    pieces, duration = connected(TABLES, a, b)
    assert_flies(TOY, a, b, pieces, duration)
    assert duration == pytest.approx(2.0 / 0.8, abs=2.0)

    def straying(first, last):
        time, displacement = likely(first, last)
        stray = 0.01 if first[0] == last[0] == 0.0 and first[2] != last[2] else 0.0
        return time, np.add(displacement, [stray, 0.0, 0.0, 0.0])

    tables = connect_tables(ToyLibrary(straying))
    assert connected(tables, a, b)[1] == math.inf
    far = np.array([200, 30, 50, 2.5, 0.0])
    assert_flies(ToyLibrary(straying), a, far, *connected(tables, a, far))
