"""What earliest routes are searched in: networks and numbers that make sense."""

import math

import numpy as np
import pytest
from moving_balls import Balls

from ompl_risk.clearance.terrain import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.planners.spacetime.earliest import earliest_arrival
from ompl_risk.planners.spacetime.network import Network
from ompl_risk.planners.spacetime.route import TimedRoute
from ompl_risk.terrains import Terrain

FAR = Balls(([1e6, 0, 0], [0, 0, 0], 1.0))
LINE = Network([[0, 0, 0], [5, 0, 0], [10, 0, 0]], [[0, 1], [1, 2]])

NAN = float("nan")


@pytest.mark.parametrize(
    ("wrong", "argument"),
    [
        ({"clearance": TerrainClearance(Terrain(np.zeros((2, 2)), spacing=(1, 1)))}, "clearance"),
        ({"start": 3}, "start"),
        ({"start": True}, "start"),
        ({"start": 0.0}, "start"),
        ({"goal": -1}, "goal"),
        ({"goal": [1, 7]}, "goal"),
        ({"goal": []}, "goal"),
        ({"goal": 1.5}, "goal"),
        ({"speed": 0.0}, "speed"),
        ({"speed": NAN}, "speed"),
        ({"horizon": math.inf}, "horizon"),
        ({"horizon": 0.0}, "horizon"),
        ({"depart": NAN}, "depart"),
        ({"depart": 60.0}, "horizon"),
        ({"resolution": 0.0}, "resolution"),
        ({"bin": -1.0, "can_wait": False}, "bin"),
    ],
)
def test_refuses_what_makes_no_sense(wrong, argument):
    arguments = {"clearance": FAR, "start": 0, "goal": 2, "speed": 1.0, "horizon": 50.0, **wrong}
    with pytest.raises(ArgumentError, match=rf"^{argument} = "):
        earliest_arrival(LINE, **arguments)


@pytest.mark.parametrize(
    ("places", "edges", "argument"),
    [
        ([[0, 0]], [], "places.shape"),
        ([[0, 0, NAN]], [], "places"),
        ([[0, 0, 0], [1, 0, 0]], [[0, 2]], "edges"),
        ([[0, 0, 0], [1, 0, 0]], [[0, -1]], "edges"),
        ([[0, 0, 0], [1, 0, 0]], [[0, 0.5]], "edges"),
        ([[0, 0, 0], [1, 0, 0]], [[0, NAN]], "edges"),
        ([[0, 0, 0], [1, 0, 0]], [[0, 1, 1]], "edges.shape"),
        ([[0, 0, 0], [1, 0, 0]], "ab", "edges"),
    ],
)
def test_refuses_a_network_that_is_none(places, edges, argument):
    with pytest.raises(ArgumentError) as caught:
        Network(places, edges)
    assert caught.value.argument.startswith(argument)


def test_a_network_counts_edges_once_in_either_direction():
    network = Network([[0, 0, 0], [3, 4, 0], [0, 1, 0]], [[0, 1], [1, 0], [0, 1], [2, 2], [2, 0]])
    pairs = sorted(zip(network.source.tolist(), network.target.tolist(), strict=True))
    assert pairs == [(0, 1), (0, 2), (1, 0), (2, 0)]
    assert network.first.tolist() == [0, 2, 3, 4]
    assert network.lengths_to_go([1]).tolist() == [5.0, 0.0, 6.0]
    assert Network([[0, 0, 0]], []).lengths_to_go([0]).tolist() == [0.0]


def test_a_route_of_one_place_has_no_waits():
    assert TimedRoute(np.zeros((1, 3)), np.zeros(1)).waits == ()
