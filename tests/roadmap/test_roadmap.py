"""Routes of the roadmap against eager evaluation, dense sampling and python-fcl."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scene import CEILING, D0, SPEED, box, counted, ends, hills, roadmap

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import MeshClearance, TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.roadmap.gate import ClearanceGate, Gate
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

NORMS = [Lp(1), Lp(2), Lp(4), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]
names = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


def all_exact(made):
    """The same graph with every edge evaluated."""
    tail, head = np.sort(made.edges.ends(), axis=0)
    risk = made.motions.costs(made.states[tail], made.states[head])
    risk[~made.gate.allows_motions(made.states[tail], made.states[head])] = math.inf
    return Graph.of_edges(
        made.n, np.column_stack([tail, head]), risk, made.edges.duration, maximum=made.maximum
    )


@names
@pytest.mark.parametrize("weight", [None, "of a second at 20 m"])
def test_lazy_search_finds_what_evaluating_every_edge_finds(norm, weight):
    if math.isinf(norm.exponent) and weight:
        pytest.skip("a maximum and a weight of time do not mix")
    value = None if weight is None else float(InverseDistance(D0)(20.0)) ** norm.exponent
    made = roadmap(counted(norm, value))
    costs = []
    for _ in range(3):
        made.grow(120)
        found = made.search()
        graph = all_exact(made)
        total = graph.risk if made.maximum else graph.risk + made.risk.weight * graph.duration
        tree = graph.tree(made.starts, total, maximum=made.maximum)
        best = tree.distance[made.goals[0]]
        assert found.cost == pytest.approx(best, rel=1e-12)
        if made.maximum:  # the fastest among those of least maximum
            within = np.where(graph.risk <= best, graph.duration, math.inf)
            least = graph.tree(made.starts, within).distance[made.goals[0]]
            assert found.duration == pytest.approx(least, rel=1e-12)
        costs.append(found.cost)
    assert costs == sorted(costs, reverse=True)
    assert made.evaluated < made.edges.m / 2


@names
def test_cost_of_a_route_is_the_norm_recomputed_from_its_path(norm):
    made = roadmap(counted(norm))
    made.grow(400)
    route = made.search()
    path = Trajectory.at_constant_speed(route.states, SPEED).densify(0.02)
    d = TerrainClearance(hills(), 2.0)(path.positions)
    expected = norm.power(path.t, InverseDistance(D0)(d))
    assert route.risk == pytest.approx(expected, rel=1e-2)
    assert route.duration == pytest.approx(path.duration, rel=1e-12)
    start, goal = ends(hills())
    np.testing.assert_array_equal(route.states[[0, -1]], [start, goal])
    low, high = box(hills())
    assert (route.states >= low).all()
    assert (route.states <= high).all()


@pytest.mark.parametrize("seed", range(5))
def test_routes_are_free_by_python_fcl_on_the_mesh(seed):
    terrain = hills(seed)
    made = roadmap(terrain=terrain, seed=seed)
    made.grow(300)
    route = made.search()
    path = Trajectory.at_constant_speed(route.states, SPEED).densify(0.5).positions
    mesh = MeshClearance([terrain.surface()], 2.0, surfaces=True)
    assert mesh(path).min() > 0.0
    assert (path[:, 2] > terrain.height(path[:, 0], path[:, 1])).all()


def test_a_gate_keeps_the_distance_that_it_asks_for():
    terrain = hills(relief=45.0)
    clearance = TerrainClearance(terrain, 2.0)
    gate = ClearanceGate(motion_batch(clearance.with_radius(11.0), Risk(speed=1.0)))
    least = []
    for each in (gate, None):
        made = roadmap(counted(weight=10.0), gate=each, terrain=terrain)  # time matters most
        made.grow(800)
        path = Trajectory.at_constant_speed(made.search().states, SPEED).densify(0.2)
        least.append(clearance(path.positions).min())
    assert least[1] < 9.0 <= least[0]


def test_a_foreign_gate_is_respected_in_states_and_motions():
    class West(Gate):
        """Keeps out of the east half but for a gap."""

        def allows_states(self, states):
            return (np.abs(states[:, 0] - 500.0) > 50.0) | (states[:, 1] > 700.0)

        def allows_motions(self, a, b):
            s = np.linspace(0.0, 1.0, 201)[:, None, None]
            return self.allows_states((a + s * (b - a)).reshape(-1, 3)).reshape(201, -1).all(0)

    made = roadmap(gate=West())
    assert not made.compiled
    made.grow(500)
    route = made.search()
    path = Trajectory.at_constant_speed(route.states, SPEED).densify(1.0).positions
    assert West().allows_states(path).all()


def test_states_that_cannot_improve_on_the_best_are_left_out():
    made = roadmap(counted(weight=float(InverseDistance(D0)(10.0)) ** 2))
    made.grow(300)
    made.best = made.search()
    before = made.n
    added = made.grow(2000)
    assert 0 < added < 1500
    a, b = ends(hills())
    new = made.states[before:]
    flown = np.linalg.norm(new - a, axis=1) + np.linalg.norm(new - b, axis=1)
    assert (made.risk.weight * flown / SPEED < made.best.cost).all()


def test_pruning_loses_nothing():
    """A path better than the best must survive: the bounds hold along every known route."""
    made = roadmap(counted(Sobolev(1)))
    made.grow(500)
    route = made.search()
    made.best = replace(route, cost=route.cost * (1 + 1e-9))
    d = made.clearance[route.vertices]
    assert made._prospects.promising(made.states[route.vertices], d).all()


def test_nothing_is_left_to_gain_where_the_straight_way_is_free_of_risk():
    flat = Terrain(np.zeros((41, 41)), spacing=(25.0, 25.0))
    made = roadmap(terrain=flat)
    assert not made.nothing_to_gain()
    made.goals.clear()
    made.starts.clear()
    high = np.array([[60.0, 60.0, 50.0], [900.0, 900.0, 50.0]])
    made.add_starts(high[:1])
    made.add_goals(high[1:])
    made.best = made.search()
    assert len(made.best.states) == 2
    assert made.nothing_to_gain()
    assert made.grow(500) == 0


def test_the_same_seed_gives_the_same_route_whatever_the_threads():
    routes = []
    for seed, threads in ((3, 1), (3, 2), (4, 1)):
        made = roadmap(seed=seed, threads=threads)
        made.grow(300)
        routes.append(made.search())
    np.testing.assert_array_equal(routes[0].states, routes[1].states)
    assert routes[0].cost != routes[2].cost


def test_corners_of_a_better_path_become_vertices():
    made = roadmap()
    made.grow(150)
    made.best = first = made.search()
    finer = roadmap(seed=9)
    finer.grow(3000)
    better = finer.search()
    assert better.cost < first.cost
    made.insert_path(first, better.states)
    assert made.search().cost <= better.cost * (1 + 1e-9)


def test_no_route_where_a_wall_reaches_the_ceiling():
    heights = np.zeros((41, 41))
    heights[:, 20] = CEILING + 5.0
    made = roadmap(terrain=Terrain(heights, spacing=(25.0, 25.0)))
    for _ in range(4):  # the bounds are made anew on the way
        made.grow(500)
        assert made.search() is None
        west = (made.states[:, 0] < 500.0).sum()
        assert 0.9 * west < made.reached <= west


def test_several_starts_and_goals_give_the_best_pair():
    made = roadmap()
    _, goal = ends(hills())
    near = goal - [300.0, 0.0, 0.0]
    near[2] = hills().height(*near[:2]) + 15.0
    made.add_goals(near[None])
    made.grow(500)
    both = made.search()
    single = []
    for goals in made.goals[:1], made.goals[1:]:
        one = roadmap()
        one.add_goals(near[None])
        one.goals[:] = goals
        one.grow(500)
        single.append(one.search().cost)
    assert both.cost == min(single)


def test_a_goal_added_later_is_reached():
    made = roadmap()
    made.grow(300)
    higher = ends(hills())[1:] + np.array([0.0, 0.0, 10.0])
    before = made.search()
    made.add_goals(higher)
    after = made.search()
    assert after.cost < before.cost  # less risk up there
    np.testing.assert_array_equal(after.states[-1], higher[0])


def test_a_python_clearance_gives_the_same_route():
    terrain = hills()
    exact = TerrainClearance(terrain, 2.0)
    calls = []

    def slow(points):
        calls.append(len(points))
        return exact(points)

    compiled, generic = roadmap(), roadmap(clearance=slow)
    assert compiled.compiled
    assert not generic.compiled
    for made in (compiled, generic):
        made.grow(120)
    np.testing.assert_array_equal(compiled.states, generic.states)
    assert generic.search().cost == pytest.approx(compiled.search().cost, rel=2e-2)
    assert max(calls) > 10  # batched


def test_nan_of_a_python_clearance_is_named():
    broken = []
    made = roadmap(clearance=lambda points: np.full(len(points), np.nan if broken else 50.0))
    broken.append(True)
    with pytest.raises(ArgumentError, match="nan"):
        made.grow(50)
