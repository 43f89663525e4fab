"""SST as OMPL's users meet it."""

import itertools

import numpy as np
import pytest
from ompl import base as ob
from sst_scene import (
    GOAL,
    START,
    allowed,
    numbers,
    planned,
    ridge,
    rotations,
    setup_of,
    solution,
    walled,
    write,
)

from ompl_risk.avoidance import InverseDistance
from ompl_risk.bridge import RiskObjective
from ompl_risk.clearance import TerrainClearance
from ompl_risk.helicopter.model import simulate
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.sst.planner import SST
from ompl_risk.planners.sst.publishing import runs

DT = 0.02


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
    write(setup, near, buffer)
    setup.addStartState(near)
    planned(setup)
    assert numbers(setup, solution(setup).getStates())[0].tolist() == buffer.tolist()
    assert solution(setup).length() < 4.0


def test_a_start_in_the_goal():
    setup, planner = planned(setup_of(goal=(32.0, 60.0, 15.0)))
    assert solution(setup).getStateCount() == 1
    assert planner.history[-1].cost == 0.0


def test_no_way():
    setup, planner = planned(setup_of(walled()), iterations=500)
    assert not setup.haveSolutionPath()
    assert planner.history == []
    assert "500 iterations" in planner.reason


def test_runs_of_equal_inputs():
    a, b = [1.0, 2.0, 3.0, 4.0], [1.0, 2.0, 3.0, 5.0]
    assert runs(np.array([a, a, a, a, b, b]), 2, 4) == [(0, 4), (4, 6)]
    assert runs(np.array([a, a, a, a, b, b]), 2, 2) == [(0, 2), (2, 4), (4, 6)]
    assert runs(np.array([a]), 1, 10) == [(0, 1)]
    assert runs(np.empty((0, 4)), 1, 10) == []
