"""Problems: what is wrong is named before anything is planned."""

import math
import pickle

import numpy as np
import pytest

from ompl_risk.errors import ArgumentError
from ompl_risk.planners import Problem, low_level_flight
from ompl_risk.planners.low_level import HEADROOM

START, GOAL = (200.0, 1000.0), (2800.0, 1000.0)


def test_ends_are_above_the_ground_and_the_box_holds_them(clearance, wall):
    problem = low_level_flight(
        clearance, START, GOAL, start_height=70.0, goal_height=40.0, speed=20.0, margin=0.1
    )
    assert problem.start[2] == wall.height(*START) + 70.0
    assert problem.goal[2] == wall.height(*GOAL) + 40.0
    top = max(problem.start[2], problem.goal[2]) + HEADROOM
    assert problem.high[2] == math.ceil(top)
    np.testing.assert_allclose(problem.low, [0.0, 740.0, wall.heights.min()])
    np.testing.assert_allclose(problem.high[:2], [3000.0, 1260.0])


@pytest.mark.parametrize(
    ("argument", "value", "part"),
    [
        ("start", (-1.0, 1000.0), "within the terrain: x 0 to 3000 m"),
        ("goal", (200.0, 2001.0), "within the terrain"),
        ("goal", (200.0, 1000.0), "another place than start"),
        ("start", (math.nan, 0.0), "finite"),
        ("start", (1.0, 2.0, 3.0), "x, y"),
        ("start_height", 4.0, "in collision"),
        ("goal_height", 20.0, "too near to the ground"),
        ("start_height", -1.0, "positive"),
        ("ceiling", 59.0, "the ground at (200, 1000) m is at 0.0 m"),
        ("ceiling", math.inf, "positive finite"),
        ("margin", -0.1, "at least 0"),
        ("min_clearance", -1.0, "0 or more"),
        ("speed", 0.0, "positive"),
    ],
)
def test_wrong_arguments_are_named_with_what_is_allowed(clearance, argument, value, part):
    options = {"start": START, "goal": GOAL, "speed": 20.0, argument: value}
    with pytest.raises(ArgumentError) as caught:
        low_level_flight(clearance, options.pop("start"), options.pop("goal"), **options)
    assert caught.value.argument.split("[")[0].removesuffix(".shape") == argument
    assert part in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "argument"),
    [
        ({"high": (10.0, 10.0, -1.0)}, "high"),
        ({"start": (20.0, 1.0, 5.0)}, "start"),
        ({"goal": (1.0, 1.0, 0.5)}, "goal"),
        ({"goal": (1.0, 1.0, 5.0)}, "goal"),
    ],
)
def test_problems_over_any_clearance_are_checked(changes, argument):
    given = {
        "start": (1.0, 1.0, 5.0),
        "goal": (9.0, 9.0, 5.0),
        "low": (0.0, 0.0, 0.0),
        "high": (10.0, 10.0, 10.0),
        **changes,
    }
    with pytest.raises(ArgumentError) as caught:
        Problem(height, **given, speed=1.0, min_clearance=1.0)
    assert caught.value.argument == argument


def height(points):
    return np.asarray(points)[:, 2]


def test_obstacles_keep_the_margin(problem, clearance):
    points = np.array([[1500.0, 1000.0, 400.0], [100.0, 100.0, 60.0]])
    np.testing.assert_allclose(problem.obstacles(points), clearance(points) - 10.0, rtol=1e-12)
    plain = Problem(
        height, (1, 1, 5), (9, 9, 5), (0, 0, 0), (10, 10, 10), speed=1.0, min_clearance=2.0
    )
    np.testing.assert_allclose(plain.obstacles(points), points[:, 2] - 2.0)


def test_problems_survive_the_way_to_another_process(problem):
    copy = pickle.loads(pickle.dumps(problem))
    points = np.array([[1500.0, 1000.0, 400.0]])
    assert copy.clearance(points) == problem.clearance(points)
    np.testing.assert_array_equal(copy.start, problem.start)
    assert copy.avoidance == problem.avoidance
