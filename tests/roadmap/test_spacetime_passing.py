"""Vehicles that cannot wait: what the search leaves out is of no use, and costs nothing."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox
from ompl_risk.planners.spacetime.earliest import arrive_first, earliest_arrival
from ompl_risk.planners.spacetime.network import Network
from ompl_risk.planners.spacetime.stays import Hovering, Passing

SPEED, OPENS, HORIZON = 10.0, 12.0, 40.0


class Exhaustive(Passing):
    """Looks at every flight whose bin has not been reached."""

    def land(self, key, time):
        pass


def scattered(seed, n=60, neighbours=8):
    """Places at random, each connected with those next to it; 0 and 1 are on either side."""
    rng = np.random.default_rng(seed)
    places = np.vstack([[10.0, 50, 50], [90.0, 50, 50], rng.uniform(0.0, 100.0, (n, 3))])
    near = cKDTree(places).query(places, neighbours)[1]
    return Network(places, [(i, j) for i, row in enumerate(near) for j in row])


def door(opens=OPENS):
    """A wall between the two sides that rises out of the way."""
    lifted = [[50.0, 50, 140], [50.0, 50, 140], [50.0, 50, 400]]
    box = MovingBox([10, 300, 300], [0.0, opens, opens + 10.0], lifted)
    return MovingClearance(box, radius=1.0)


def first(network, clearance, stays, latest=HORIZON):
    return arrive_first(
        network, clearance, [(0, 0.0)], [1], speed=SPEED, latest=latest, stays=stays
    )


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("bin", [0.3, 1.0, 4.0])
def test_flights_that_are_late_would_change_nothing(seed, bin):  # noqa: A002
    network, clearance = scattered(seed), door()
    waiting = first(network, clearance, Hovering())
    assert waiting.route.waits
    every = first(network, clearance, Exhaustive(bin))
    found = first(network, clearance, Passing(bin))
    assert (found.route is None) == (every.route is None)
    assert found.labels == every.labels
    if every.route is not None:
        np.testing.assert_array_equal(found.route.positions, every.route.positions)
        np.testing.assert_array_equal(found.route.times, every.route.times)
    looked = [one.evaluated - waiting.evaluated for one in (found, every)]
    assert looked[0] < 0.8 * looked[1]


def test_arrivals_are_late_after_another_in_the_same_bin():
    stays = Passing(0.5)
    assert not stays.is_late(3, 1.2)
    stays.land((3, 2), 1.2)
    assert [stays.is_late(3, time) for time in (0.9, 1.1, 1.2, 1.4, 1.5)] == [
        False, False, True, True, False,
    ]  # fmt: skip
    stays.land((3, 2), 1.4)  # no better than the one before
    assert stays.is_late(3, 1.3)
    assert not stays.is_late(4, 1.3)
    stays.reached.add((3, 2))
    assert stays.is_late(3, 1.0)
    assert not Hovering().is_late(3, 1.2)


@pytest.mark.parametrize("seed", range(4))
def test_where_not_even_waiting_helps_nothing_else_is_tried(seed):
    network, clearance = scattered(seed), door(opens=500.0)
    options = {"speed": SPEED, "horizon": 60.0}
    waiting = earliest_arrival(network, clearance, 0, 1, **options)
    found = earliest_arrival(network, clearance, 0, 1, can_wait=False, bin=0.1, **options)
    assert found.route is None
    assert found.reason == waiting.reason
    assert (found.labels, found.evaluated) == (waiting.labels, waiting.evaluated)


@pytest.mark.parametrize("seed", range(4))
def test_where_waiting_is_of_no_use_the_arrival_is_the_earliest_of_all(seed):
    network, clearance = scattered(seed), door(opens=0.1)
    options = {"speed": SPEED, "horizon": 60.0}
    waiting = earliest_arrival(network, clearance, 0, 1, depart=20.0, **options)
    assert waiting.route.waits == ()
    found = earliest_arrival(
        network, clearance, 0, 1, depart=20.0, can_wait=False, bin=30.0, **options
    )
    np.testing.assert_array_equal(found.route.times, waiting.route.times)
    np.testing.assert_array_equal(found.route.positions, waiting.route.positions)
    assert (found.labels, found.evaluated) == (waiting.labels, waiting.evaluated)
