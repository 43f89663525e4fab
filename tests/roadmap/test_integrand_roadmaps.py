"""Roadmaps with other avoidance functions than the paper's, from end to end."""

import math
import time

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from scene import CEILING, D0, SPEED, box, ends, hills, roadmap

from ompl_risk import planners
from ompl_risk.avoidance import FlatCap, GaussianTail, InverseDistance
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.bridge.states import StateWriter
from ompl_risk.clearance import TerrainClearance
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.motion import Risk
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.roadmap.flights import flight_roadmap
from ompl_risk.planners.roadmap.graph import Graph
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.trajectory import Trajectory

FUNCTIONS = [FlatCap(D0), GaussianTail(D0 / 4)]
functions = pytest.mark.parametrize("f", FUNCTIONS, ids=repr)


def power_along(states, f, norm):
    path = Trajectory.at_constant_speed(states, SPEED).densify(0.02)
    return norm.power(path.t, f(TerrainClearance(hills(), 2.0)(path.positions)))


@functions
@pytest.mark.parametrize("norm", [Lp(1), Lp(3), Lp(math.inf), Sobolev(1)], ids=lambda n: n.label)
def test_lazy_search_finds_what_evaluating_every_edge_finds(f, norm):
    """It leaves edges out by their lower bounds: one too high, and the best is missed."""
    made = roadmap(Risk(f, norm, speed=SPEED))
    made.grow(300)
    found = made.search()
    tail, head = np.sort(made.edges.ends(), axis=0)
    risk = made.motions.costs(made.states[tail], made.states[head])
    risk[~made.gate.allows_motions(made.states[tail], made.states[head])] = math.inf
    pairs = np.column_stack([tail, head])
    graph = Graph.of_edges(made.n, pairs, risk, made.edges.duration, maximum=made.maximum)
    total = graph.risk if made.maximum else graph.risk + made.risk.weight * graph.duration
    best = graph.tree(made.starts, total, maximum=made.maximum).distance[made.goals[0]]
    assert found.cost == pytest.approx(best, rel=1e-12)
    assert made.compiled
    assert made.evaluated < made.edges.m / 2
    assert found.risk == pytest.approx(power_along(found.states, f, norm), rel=1e-2)


@functions
def test_the_planner_finds_a_path_that_is_safer_than_one_at_the_ceiling(f):
    terrain = hills()
    clearance = TerrainClearance(terrain, 2.0)
    space, bounds = ob.RealVectorStateSpace(3), ob.RealVectorBounds(3)
    for k, (low, high) in enumerate(zip(*box(terrain), strict=True)):
        bounds.setLow(k, float(low))
        bounds.setHigh(k, float(high))
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, clearance))
    si.setMotionValidator(ClearanceMotionValidator(si, clearance))
    objective = RiskObjective(si, clearance, f, Sobolev(1), speed=SPEED)
    setup.setOptimizationObjective(objective)
    planner = RiskRoadmap(si, seed=1)
    setup.setPlanner(planner)
    start, goal = (StateWriter(si).state(end) for end in ends(terrain))
    setup.setStartAndGoalStates(start, goal)
    cleared = ends(terrain)
    cleared[:, 2] = CEILING
    climbing = power_along(np.vstack([ends(terrain)[0], cleared, ends(terrain)[1]]), f, Sobolev(1))
    limit = time.monotonic() + 60.0

    def enough():
        better = len(planner.history) > 0 and planner.history[-1].cost < climbing
        return better or time.monotonic() > limit

    status = setup.solve(ob.PlannerTerminationCondition(enough)).getStatus()
    assert status == ob.PlannerStatus.EXACT_SOLUTION
    path = setup.getProblemDefinition().getSolutionPath()
    assert planner.compiled
    assert path.check()
    found = objective.norm(path) ** 2
    assert path.cost(objective).value() == pytest.approx(found, rel=1e-2)
    states = np.array([s[0:3] for s in path.getStates()])
    assert found == pytest.approx(power_along(states, f, Sobolev(1)), rel=1e-2)
    assert found < climbing


@functions
def test_helicopters_are_led_by_it_too(f):
    ground = hills(n=81)
    clearance = TerrainClearance(ground, 3.0, threads=1)
    problem = planners.low_level_flight(
        clearance,
        (300.0, 300.0),
        (1700.0, 1700.0),
        start_height=20.0,
        goal_height=20.0,
        ceiling=CEILING,
        min_clearance=5.0,
        avoidance=f,
    )
    steering = HelicopterSteering()
    made = flight_roadmap(problem, steering, places=120, seed=3, threads=1)
    route = made.search()
    flight = steering.flight(made.states[route.vertices])
    d = clearance(flight.planned[:, :3])
    assert made.compiled
    assert d.min() > 5.0
    assert route.risk > 1e-6
    assert Sobolev(1)(flight.t, f(d)) ** 2 == pytest.approx(route.risk, rel=0.02)


def test_problems_take_any_of_them():
    clearance = TerrainClearance(hills(), 2.0)
    for f in (*FUNCTIONS, InverseDistance(D0)):
        options = {"min_clearance": 5.0, "avoidance": f}
        problem = planners.low_level_flight(clearance, (60.0, 60.0), (900.0, 900.0), **options)
        assert problem.avoidance == f
