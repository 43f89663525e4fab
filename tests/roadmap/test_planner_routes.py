"""RiskRoadmap's other answers: ways that are steered, alternatives, what others published."""

import math
from itertools import pairwise

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from ompl import tools as ot
from planner_scene import Scene, found, once
from scene import SPEED, ends, hills

from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Connection, Steering
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.trajectory import Trajectory


def test_a_better_solution_of_another_planner_stays_first():
    scene = Scene().usual()
    scene.solve(0.5)
    best = scene.cost
    path = og.PathGeometric(scene.path)
    other = RiskRoadmap(scene.si, seed=7)
    problem = scene.setup.getProblemDefinition()
    other.setProblemDefinition(problem)
    other.setup()
    other.solve(once(lambda: other.history != []))
    assert scene.cost <= best
    assert path.cost(scene.objective).value() == pytest.approx(best)


def test_it_runs_in_ompls_benchmark():
    scene = Scene().usual()
    benchmark = ot.Benchmark(scene.setup, "roadmap")
    benchmark.addPlanner(RiskRoadmap(scene.si))
    benchmark.benchmark(ot.Request(0.2, 4096.0, 2, 0.05, False, False, False))
    runs = benchmark.getRecordedExperimentData().planners[0].runs
    assert len(runs) == 2


@pytest.mark.parametrize("options", [{"seed": -1}, {"seed": 1.5}, {"seed": True}, {"threads": 0}])
def test_wrong_options_are_refused(options):
    scene = Scene()
    with pytest.raises(ArgumentError, match=next(iter(options))):
        RiskRoadmap(scene.si, **options)


class Dogleg(Steering):
    """Climbs or descends at half way, level before and after; slower than straight."""

    symmetric = True

    def connect(self, a, b):
        middle = 0.5 * (a + b)
        corners = np.array([a, [*middle[:2], a[2]], [*middle[:2], b[2]], b])
        steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        if steps.max() == 0.0:
            return Connection(0.0, [a, b])
        pieces = [np.linspace(p, q, 9)[:-1] for p, q in pairwise(corners)]
        return Connection(3.0 * steps.max() / SPEED, [*np.vstack(pieces), b])


class OneWay(Steering):
    """Straight, but only towards the east."""

    def connect(self, a, b):
        if b[0] <= a[0]:
            return Connection.none()
        return Connection(float(np.linalg.norm(b - a)) / SPEED, [a, b])


def test_a_steering_shapes_the_path_and_its_duration():
    scene = Scene(steering=Dogleg()).usual()
    assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    corners = np.array([s[0:3] for s in scene.path.getStates()])
    steps = np.diff(corners, axis=0)
    level, upright = np.abs(steps[:, 2]) < 1e-9, np.linalg.norm(steps[:, :2], axis=1) < 1e-9
    assert (level | upright).all()
    assert scene.path.check()
    roadmap = scene.planner.roadmap
    route = roadmap.best
    again = [Dogleg().connect(*ends) for ends in pairwise(roadmap.states[route.vertices])]
    assert route.duration == pytest.approx(sum(way.duration for way in again))
    np.testing.assert_array_equal(corners, route.states)


def test_a_directed_steering_never_goes_back():
    scene = Scene(steering=OneWay()).usual()
    assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    x = [state[0] for state in scene.path.getStates()]
    assert x == sorted(x)
    back = Scene(steering=OneWay()).between(*ends(hills())[::-1])
    assert back.solve(0.3).getStatus() == ob.PlannerStatus.TIMEOUT


def test_the_distance_from_obstacles_is_kept_along_the_way_that_is_steered():
    """The straight motions would keep it, the doglegs have to as well."""
    scene = Scene(steering=Dogleg())
    wide = scene.clearance.with_radius(9.0)
    scene.setup.setStateValidityChecker(ClearanceValidityChecker(scene.si, wide))
    scene.si.setMotionValidator(ClearanceMotionValidator(scene.si, wide))
    scene.usual().solve(found(scene))
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(0.5).positions
    assert wide(fine).min() > 0.0


def test_alternatives_and_pareto_set_come_as_routes_that_can_be_published():
    scene = Scene().usual()
    with pytest.raises(ArgumentError, match="solved with before"):
        scene.planner.alternatives(3)
    scene.solve(0.5)
    routes = scene.planner.alternatives(4, excess=0.2, min_distance=40.0)
    assert len(routes) >= 2
    least = min(route.duration for route in routes)
    for route in routes:
        assert route.duration <= 1.2 * least * (1 + 1e-9)
        path = Trajectory.at_constant_speed(route.states, SPEED)
        assert path.duration == pytest.approx(route.duration)
    front = scene.planner.pareto()
    risks = [route.risk for route in front.routes]
    durations = [route.duration for route in front.routes]
    assert durations == sorted(durations)
    assert risks == sorted(risks, reverse=True)
    assert front.least_risk(within=math.inf).risk == risks[-1]
    assert front.fastest(within_risk=math.inf).duration == durations[0]
    middle = 0.5 * (durations[0] + durations[-1])
    within = front.least_risk(within=middle)
    assert within.duration <= middle
    scene.planner.publish(front.routes)
    problem = scene.setup.getProblemDefinition()
    assert problem.getSolutionCount() >= len(front.routes)
    assert problem.hasExactSolution()


def test_the_same_number_of_iterations_gives_the_same_path():
    paths = []
    for threads in (1, 2):
        scene = Scene().usual()
        planner = RiskRoadmap(scene.si, seed=5, iterations=3000, threads=threads)
        scene.setup.setPlanner(planner)
        scene.solve(ob.PlannerTerminationCondition(lambda: False))
        paths.append([state[0:3] for state in scene.path.getStates()])
    assert paths[0] == paths[1]


def test_what_is_published_comes_first_even_if_it_costs_more():
    scene = Scene().usual()
    scene.solve(0.4)
    routes = scene.planner.alternatives(4, excess=0.2, min_distance=40.0)
    assert routes[0].cost > scene.planner.roadmap.best.cost
    scene.planner.publish(routes)
    corners = [state[0:3] for state in scene.path.getStates()]
    np.testing.assert_array_equal(corners, routes[0].states)
    assert scene.setup.getProblemDefinition().getSolutionCount() == len(routes)
    scene.planner.publish(())
    assert scene.setup.getProblemDefinition().getSolutionCount() == 0


def test_samples_stay_where_paths_can_be_better():
    scene = Scene(duration_weight=1.0).usual()
    scene.solve(1.0)
    roadmap = scene.planner.roadmap
    low, high = roadmap._prospects.box()
    region = roadmap.region
    assert np.prod(high - low) < 0.9 * np.prod(region.high - region.low)
    a, b = roadmap.states[roadmap.starts[0]], roadmap.states[roadmap.goals[0]]
    longest = roadmap.best.cost * SPEED
    rng = np.random.default_rng(0)
    points = rng.uniform(region.low, region.high, (20_000, 3))
    way = np.linalg.norm(points - a, axis=1) + np.linalg.norm(points - b, axis=1)
    inside = ((points >= low) & (points <= high)).all(axis=1)
    assert inside[way < longest].all()
