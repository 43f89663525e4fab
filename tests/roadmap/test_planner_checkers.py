"""RiskRoadmap asks whatever answers in a set-up: objectives, clearances, checkers, validators."""

import itertools
import math

import numpy as np
import pytest
import trimesh
from ompl import base as ob
from ompl import geometric as og
from planner_scene import Scene, found, once
from scene import SPEED, ends, hills

from ompl_risk.avoidance import InverseDistance
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.bridge.states import StateWriter
from ompl_risk.clearance import MeshClearance, TerrainClearance, UnionClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.trajectory import Trajectory


@pytest.mark.parametrize("given", [True, False])
def test_without_a_risk_objective_it_minimises_the_length(given):
    scene = Scene(no_objective=True)
    length = ob.PathLengthOptimizationObjective(scene.si)
    if given:
        scene.setup.setOptimizationObjective(length)
    scene.usual().solve(0.4)
    assert scene.path.check()
    assert scene.path.length() == pytest.approx(scene.planner.history[-1].cost)
    risky = Scene().usual()
    risky.solve(0.4)
    assert scene.path.length() < risky.path.length()


def test_an_unknown_objective_is_refused():
    scene = Scene(no_objective=True).usual()
    scene.setup.setOptimizationObjective(ob.StateCostIntegralObjective(scene.si, False))
    with pytest.raises(ArgumentError, match="objective"):
        scene.solve()


def test_another_space_is_refused():
    space = ob.RealVectorStateSpace(2)
    space.setBounds(0.0, 1.0)
    setup = og.SimpleSetup(space)
    state = setup.getSpaceInformation().allocState()
    state[0:2] = [0.5, 0.5]
    setup.setStartAndGoalStates(state, state)
    setup.setStateValidityChecker(lambda _: True)
    setup.setPlanner(RiskRoadmap(setup.getSpaceInformation()))
    with pytest.raises(ArgumentError, match="R\\^3"):
        setup.solve(0.1)


def test_a_foreign_checker_and_validator_are_asked():
    scene = Scene(bare=True)
    asked = []

    def outside(state):
        asked.append(1)
        return abs(state[0] - 500.0) > 50.0 or state[1] > 700.0

    scene.setup.setStateValidityChecker(outside)
    scene.si.setStateValidityCheckingResolution(0.002)
    scene.usual().solve(1.0)
    assert asked
    assert not scene.planner.compiled
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(4.0).positions
    assert ((np.abs(fine[:, 0] - 500.0) > 45.0) | (fine[:, 1] > 695.0)).all()
    assert scene.clearance(fine).min() > 0.0


def test_a_python_clearance_works_and_says_that_it_is_slow():
    terrain = hills()
    exact = TerrainClearance(terrain, 2.0)
    scene = Scene(terrain, clearance=lambda points: exact(points)).usual()  # noqa: PLW0108
    assert scene.solve(1.0).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert not scene.planner.compiled


def test_nan_from_a_clearance_surfaces_and_what_was_found_is_kept():
    terrain = hills()
    exact = TerrainClearance(terrain, 2.0)
    broken = []

    def clearance(points):
        d = exact(points)
        return np.full(len(points), np.nan) if broken else d

    scene = Scene(terrain, clearance=clearance, bare=True).usual()
    scene.solve(0.5)
    before = scene.cost
    broken.append(True)
    with pytest.raises(ArgumentError, match="nan"):
        scene.solve(5.0)
    broken.clear()
    assert scene.setup.haveExactSolutionPath()
    # states that were answered before the clearance broke may still be connected, for the better
    assert scene.cost <= before * (1.0 + 1e-9)


def test_an_exception_of_a_clearance_surfaces():
    calls = []
    exact = TerrainClearance(hills(), 2.0)

    def clearance(points):
        calls.append(1)
        if len(calls) > 40:
            raise RuntimeError("sensor unplugged")
        return exact(points)

    scene = Scene(clearance=clearance).usual()
    with pytest.raises(RuntimeError, match="sensor unplugged"):
        scene.solve(5.0)


def test_meshes_and_unions_work():
    terrain = hills()
    tower = trimesh.creation.cylinder(40.0, 200.0)
    tower.apply_translation([500.0, 500.0, 0.0])
    clearance = UnionClearance([TerrainClearance(terrain, 2.0), MeshClearance([tower], 2.0)])
    scene = Scene(terrain, clearance).usual()
    assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(1.0).positions
    assert clearance(fine).min() > 0.0


def test_poses_over_terrain_turn_as_they_go():
    scene = Scene(kind=ob.SE3StateSpace)
    start, goal = ends(scene.terrain)
    turned = [0.0, 0.0, math.sin(0.4), math.cos(0.4)]
    scene.between([*start, 0.0, 0.0, 0.0, 1.0], [*goal, *turned])
    assert scene.solve().getStatus() == ob.PlannerStatus.EXACT_SOLUTION
    assert scene.planner.compiled
    path = Trajectory.from_path(scene.path, speed=SPEED)
    np.testing.assert_allclose(path.orientations[0], [0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(path.orientations[-1], turned, atol=1e-12)
    angles = 2 * np.arccos(path.orientations[:, 3])
    np.testing.assert_allclose(angles, 0.8 * path.t / path.duration, atol=1e-6)
    assert scene.path.check()


def test_a_body_that_must_turn_to_pass_turns():
    """A rod through a slit that it only fits along its length."""
    walls = [trimesh.creation.box((4.0, 60.0, 60.0)) for _ in range(2)]
    walls[0].apply_translation([0.0, 33.0, 0.0])
    walls[1].apply_translation([0.0, -33.0, 0.0])
    rod = trimesh.creation.box((1.0, 12.0, 1.0))
    clearance = MeshClearance(walls, body=rod)
    space = ob.SE3StateSpace()
    bounds = ob.RealVectorBounds(3)
    for k, half in enumerate((40.0, 20.0, 20.0)):
        bounds.setLow(k, -half)
        bounds.setHigh(k, half)
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    si = setup.getSpaceInformation()
    setup.setStateValidityChecker(ClearanceValidityChecker(si, clearance))
    si.setMotionValidator(ClearanceMotionValidator(si, clearance))
    setup.setOptimizationObjective(
        RiskObjective(si, clearance, InverseDistance(10.0), Lp(2), speed=5.0, duration_weight=1.0)
    )
    write = StateWriter(si).state
    still = [0.0, 0.0, 0.0, 1.0]
    setup.setStartAndGoalStates(
        write(np.array([-30.0, 0.0, 0.0, *still])), write(np.array([30.0, 0.0, 0.0, *still]))
    )
    planner = RiskRoadmap(si)
    setup.setPlanner(planner)
    setup.solve(once(lambda: planner.history != []))
    assert setup.haveExactSolutionPath(), planner.reason
    assert setup.getSolutionPath().check()


class NoFly(ClearanceValidityChecker):
    """Keeps out of a zone besides."""

    def isValid(self, state):
        outside = abs(state[0] - 500.0) > 50.0 or state[1] > 700.0
        return bool(outside and super().isValid(state))


class Dear(RiskObjective):
    """With a cost of its own."""

    def motionCost(self, s1, s2):
        return ob.Cost(1.0)


def test_overridden_checkers_are_not_bypassed():
    scene = Scene()
    scene.setup.setStateValidityChecker(NoFly(scene.si, scene.clearance))
    scene.usual().solve(0.5)
    assert not scene.planner.compiled
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(4.0).positions
    ours = Scene().usual()
    ours.solve(0.5)
    assert ours.planner.compiled
    if len(fine):
        states = [s[0:3] for s in scene.path.getStates()]
        assert all(abs(x - 500.0) > 50.0 or y > 700.0 for x, y, _ in states)


def test_overridden_objectives_are_refused():
    scene = Scene(no_objective=True)
    scene.setup.setOptimizationObjective(Dear(scene.si, scene.clearance, speed=SPEED))
    with pytest.raises(ArgumentError, match="motionCost of its own"):
        scene.usual().solve(0.1)


def test_equal_clearances_of_checker_and_validator_stay_compiled():
    scene = Scene()
    again = TerrainClearance(scene.terrain, 2.0)
    scene.setup.setStateValidityChecker(ClearanceValidityChecker(scene.si, again))
    scene.usual().solve(0.1)
    assert scene.planner.compiled


def test_different_clearances_of_checker_and_validator_are_both_kept():
    scene = Scene()
    wide = scene.clearance.with_radius(8.0)
    scene.setup.setStateValidityChecker(ClearanceValidityChecker(scene.si, wide))
    scene.usual().solve(found(scene))
    assert scene.planner.compiled
    fine = Trajectory.from_path(scene.path, speed=SPEED).densify(0.5).positions
    assert wide(fine).min() > 0.0


def test_a_clearance_that_fails_once_leaves_the_planner_usable():
    exact = TerrainClearance(hills(), 2.0)
    for failing in (1, 2, 4, 6, 12, 27, 40):
        calls = itertools.count(1)
        broken = [False]

        def clearance(points, failing=failing, calls=calls, broken=broken):
            if broken[0] and next(calls) == failing:
                raise RuntimeError("a glitch")
            return exact(points)

        scene = Scene(clearance=clearance, bare=True).usual()
        scene.setup.setup()
        broken[0] = True
        with pytest.raises(RuntimeError, match="glitch"):
            scene.solve(once(lambda: False))
        broken[0] = False
        assert scene.solve(found(scene)).getStatus() == ob.PlannerStatus.EXACT_SOLUTION
        scene.setup.clear()
