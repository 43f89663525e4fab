"""The kernels of SST against brute force and written-out definitions."""

import math

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sst_scene import GOAL, START, allowed, growth, ridge, rotations, setup_of

from ompl_risk._kernels import branch, draws, inner_loop, sst_tree
from ompl_risk._kernels.branch import least_cost
from ompl_risk._kernels.buckets import MARK, NONE, Buckets, least_near, nearest_within, put, take
from ompl_risk._kernels.inner_loop import ACT, HELD, PUSH, REACH
from ompl_risk._kernels.rigid_body import rollout
from ompl_risk.avoidance import InverseDistance
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.sst.habits import Habits
from ompl_risk.terrains import Terrain

WEIGHTS = np.array([1.0, 9.0, 1.0])

entry = numba.njit(error_model="numpy")  # not cached: the library drops only its own stale kernels


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


def apart(a, b):
    """The metric, by rotation matrices."""
    states = np.vstack([a, b])
    turns = rotations(states)
    angle = np.arccos(np.clip((np.trace(turns[0].T @ turns[1]) - 1.0) / 2.0, -1.0, 1.0))
    chord = 2.0 * math.sin(0.5 * angle)
    p, u, o = (((a - b)[part] ** 2).sum() for part in (slice(3), slice(7, 10), slice(10, 13)))
    return math.sqrt(p + WEIGHTS[0] * u + WEIGHTS[1] * chord**2 + WEIGHTS[2] * o)


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


def at_rest(x=20.0, y=60.0, z=60.0):
    return np.array([x, y, z, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6])


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


# the tree


def rows_in(buckets):
    found = []
    for head in buckets.first[buckets.first != NONE]:
        i = head
        while i != NONE:
            found.append(int(i))
            i = buckets.after[i]
    return sorted(found)


def check(grown):
    """Everything that must hold of a tree at any time."""
    tree = grown.tree
    a, rows = tree.arrays, tree.count(sst_tree.ROWS)
    witness, parent = a.witness[:rows], a.parent[:rows]
    there, active = np.flatnonzero(witness != sst_tree.FREE), np.flatnonzero(witness >= 0)
    assert tree.count(sst_tree.NODES) == len(there)
    assert tree.count(sst_tree.ACTIVE) == len(active)
    # each witness keeps at most one node, which is near it; each active node has one witness
    assert (a.keeper[witness[active]] == active).all()
    kept = a.keeper[: tree.count(sst_tree.WITNESSES)]
    assert sorted(kept[kept != NONE]) == active.tolist()
    radius = tree.pruning
    for i in active:
        assert apart(a.marks[i], a.spots[witness[i]]) <= radius * (1.0 + 1e-12)
    assert rows_in(a.nodes) == active.tolist()
    assert rows_in(a.witnesses) == list(range(tree.count(sst_tree.WITNESSES)))
    # no node without use; children are counted, and the best path is held on to
    pinned = np.zeros(rows, dtype=int)
    best = tree.count(sst_tree.BEST)
    if best != NONE:
        pinned[best] = 1
    counted = np.bincount(parent[there][parent[there] != NONE], minlength=rows) + pinned
    assert (counted[there] == a.children[there]).all()
    assert (a.children[there[witness[there] == NONE]] > 0).all()
    # parents cost less, so there is no cycle; starts cost nothing
    later = there[parent[there] != NONE]
    assert (witness[parent[later]] != sst_tree.FREE).all()
    assert (a.cost[later] > a.cost[parent[later]]).all()
    assert (a.cost[there[parent[there] == NONE]] == 0.0).all()
    return there, active


def grow(grown, iterations):
    done = grown.tree.count(sst_tree.ITERATIONS) + iterations
    while grown.tree.count(sst_tree.ITERATIONS) < done:
        grown.tree.grow(grown.draw, done - grown.tree.count(sst_tree.ITERATIONS))


@pytest.mark.parametrize("seed", [1, 2])
def test_a_tree_holds_together_as_it_grows(seed):
    grown = growth(seed=seed)
    for _ in range(4):
        grow(grown, 150)
        there, active = check(grown)
    assert len(there) > len(active) > 100


def test_nodes_are_where_their_branches_end():
    grown = growth(setup_of(risk=True))
    grow(grown, 300)
    there, _ = check(grown)
    problem, tree, _ = grown
    a = tree.arrays
    for i in there[a.parent[there] != NONE]:
        parent, n = a.parent[i], int(a.steps[i])
        controls, states = np.empty((n, 4)), np.empty((n, 13))
        steps, cost, room, _ = branch.fly_again(
            problem.vehicle, tree.handle, a.states[parent], a.room[parent], a.acts[i], n, controls,
            states,
        )  # fmt: skip
        assert steps == n
        assert (states[-1] == a.states[i]).all()
        assert a.cost[i] == a.cost[parent] + cost
        assert room == a.room[i]
        assert room <= problem.clearance(states[-1:, :3])[0] + 1e-9


def test_all_states_of_all_branches_are_allowed():
    grown = growth()
    grow(grown, 200)
    a, rows = grown.tree.arrays, grown.tree.count(sst_tree.ROWS)
    everything = []
    for i in np.flatnonzero((a.witness[:rows] != sst_tree.FREE) & (a.parent[:rows] != NONE)):
        n, parent = int(a.steps[i]), a.parent[i]
        states = np.empty((n, 13))
        branch.fly_again(
            grown.problem.vehicle, grown.tree.handle, a.states[parent], a.room[parent], a.acts[i],
            n, np.empty((0, 4)), states,
        )  # fmt: skip
        everything.append(states)
    assert allowed(np.concatenate(everything), ridge()).all()


def test_nothing_hopeless_stays_once_there_is_a_path():
    grown = growth()
    while grown.tree.count(sst_tree.BEST) == NONE:
        grown.tree.grow(grown.draw, 1000)
    _, active = check(grown)
    a, vehicle = grown.tree.arrays, grown.problem.vehicle
    assert len(active) > 20
    way = np.linalg.norm(a.states[active, :3] - vehicle.goal[:3], axis=1) - 5.0
    assert (a.cost[active] + np.maximum(way, 0.0) / 35.0 < grown.tree.cost).all()


@entry
def left_to_pay(vehicle, states, rooms, out):
    for k in range(len(states)):
        out[k] = least_cost(vehicle, states[k], rooms[k])


@pytest.mark.parametrize(
    "norm", [Lp(1), Lp(2), Lp(3), Sobolev(1), Sobolev(1, time_scale=3.0)], ids=lambda n: n.label
)
def test_no_flight_is_cheaper_than_the_bound(norm):
    setup = setup_of(risk=True, norm=norm, avoidance=InverseDistance(40.0))
    grown = growth(setup)
    problem, tree, draw = grown
    while not tree.grow(draw, 1000):
        pass
    states = tree.flight().states
    rooms, bounds = problem.clearance(states[:, :3]), np.empty(len(states))
    left_to_pay(problem.vehicle, states, rooms, bounds)
    costs = np.array([problem.cost(states[k:]) for k in range(len(states))])
    assert (bounds <= costs + 1e-15).all()
    assert bounds[len(bounds) // 2] > 0.0
    assert bounds[-1] == 0.0 or bounds[-1] < costs[-10]


def test_the_bound_of_the_duration_is_the_way_at_top_speed():
    problem = growth().problem
    out = np.empty(2)
    left_to_pay(problem.vehicle, np.array([at_rest(*START), at_rest(*GOAL)]), np.ones(2), out)
    assert out.tolist() == [pytest.approx(135.0 / 35.0, rel=1e-8), 0.0]


def test_thinning_keeps_what_promises_most():
    grown = growth()
    while not grown.tree.grow(grown.draw, 1000):
        pass
    grow(grown, 300)
    _, before = check(grown)
    a, vehicle = grown.tree.arrays, grown.problem.vehicle
    bound = np.empty(len(before))
    left_to_pay(vehicle, a.states[before], a.room[before], bound)
    hopes, best = a.cost[before] + bound, grown.tree.cost
    grown.tree.thin_out(0.4)
    _, after = check(grown)
    promising = before[np.argsort(hopes, kind="stable")[: int(0.6 * len(before))]]
    assert set(after) <= set(promising)
    for i in set(promising) - set(after):  # witnesses are chosen anew, and may stand for it too
        near = [k for k in after if apart(a.marks[i], a.marks[k]) <= grown.tree.pruning]
        assert min(a.cost[near]) <= a.cost[i]
    assert len(after) > 0.5 * len(before)
    assert grown.tree.cost == best
    assert len(grown.tree.flight().states) > 1


@pytest.mark.parametrize("factor", [0.7, 1.5])
def test_other_radii_keep_the_cheapest_of_those_that_are_near(factor):
    grown = growth(radii=(20.0, 5.0))
    grow(grown, 400)
    _, before = check(grown)
    a = grown.tree.arrays
    marks, costs = a.marks.copy(), a.cost.copy()
    grown.tree.scale(factor)
    _, active = check(grown)
    radius, kept = 5.0 * factor, []
    for i in before[np.argsort(costs[before], kind="stable")]:
        if all(apart(marks[i], marks[k]) > radius for k in kept):
            kept.append(int(i))
    assert active.tolist() == sorted(kept)
    grow(grown, 100)
    check(grown)


def test_a_full_tree_refuses_and_holds_together():
    grown = growth(most=60)
    grow(grown, 400)
    there, _ = check(grown)
    assert len(there) <= 60
    assert grown.tree.count(sst_tree.REFUSED) > 0


@entry
def offered(tree, state, mark, cost, wanted):
    return sst_tree.offer(tree, state, mark, np.zeros(ACT), 5, 0, cost, 10.0, wanted)


def test_a_witness_keeps_the_cheapest():
    grown = growth()
    tree, state = grown.tree, at_rest(60.0)
    first = offered(tree.arrays, state, state, 3.0, False)
    nearby = state.copy()
    nearby[0] += 1.0
    assert offered(tree.arrays, nearby, nearby, 4.0, False) == NONE
    better = offered(tree.arrays, nearby, nearby, 2.0, False)
    assert better != NONE
    assert tree.arrays.witness[first] in (NONE, sst_tree.FREE)
    away = state.copy()
    away[0] += 4.0  # farther than the radius of 3
    assert offered(tree.arrays, away, away, 9.0, False) != NONE
    assert tree.count(sst_tree.ACTIVE) == 3  # with the start
    check(grown)


def test_raw_inputs_alone_grow_a_tree_too():
    grown = growth(habits=Habits(held=1.0, pushed=0.0, shoot=0.0), radii=(30.0, 0.5))
    grow(grown, 400)
    there, _ = check(grown)
    acts = grown.tree.arrays.acts[there[1:]]
    assert len(acts) > 50
    assert (acts[:, 0] == HELD).all()
    middle, span = grown.problem.hover, 0.1 * (grown.problem.vehicle.high - grown.problem.hover)
    assert (acts[:, 1:5] <= middle + span).all()
