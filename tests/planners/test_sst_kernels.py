"""The kernels of SST against brute force and written-out definitions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sst_kernel_pieces import WEIGHTS, apart, at_rest, entry
from sst_scene import GOAL, START, allowed, growth, ridge, rotations, setup_of

from ompl_risk._kernels import branch, draws, inner_loop
from ompl_risk._kernels.buckets import MARK, NONE, Buckets, least_near, nearest_within, put, take
from ompl_risk._kernels.inner_loop import ACT, HELD, PUSH, REACH
from ompl_risk._kernels.rigid_body import rollout
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain

# random numbers


def test_random_numbers_are_those_of_splitmix64():
    published = [6457827717110365317, 3203168211198807973, 9817491932198370423]
    seed, out = np.array([1234567], dtype=np.uint64), np.empty(3)
    draws.fill(seed, out)
    assert out.tolist() == [(z >> 11) * 2.0**-53 for z in published]


def test_random_numbers_are_spread_evenly():
    out = np.empty(100_000)
    draws.fill(np.array([3], dtype=np.uint64), out)
    counts = np.histogram(out, 50, (0.0, 1.0))[0]
    assert ((counts - 2000.0) ** 2 / 2000.0).sum() < 100.0  # chi-squared of 49: 1e-5
    assert abs(np.corrcoef(out[:-1], out[1:])[0, 1]) < 0.015


@entry
def balls(seed, radius, out):
    for k in range(len(out)):
        out[k, 0], out[k, 1], out[k, 2] = draws.in_ball(seed, radius)


def test_points_fill_a_ball_evenly():
    points = np.empty((20_000, 3))
    balls(np.array([5], dtype=np.uint64), 2.0, points)
    r = np.linalg.norm(points, axis=1)
    assert r.max() <= 2.0
    inner = (r < 1.0).mean()  # an eighth of the volume
    assert inner == pytest.approx(0.125, abs=0.01)
    assert np.abs(points.mean(axis=0)).max() < 0.03


# buckets


def marks_of(rng, n, spread=30.0):
    marks = rng.normal(0.0, 1.0, (n, MARK))
    marks[:, :3] = rng.uniform(-0.2, 1.2, (n, 3)) * spread  # some outside of all buckets
    marks[:, 3:7] /= np.linalg.norm(marks[:, 3:7], axis=1, keepdims=True)
    marks[:, 7:10] *= 5.0
    return marks


@entry
def put_and_take(buckets, marks, gone):
    for i in range(len(marks)):
        put(buckets, i, marks[i])
    for i in gone:
        take(buckets, i, marks[i])


@entry
def searched(buckets, marks, costs, mark, radius, weights):
    return (
        nearest_within(buckets, marks, mark, radius, weights),
        least_near(buckets, marks, costs, mark, radius, weights),
    )


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 60), st.floats(0.5, 60.0), st.floats(2.0, 40.0))
def test_searches_in_buckets_are_those_among_all(seed, n, radius, edge):
    rng = np.random.default_rng(seed)
    marks, costs, mark = marks_of(rng, n), rng.uniform(size=n), marks_of(rng, 1)[0]
    side = max(math.ceil(30.0 / edge), 1)
    buckets = Buckets(
        np.array([0.0, 0.0, 0.0, edge]), np.full((side, side, side), NONE, dtype=np.int32),
        np.empty(n, dtype=np.int32), np.empty(n, dtype=np.int32),
    )  # fmt: skip
    gone = rng.permutation(n)[: n // 3].astype(np.int32)
    put_and_take(buckets, marks, gone)
    left = np.setdiff1d(np.arange(n), gone)
    d = np.array([apart(marks[i], mark) for i in left])
    near = left[d <= radius]
    nearest, least = searched(buckets, marks, costs, mark, radius, WEIGHTS)
    assert nearest == (left[np.argmin(d)] if len(near) else NONE)
    assert least == (near[np.argmin(costs[near])] if len(near) else left[np.argmin(d)])


# inner loop


@entry
def command(act, state, vehicle, out):
    inner_loop.inputs(act, state, vehicle.given, vehicle.low, vehicle.high, vehicle.loop, out)


@pytest.fixture(scope="module")
def open_sky():
    """A tree over ground that is far below."""
    high = setup_of(ridge(0.1), start=(20.0, 60.0, 60.0), goal=(180.0, 60.0, 60.0))
    return growth(high)


def flown(grown, act, steps, state=None, room=50.0):
    """States (n + 1, 13), inputs (n, 4), and what ``fly`` returns."""
    problem, tree, _ = grown
    begin = at_rest() if state is None else state
    controls, states = np.empty((steps, 4)), np.empty((steps, 13))
    act = np.array([*act, *[0.0] * (ACT - len(act))])
    said = branch.fly_again(problem.vehicle, tree.handle, begin, room, act, steps, controls, states)
    n = said[0]
    return np.vstack([begin, states[:n]]), controls[:n], said


def test_held_inputs_are_held(open_sky):
    control = open_sky.problem.hover + np.array([1.0, 0.1, 0.001, -0.001])
    states, controls, said = flown(open_sky, [HELD, *control], 40)
    assert (controls == control).all()
    assert said[0] == 40
    again = np.empty((41, 13))
    rollout(at_rest(), controls, 0.02, open_sky.problem.vehicle.given, again)
    assert (states == again).all()


@pytest.mark.parametrize("push", [(4.0, 0.0, 0.0), (0.0, -6.0, 1.0), (-3.0, 3.0, -2.0)])
def test_a_push_accelerates_as_it_says(open_sky, push):
    begin = at_rest(100.0)
    states, _, _ = flown(open_sky, [PUSH, *push], 75, state=begin)
    velocity = np.einsum("nij,nj->ni", rotations(states), states[:, 7:10])
    mean = (velocity[75] - velocity[50]) / 0.5
    assert mean == pytest.approx(push, abs=0.2)


def test_reaching_gets_there_and_stops(open_sky):
    place = (60.0, 70.0, 55.0)
    states, _, said = flown(open_sky, [REACH, *place, 0.0, 0.0, 0.0, 4.0], 1000)
    assert said[0] == 1000
    assert states[-1, :3] == pytest.approx(place, abs=0.5)
    assert np.linalg.norm(states[-1, 7:10]) < 0.5
    assert allowed(states, ridge(0.1)).all()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_inputs_keep_to_their_range(open_sky, seed):
    rng = np.random.default_rng(seed)
    vehicle = open_sky.problem.vehicle
    state = marks_of(rng, 1)[0]
    kind, out = rng.choice([PUSH, REACH]), np.empty(4)
    command(
        np.array([kind, *rng.normal(0.0, 20.0, 6), rng.uniform(0.1, 10.0)]), state, vehicle, out
    )
    assert (out >= vehicle.low).all()
    assert (out <= vehicle.high).all()


# branches


def test_a_branch_ends_where_the_goal_begins(open_sky):
    goal = (180.0, 60.0, 60.0)
    states, _, said = flown(open_sky, [REACH, *goal, 0.0, 0.0, 0.0, 3.0], 2000)
    steps, cost, _, reached = said
    assert reached
    assert cost == pytest.approx(0.02 * steps, rel=1e-12)
    away = np.linalg.norm(states[:, :3] - goal, axis=1)
    speed = np.linalg.norm(states[:, 7:10], axis=1)
    assert ((away <= 5.0) & (speed <= 2.0)).tolist() == [False] * steps + [True]


def test_a_branch_into_the_ridge_is_not_allowed():
    grown = growth()
    said = flown(grown, [REACH, *GOAL, 0.0, 0.0, 0.0, 3.0], 2000, state=at_rest(*START))[2]
    assert said[0] == 0
    lowest = [START[0], START[1], -5.0]
    assert (
        flown(grown, [REACH, *lowest, 0.0, 0.0, 0.0, 3.0], 2000, state=at_rest(*START))[2][0] == 0
    )


def test_no_blade_is_jumped_over_between_two_steps():
    heights = np.zeros((13, 1001))
    heights[:, 500] = 60.0  # 0.4 m wide at its foot, less higher up; a step is 0.66 m long
    grown = growth(setup_of(Terrain(heights, spacing=(0.2, 10.0)), body=0.01))
    for x in np.linspace(90.0, 90.66, 40):
        state = at_rest(x, z=55.0)
        state[7] = 33.0
        assert flown(grown, [HELD, *grown.problem.hover], 10, state=state, room=9.0)[2][0] == 10
        assert flown(grown, [HELD, *grown.problem.hover], 25, state=state, room=9.0)[2][0] == 0


@pytest.mark.parametrize(
    "norm", [Lp(1), Lp(2), Lp(3.5), Sobolev(1), Sobolev(1, time_scale=2.0)], ids=lambda n: n.label
)
def test_the_cost_of_a_branch_is_the_power_of_the_norm(norm):
    grown = growth(setup_of(risk=True, norm=norm))
    problem, tree, _ = grown
    act, begin = [REACH, 60.0, 40.0, 25.0, 0.0, 0.0, 0.0, 4.0], at_rest(*START)
    room = branch.first_room(problem.vehicle, tree.handle, begin)
    states, _, said = flown(grown, act, 200, state=begin, room=room)
    assert len(states) == 201
    d = problem.clearance(states[:, :3])
    t, f = 0.02 * np.arange(201), np.where(d < 100.0, 1.0 / d - 0.01, 0.0)
    assert said[1] == pytest.approx(norm.power(t, f) + problem.risk.weight * 4.0, rel=1e-9)
    assert problem.cost(states) == pytest.approx(said[1], rel=1e-9)
