"""SST as OMPL's users meet it."""

import itertools
import math

import numpy as np
import pytest
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og
from sst_scene import GOAL, START, TOP, allowed, numbers, planned, ridge, rotations, setup_of

from ompl_risk.avoidance import InverseDistance
from ompl_risk.bridge import ClearanceValidityChecker, RiskObjective
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.model import simulate
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.sst import planner as planner_module
from ompl_risk.planners.sst import searching
from ompl_risk.planners.sst.planner import SST
from ompl_risk.planners.sst.publishing import runs
from ompl_risk.terrains import Terrain

DT = 0.02


def solution(setup):
    return setup.getProblemDefinition().getSolutionPath()


def held_inputs(path):
    """One row for each step."""
    rows = []
    for control, duration in zip(path.getControls(), path.getControlDurations(), strict=True):
        rows += [[control[k] for k in range(4)]] * round(duration / DT)
    return np.array(rows)


def input_bounds(setup):
    bounds = setup.getSpaceInformation().getControlSpace().getBounds()
    return np.array([[side[k] for k in range(4)] for side in (bounds.low, bounds.high)])


def replayed(path, start=START):
    return simulate(Helicopter(), start, held_inputs(path), dt=DT)


@pytest.fixture(scope="module")
def quick():
    return planned()


@pytest.fixture(scope="module")
def careful():
    return planned(setup_of(risk=True, avoidance=InverseDistance(40.0)))


@pytest.fixture(params=["quick", "careful"])
def solved(request):
    return request.getfixturevalue(request.param)


def test_a_path_replays_to_the_last_digit(solved):
    setup, _ = solved
    path = solution(setup)
    states = numbers(setup, path.getStates())
    times = np.cumsum([0, *[round(t / DT) for t in path.getControlDurations()]])
    assert (replayed(path)[times] == states).all()
    assert path.check()


def test_a_path_leads_from_start_to_goal(solved):
    setup, _ = solved
    states = numbers(setup, solution(setup).getStates())
    assert states[0].tolist() == [*START, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6]
    assert np.linalg.norm(states[-1, :3] - GOAL) <= 5.0
    assert np.linalg.norm(states[-1, 7:10]) <= 2.0
    assert setup.getGoal().isSatisfied(solution(setup).getStates()[-1])


def test_every_state_of_a_path_is_allowed(solved):
    setup, _ = solved
    states = replayed(solution(setup))
    assert allowed(states, ridge()).all()
    assert states[:, 2].max() > 36.0  # over the ridge: there is no way round
    low, high = input_bounds(setup)
    inputs = held_inputs(solution(setup))
    assert ((inputs >= low) & (inputs <= high)).all()


def test_between_the_steps_the_path_is_free(solved):
    setup, _ = solved
    states = replayed(solution(setup))
    share = np.linspace(0.0, 1.0, 20, endpoint=False)[:, None, None]
    between = (1.0 - share) * states[:-1, :3] + share * states[1:, :3]
    assert TerrainClearance(ridge(), 1.0)(between.reshape(-1, 3)).min() > 0.0


def test_the_cost_of_the_quickest_path_is_its_duration(quick):
    setup, planner = quick
    assert planner.history[-1].cost == pytest.approx(solution(setup).length(), rel=1e-12)
    assert planner.tree.cost == pytest.approx(solution(setup).length(), rel=1e-9)


@pytest.mark.parametrize("norm", [Lp(1), Lp(3), Sobolev(1), Sobolev(1, time_scale=2.0)], ids=str)
def test_the_cost_of_the_safest_path_is_its_risk(norm):
    setup, planner = planned(setup_of(risk=True, norm=norm, avoidance=InverseDistance(40.0)))
    path = solution(setup)
    states = replayed(path)
    d = TerrainClearance(ridge(), 1.0)(states[:, :3])
    f = np.where(d < 40.0, 1.0 / d - 1.0 / 40.0, 0.0)
    weight = 1e-9 / 40.0**norm.exponent
    cost = norm.power(DT * np.arange(len(f)), f) + weight * path.length()
    assert planner.history[-1].cost == pytest.approx(cost, rel=1e-9)
    assert planner.tree.cost == pytest.approx(cost, rel=1e-9)


def test_a_second_may_cost_something_too():
    setup = setup_of(risk=True)
    si = setup.getSpaceInformation()
    clearance = setup.getStateValidityChecker().obstacles
    objective = RiskObjective(si, clearance, InverseDistance(40.0), speed=35.0, duration_weight=0.1)
    setup.setOptimizationObjective(objective)
    _, planner = planned(setup)
    states = replayed(solution(setup))
    d = clearance(states[:, :3])
    f = np.where(d < 40.0, 1.0 / d - 1.0 / 40.0, 0.0)
    power = Sobolev(1).power(DT * np.arange(len(f)), f)
    assert planner.history[-1].cost == pytest.approx(power + 0.1 * solution(setup).length())


def test_paths_become_better(solved):
    _, planner = solved
    costs = [row.cost for row in planner.history]
    assert len(costs) > 3
    assert all(b < a for a, b in itertools.pairwise(costs))
    assert [row.seconds for row in planner.history] == sorted(
        row.seconds for row in planner.history
    )
    assert costs[-1] < 0.8 * costs[0]


def test_more_iterations_come_near_to_the_least_duration():
    _, planner = planned(iterations=6000)
    # 135 m at 35 m/s, and half a second for each 17 m/s of a change of speed at 1.7 g
    least = 135.0 / 35.0
    assert least < planner.history[-1].cost < 9.0
    assert planner.history[-1].cost < planned(iterations=300)[1].history[-1].cost


def test_the_same_seed_gives_the_same_path():
    paths = [held_inputs(solution(planned(seed=seed)[0])) for seed in (5, 5, 6)]
    assert np.array_equal(paths[0], paths[1])
    assert not np.array_equal(paths[0], paths[2])


def test_two_runs_are_as_good_as_one_of_both():
    whole, once = planned(iterations=700)
    parts, twice = planned(iterations=350)
    parts.solve(60.0)
    assert twice.tree.arrays.counts.tolist() == once.tree.arrays.counts.tolist()
    assert np.array_equal(held_inputs(solution(whole)), held_inputs(solution(parts)))


def test_it_stops_when_told_and_goes_on_when_asked():
    setup, planner = planned(iterations=1)
    planner = SST(setup.getSpaceInformation())
    setup.setPlanner(planner)
    calls = itertools.count()
    setup.solve(ob.PlannerTerminationCondition(lambda: next(calls) > 3))
    first, cost = planner.tree.count(6), planner.tree.cost
    calls = itertools.count()
    setup.solve(ob.PlannerTerminationCondition(lambda: next(calls) > 3))
    assert planner.tree.count(6) > first > 0
    assert planner.tree.cost <= cost


def test_a_satisfied_objective_ends_the_search():
    setup = setup_of()
    objective = ob.PathLengthOptimizationObjective(setup.getSpaceInformation())
    objective.setCostThreshold(ob.Cost(30.0))
    setup.setOptimizationObjective(objective)
    _, planner = planned(setup, iterations=10**9, seconds=60.0)
    assert planner.history[-1].cost < 30.0
    assert all(row.cost >= 30.0 for row in planner.history[:-1])


def test_clear_forgets():
    setup, planner = planned()
    before = held_inputs(solution(setup))
    setup.clear()
    assert planner.tree is None
    assert planner.history == []
    setup.solve(60.0)
    assert np.array_equal(held_inputs(solution(setup)), before)


def test_a_better_path_of_another_planner_stays():
    setup, _ = planned(iterations=4000)
    best = solution(setup).length()
    _, other = planned(setup, iterations=200, seed=9)
    assert other.history[-1].cost > best
    assert solution(setup).length() == best
    assert setup.getProblemDefinition().getSolutionCount() == 2
    assert setup.getProblemDefinition().hasExactSolution()


def test_a_worse_path_of_another_planner_does_not():
    setup, first = planned(iterations=200, seed=9)
    _, better = planned(setup, iterations=4000)
    assert better.history[-1].cost < first.history[-1].cost
    assert solution(setup).length() == pytest.approx(better.history[-1].cost, rel=1e-12)


def test_inputs_are_held_as_long_as_the_problem_says():
    setup, _ = planned(setup_of(holds=(5, 20)), iterations=2000)
    durations = np.array(solution(setup).getControlDurations()) / DT
    assert durations == pytest.approx(np.round(durations), abs=1e-9)
    assert set(np.round(durations).astype(int) % 5) == {0}
    assert durations.min() >= 5 - 1e-9
    assert durations.max() <= 20 + 1e-9
    assert (replayed(solution(setup))[-1] == numbers(setup, solution(setup).getStates())[-1]).all()


def test_inputs_keep_to_a_narrow_control_space():
    setup, _ = planned(setup_of(authority=0.2), iterations=3000)
    low, high = input_bounds(setup)
    assert high - low == pytest.approx(0.2 * np.subtract(*Limits().controls(Helicopter())[::-1]))
    inputs = held_inputs(solution(setup))
    assert ((inputs >= low) & (inputs <= high)).all()


def test_another_vehicle_and_step():
    heavy = Helicopter(12.0, inertia=(0.3, 0.5, 0.45), drag=(0.5, 0.5, 0.8))
    setup, _ = planned(setup_of(helicopter=heavy, step=0.04, holds=(1, 10)), helicopter=heavy)
    path = solution(setup)
    states = numbers(setup, path.getStates())
    inputs = [[c[k] for k in range(4)] for c in path.getControls()]
    rows = np.repeat(inputs, np.round(np.array(path.getControlDurations()) / 0.04).astype(int), 0)
    again = simulate(heavy, START, rows, dt=0.04)
    assert again[-1].tolist() == states[-1].tolist()
    assert path.check()


def test_a_moving_goal_state():
    passing = np.array([*GOAL[:2], 30.0, 0.0, 0.0, 0.0, 1.0, 15.0, *[0.0] * 5])
    setup, planner = planned(setup_of(goal=passing), iterations=3000)
    last = numbers(setup, solution(setup).getStates())[-1:]
    velocity = (rotations(last) @ last[:, 7:10, None])[0, :, 0]
    assert np.linalg.norm(velocity - [15.0, 0.0, 0.0]) <= 2.0
    assert np.linalg.norm(last[0, :3] - passing[:3]) <= 5.0
    assert planner.history[-1].cost < 9.0


def test_several_starts():
    setup = setup_of()
    near = setup.getSpaceInformation().allocState()
    buffer = np.array([140.0, 60.0, 15.0, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6])
    _write(setup, near, buffer)
    setup.addStartState(near)
    planned(setup)
    assert numbers(setup, solution(setup).getStates())[0].tolist() == buffer.tolist()
    assert solution(setup).length() < 4.0


def _write(setup, state, values):
    buffer = Buffer(13)
    buffer.numbers[:] = values
    setup.getSpaceInformation().getStateSpace().deserialize(state, buffer.capsule)


def test_a_start_in_the_goal():
    setup, planner = planned(setup_of(goal=(32.0, 60.0, 15.0)))
    assert solution(setup).getStateCount() == 1
    assert planner.history[-1].cost == 0.0


def test_no_way():
    setup, planner = planned(setup_of(walled()), iterations=500)
    assert not setup.haveSolutionPath()
    assert planner.history == []
    assert "500 iterations" in planner.reason


def test_a_full_tree_makes_room(monkeypatch):
    monkeypatch.setattr(planner_module, "NODES", 200)
    setup, planner = planned(iterations=4000)
    assert solution(setup).check()
    assert planner.tree.count(4) <= 200
    assert len(planner.history) > 3


def test_without_a_path_a_full_tree_becomes_coarser(monkeypatch):
    monkeypatch.setattr(planner_module, "NODES", 200)
    _, planner = planned(setup_of(walled()), iterations=2000)
    assert planner.history == []
    assert planner.tree.count(4) <= 200
    assert planner.tree.pruning > 1.2 * 0.012 * 140.0


def walled():
    heights = np.zeros((13, 21))
    heights[:, 10] = TOP + 20.0
    return Terrain(heights, spacing=(10.0, 10.0))


@pytest.mark.parametrize("shrink", [True, False])
def test_radii_shrink_unless_they_must_not(monkeypatch, shrink):
    monkeypatch.setattr(searching, "ROUND", 100)
    monkeypatch.setattr(searching, "TURNS", 0.1)
    _, planner = planned(shrink=shrink, pruning_radius=3.0, selection_radius=20.0)
    pruning, selection = planner.tree.pruning, planner.tree.arrays.radii[0]
    assert pruning < 1.0 if shrink else pruning == 3.0
    assert selection == pytest.approx(pruning * 20.0 / 3.0)


def test_runs_of_equal_inputs():
    a, b = [1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 5.0]
    assert runs(np.array([a, a, a, a, b, b]), 2, 4) == [(0, 4), (4, 6)]
    assert runs(np.array([a, a, a, a, b, b]), 2, 2) == [(0, 2), (2, 4), (4, 6)]
    assert runs(np.array([a]), 1, 10) == [(0, 1)]
    assert runs(np.empty((0, 4)), 1, 10) == []


# what cannot be


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"seed": True}, "seed"),
        ({"iterations": 0}, "iterations"),
        ({"iterations": 2.0}, "iterations"),
        ({"selection_radius": 0.0}, "selection_radius"),
        ({"pruning_radius": -1.0}, "pruning_radius"),
        ({"pruning_radius": math.nan}, "pruning_radius"),
        ({"pruning_radius": math.inf}, "pruning_radius"),
        ({"authority": 0.0}, "authority"),
        ({"authority": 1.1}, "authority"),
        ({"shrink": 1}, "shrink"),
    ],
)
def test_wrong_options(options, message):
    with pytest.raises(ArgumentError, match=message):
        SST(setup_of().getSpaceInformation(), **options)


def test_only_for_the_helicopter():
    space = ob.RealVectorStateSpace(3)
    space.setBounds(0.0, 1.0)
    with pytest.raises(ArgumentError, match="SpaceInformation"):
        SST(og.SimpleSetup(space).getSpaceInformation())
    controls = oc.RealVectorControlSpace(space, 2)
    with pytest.raises(ArgumentError, match="states of 3 and controls of 2"):
        SST(oc.SimpleSetup(controls).getSpaceInformation())


class OwnRisk(RiskObjective):
    def stateCost(self, state):
        return ob.Cost(1.0)


def objectives(si, clearance):
    wider = TerrainClearance(ridge(), 3.0)
    return {
        "own": OwnRisk(si, clearance, speed=1.0),
        "L∞": RiskObjective(si, clearance, norm=Lp(math.inf), speed=1.0),
        "radius=3": RiskObjective(si, wider, speed=1.0),
    }


@pytest.mark.parametrize("which", ["own", "L∞", "radius=3"])
def test_objectives_that_it_cannot_serve(which):
    setup = setup_of()
    si, clearance = setup.getSpaceInformation(), setup.getStateValidityChecker().obstacles
    setup.setOptimizationObjective(objectives(si, clearance)[which])
    setup.setPlanner(SST(si))
    with pytest.raises(ArgumentError, match=r"objective.*must be a RiskObjective"):
        setup.solve(1.0)


def test_checkers_that_it_cannot_ask():
    setup = setup_of()
    si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, TerrainClearance(ridge(), 1.0)))
    setup.setPlanner(SST(si))
    with pytest.raises(ArgumentError, match="HelicopterValidityChecker"):
        setup.solve(1.0)


def test_another_helicopter_than_the_propagators():
    setup = setup_of(helicopter=Helicopter(9.0))
    setup.setPlanner(SST(setup.getSpaceInformation()))
    with pytest.raises(ArgumentError, match=r"helicopter.*propagator"):
        setup.solve(1.0)


def test_goals_that_it_cannot_reach_for():
    setup = setup_of()
    si = setup.getSpaceInformation()
    setup.setGoalState(si.allocState(), 1.0)
    planner = SST(si)
    setup.setPlanner(planner)
    assert setup.solve(1.0).getStatus() == ob.PlannerStatus.UNRECOGNIZED_GOAL_TYPE
    assert "HelicopterGoal" in planner.reason


def test_starts_that_are_not_allowed():
    setup = setup_of()
    buried = setup.getSpaceInformation().allocState()
    _write(setup, buried, [100.0, 60.0, 10.0, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6])
    setup.clearStartStates()
    setup.addStartState(buried)
    planner = SST(setup.getSpaceInformation())
    setup.setPlanner(planner)
    assert setup.solve(1.0).getStatus() == ob.PlannerStatus.INVALID_START
    assert "no start" in planner.reason
