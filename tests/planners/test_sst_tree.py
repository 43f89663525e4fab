"""SST's tree, compiled: it holds together as it grows, thins out and is full."""

import numpy as np
import pytest
from sst_kernel_pieces import apart, at_rest, entry, left_to_pay
from sst_scene import GOAL, START, allowed, growth, ridge, setup_of

from ompl_risk._kernels import branch, sst_tree
from ompl_risk._kernels.buckets import NONE
from ompl_risk._kernels.inner_loop import ACT, HELD
from ompl_risk.avoidance import FlatCap, GaussianTail, InverseDistance
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.sst.habits import Habits


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


@pytest.mark.parametrize(
    "norm", [Lp(1), Lp(2), Lp(3), Sobolev(1), Sobolev(1, time_scale=3.0)], ids=lambda n: n.label
)
@pytest.mark.parametrize("f", [InverseDistance(40.0), FlatCap(40.0), GaussianTail(10.0)], ids=repr)
def test_no_flight_is_cheaper_than_the_bound(f, norm):
    problem, tree, draw = growth(setup_of(risk=True, norm=norm, avoidance=f))
    while not tree.grow(draw, 1000):
        pass
    states = tree.flight().states
    rooms, bounds = problem.clearance(states[:, :3]), np.empty(len(states))
    left_to_pay(problem.vehicle, states, rooms, bounds)
    costs = np.array([problem.cost(states[k:]) for k in range(len(states))])
    assert (bounds <= costs + 1e-15).all()
    assert bounds[len(bounds) // 2] > 1e-3 * costs[len(bounds) // 2]
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
