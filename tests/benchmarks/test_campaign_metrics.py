"""Obstacles of the campaign's scenes, its objectives, and how paths are judged."""

import math
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from ompl import base as ob
from ompl import geometric as og

from benchmarks.campaign import metrics, obstacles
from benchmarks.campaign.metrics import BOUNDS, METRICS, is_sound, judge, least_clearance
from benchmarks.campaign.objectives import NORMS, OBJECTIVES
from benchmarks.campaign.obstacles import Columns, Forest, cylinders, scattered
from benchmarks.campaign.run import prepared
from benchmarks.campaign.scenes import MARGIN, SCENES, Scene
from ompl_risk import BallSampling, InverseDistance, MeshClearance, TerrainClearance
from ompl_risk.planners import Problem
from ompl_risk.terrains import Terrain

RNG = np.random.default_rng(11)
HEIGHT, D0, SPEED, ERROR = 40.0, 100.0, 30.0, 60.0


@pytest.fixture(scope="module")
def flat():
    """A flight 40 m above flat ground, for which everything has a formula."""
    clearance = TerrainClearance(Terrain(np.zeros((41, 41)), spacing=(50.0, 50.0)), threads=1)
    problem = Problem(
        clearance, (500.0, 500.0, HEIGHT), (1400.0, 500.0, HEIGHT), (0, 0, 0), (2000, 2000, 200),
        speed=SPEED, avoidance=InverseDistance(D0), min_clearance=10.0,
    )  # fmt: skip
    return Scene("flat", "", problem, {}, ERROR, BallSampling(4000, offsets="shared"))


def test_columns_are_the_distance_to_the_nearest_circle():
    columns = Columns([[0.0, 0.0, 1.0], [10.0, 0.0, 2.0]], radius=0.5)
    points = [[3.0, 4.0, 99.0], [7.0, 0.0, -5.0], [0.0, 0.0, 0.0]]
    assert columns(points) == pytest.approx([5.0 - 1.5, 3.0 - 2.5, -1.5])
    assert columns.of_point()(points) == pytest.approx([4.0, 1.0, -1.0])


def test_a_forest_is_its_meshes():
    circles = scattered(6, 20.0, (0.5, 1.5), 3, gap=1.0, clear=[[0.0, 0.0]], clear_radius=3.0)
    forest = Forest(circles, 9.0, 7, radius=0.4)
    points = RNG.uniform((-2, -2, -2), (22, 22, 12), (300, 3))
    points[:40, :2] = circles[RNG.integers(0, 6, 40), :2] + RNG.normal(0.0, 0.4, (40, 2))
    meshes = cylinders(circles, 9.0, 7)
    oracle = trimesh.util.concatenate(meshes)
    signed = -trimesh.proximity.signed_distance(oracle, points)  # positive outside
    assert forest(points) == pytest.approx(signed - 0.4, abs=1e-9)
    assert np.array_equal(forest(points), MeshClearance(meshes, 0.4)(points))
    assert np.count_nonzero(signed < 0.0) > 10
    assert np.array_equal(forest.of_point()(points), MeshClearance(meshes)(points))


def test_scattered_circles_keep_their_distances():
    clear = np.array([[5.0, 5.0], [45.0, 45.0]])
    circles = scattered(30, 50.0, (0.5, 2.0), 1, gap=1.5, clear=clear, clear_radius=4.0)
    assert circles.shape == (30, 3)
    assert ((circles[:, 2] >= 0.5) & (circles[:, 2] <= 2.0)).all()
    apart = np.hypot(*(circles[:, None, :2] - circles[None, :, :2]).transpose(2, 0, 1))
    apart -= circles[:, None, 2] + circles[None, :, 2] + np.diag(np.full(30, math.inf))
    assert apart.min() > 1.5 or np.isneginf(apart).sum() == 30
    np.fill_diagonal(apart, math.inf)
    assert apart.min() > 1.5
    assert Columns(circles)(np.column_stack([clear, [0.0, 0.0]])).min() > 4.0
    again = scattered(30, 50.0, (0.5, 2.0), 1, gap=1.5, clear=clear, clear_radius=4.0)
    assert np.array_equal(circles, again)


@pytest.mark.parametrize("name", SCENES)
def test_scenes_pose_a_dilemma(name):
    """The ends are safe, the straight way is not, and a scene is the same each time."""
    scene, problem = prepared(name), prepared(name).problem
    ends = np.array([problem.start, problem.goal])
    assert problem.clearance(ends).min() > 0.6 * problem.avoidance.d0
    assert least_clearance(problem.clearance, ends, 1e-3) < 0.3 * problem.avoidance.d0
    assert problem.min_clearance == pytest.approx(MARGIN * problem.avoidance.d0)
    other = SCENES[name]().problem
    assert np.array_equal(other.start, problem.start)
    points = RNG.uniform(problem.low, problem.high, (50, 3))
    assert np.array_equal(other.clearance(points), problem.clearance(points))
    assert scene.recipe
    assert scene.sampling.offsets == "shared"


corners = st.lists(
    st.tuples(st.floats(0, 20), st.floats(0, 20), st.floats(0, 3)), min_size=2, max_size=5
)


@settings(deadline=None, max_examples=60)
@given(corners)
def test_least_clearance_agrees_with_brute_force(points):
    path = np.array(points)
    columns = Columns([[5.0, 5.0, 2.0], [12.0, 9.0, 1.0], [3.0, 15.0, 3.0]])
    fine = np.concatenate(
        [a + np.linspace(0.0, 1.0, 2001)[:, None] * (b - a) for a, b in pairwise(path)]
    )
    step = np.linalg.norm(np.diff(path, axis=0), axis=1).max() / 2000
    found = least_clearance(columns, path, 1e-4)
    brute = columns(fine).min()
    assert brute - step <= found <= brute + 1e-4


def test_least_clearance_finds_what_lies_between_corners():
    path = np.array([[-50.0, 3.0, 0.0], [70.0, 3.0, 0.0]])
    assert least_clearance(Columns([[1.0, 0.0, 1.0]]), path, 1e-9) == pytest.approx(2.0)


def test_every_metric_of_a_level_flight(flat):
    t = 900.0 / SPEED
    f = 1 / HEIGHT - 1 / D0
    sound, values = judge(
        flat, np.array([flat.problem.start, [800, 500, HEIGHT], flat.problem.goal])
    )
    assert sound
    assert list(values) == [*METRICS, *BOUNDS]
    expected = {"duration": t, "L1": f * t, "L2": f * t**0.5, "L4": f * t**0.25, "Linf": f}
    expected |= dict.fromkeys(("H1(0.3)", "H1", "H1(3)"), f * t**0.5)
    assert {name: values[name] for name in expected} == pytest.approx(expected)
    assert values["clearance"] == pytest.approx(HEIGHT, abs=1e-2)
    u = HEIGHT / ERROR  # a spherical cap: the ball's share below a plane
    share = (1.0 - u) ** 2 * (2.0 + u) / 4.0
    assert values["pc max"] == pytest.approx(share, abs=2e-3)
    assert values["pc L2"] == pytest.approx(share * t**0.5, rel=0.02)
    assert values["pc L2 low"] <= values["pc L2"] <= values["pc L2 high"]
    assert values["pc ever low"] < share < values["pc ever high"]  # one error for a level flight
    assert values["pc ever high"] - values["pc ever low"] < 0.04


def test_time_scales_differ_where_f_changes(flat):
    path = np.array([flat.problem.start, [950.0, 500.0, 60.0], flat.problem.goal])
    values = judge(flat, path)[1]
    d = np.linspace(40.0, 60.0, 200_001)
    leg = math.hypot(450.0, 20.0) / SPEED
    f = 1 / d - 1 / D0
    square = 2 * leg * float(np.mean(f**2))
    slope = 2 * leg * float(np.mean((20.0 / leg / d**2) ** 2))
    for name, tau in (("H1(0.3)", 0.3), ("H1", 1.0), ("H1(3)", 3.0)):
        assert values[name] == pytest.approx(math.sqrt(square + tau**2 * slope), rel=1e-3)


@pytest.mark.parametrize(
    "path",
    [
        [(500, 500, 40), (900, 500, 5), (1400, 500, 40)],  # nearer than the least clearance
        [(500, 500, 40), (900, 500, -20), (1400, 500, 40)],  # below the ground
        [(500, 500, 40), (900, 500, 250), (1400, 500, 40)],  # above the box
        [(500, 500, 40), (1300, 500, 40)],  # not to the goal
        [(510, 500, 40), (1400, 500, 40)],  # not from the start
    ],
)
def test_what_planners_must_not_call_a_path(flat, path):
    assert not is_sound(flat, np.array(path, dtype=float))


def test_a_path_in_collision_has_infinite_risk(flat):
    sound, values = judge(flat, np.array([(500, 500, 40), (900, 500, -20), (1400, 500, 40)], float))
    assert not sound
    assert all(values[name] == math.inf for name in NORMS)
    assert values["clearance"] == pytest.approx(-20.0, abs=0.1)


def path_cost(name, problem, corners):
    """Cost of a path by OMPL's objective of that name, and the objective."""
    space, bounds = ob.RealVectorStateSpace(3), ob.RealVectorBounds(3)
    for k in range(3):
        bounds.setLow(k, float(problem.low[k]))
        bounds.setHigh(k, float(problem.high[k]))
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    si.setStateValidityChecker(lambda _: True)
    si.setup()
    path = og.PathGeometric(si)
    for corner in corners:
        state = si.allocState()
        state[0:3] = [float(x) for x in corner]
        path.append(state)
    return path.cost(OBJECTIVES[name].build(si, problem)).value()


def free_path(problem, rng):
    """Start and goal with corners between them, such that the way is free."""
    while True:
        between = rng.uniform(problem.low, problem.high, (2, 3))
        path = np.vstack([problem.start, between, problem.goal])
        if least_clearance(problem.clearance, path, 1e-3) > 0.05:
            return path


@pytest.mark.parametrize("seed", range(4))
def test_objectives_count_what_they_say(seed):
    """The value of each objective is the metric of the same name, from the path alone."""
    columns = Columns([[20.0, 22.0, 6.0], [31.0, 9.0, 4.0], [9.0, 30.0, 3.0]], radius=0.5)
    problem = Problem(
        columns, (2, 2, 1), (38, 38, 1), (0, 0, 0), (40, 40, 2), speed=5.0,
        avoidance=InverseDistance(8.0), min_clearance=0.8,
    )  # fmt: skip
    scene = Scene("few", "", problem, {}, 4.0, BallSampling(10, offsets="shared"))
    path = free_path(problem, np.random.default_rng(seed))
    values = metrics._risk(scene, metrics.Trajectory.at_constant_speed(path, problem.speed))
    for name, objective in OBJECTIVES.items():
        cost = path_cost(name, problem, path)
        value = objective.value(cost, objective.recipe(problem))
        assert objective.value(1.01 * cost, objective.recipe(problem)) > value
        if name in NORMS:
            assert value == pytest.approx(values[name], rel=0.02), name
        if name == "length":
            assert value == pytest.approx(values["duration"] * problem.speed, rel=1e-9)
        if name == "time+risk":
            weight = (1 / 2.0 - 1 / 8.0) ** 2  # d1 = d0 / 4 = 2 m
            expected = values["H1"] ** 2 + weight * values["duration"]
            assert value == pytest.approx(expected, rel=0.02)
        if name == "clearance":
            least = least_clearance(problem.clearance, path, 1e-6)
            assert value == pytest.approx(-least, rel=0.02)


def test_least_clearance_matters_beyond_d0():
    """Two ways that both stay d0 away are equal to the norms, but not to this objective."""
    problem = Problem(
        Columns([[0.0, 0.0, 1.0]]), (-40.0, 30.0, 1.0), (40.0, 30.0, 1.0), (-90, -90, 0),
        (90, 90, 2), speed=1.0, avoidance=InverseDistance(5.0),
    )  # fmt: skip
    near = [problem.start, (0.0, 20.0, 1.0), problem.goal]
    far = [problem.start, (0.0, 28.0, 1.0), problem.goal]
    assert path_cost("Linf", problem, near) == path_cost("Linf", problem, far) == 0.0
    objective, recipe = OBJECTIVES["clearance"], OBJECTIVES["clearance"].recipe(problem)
    values = [
        objective.value(path_cost("clearance", problem, path), recipe) for path in (near, far)
    ]
    exact = [
        -least_clearance(problem.clearance, np.array(path, float), 1e-9) for path in (near, far)
    ]
    assert values == pytest.approx(exact, rel=0.01)
    assert recipe["D"] == pytest.approx(2.0 * 49.0)
    assert obstacles.Columns([[0.0, 0.0, 1.0]])([problem.start]) == pytest.approx([49.0])
