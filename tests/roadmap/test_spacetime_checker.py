"""Planning in space and time: states are checked at their time, and wrong use is refused."""

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from timed_scene import ROOM, Scene, door

from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingSphere
from ompl_risk.clearance.terrain import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, motion_batch
from ompl_risk.motion.steering import Connection, Steering
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory


class TestChecker:
    def test_reads_the_time_of_a_state(self):
        scene = Scene()
        checker = scene.si.getStateValidityChecker()
        inside = (50, 50, 50)
        assert not checker.isValid(scene.state((*inside, 0)))
        assert checker.isValid(scene.state((*inside, 29)))
        want = scene.clearance([inside], [25.0])[0]
        assert checker.clearance(scene.state((*inside, 25))) == want

    def test_motions_take_their_time(self):
        scene = Scene()
        a, b = (10, 50, 50, 0), (20, 50, 50, 1)

        def check(p, q):
            return scene.si.checkMotion(scene.state(p), scene.state(q))

        assert check(a, b)
        assert check(a, a)
        assert not check(b, a)  # backwards in time
        assert not check(a, (20, 50, 50, 0.99))  # faster than the space says
        assert check(a, (20, 50, 50, 30))
        assert not check(a, (20, 50, 50, 0))

    def test_motions_are_checked_at_their_own_time(self):
        scene = Scene()

        def check(p, q):
            return scene.si.checkMotion(scene.state(p), scene.state(q))

        assert not check((40, 50, 50, 0), (60, 50, 50, 2))
        assert check((40, 50, 50, 27), (60, 50, 50, 29))
        assert not check((40, 50, 50, 10), (60, 50, 50, 40))  # too early at the door, slowly
        ball = MovingClearance(MovingSphere(1e-3, [0, 1], [[50, 0, 50], [50, 1e5, 50]]))
        scene = Scene(ball)
        assert not check((50, 50, 50, 0), (50, 50, 50, 1))  # swept while it stays
        assert check((50, 50, 50, 0.01), (50, 50, 50, 1))

    def test_obstacles_that_stand_still_will_do(self):
        flat = TerrainClearance(Terrain(np.zeros((11, 11)), spacing=(10.0, 10.0)), 1.0)
        scene = Scene(flat)
        assert scene.si.checkMotion(scene.state((10, 50, 5, 0)), scene.state((20, 50, 5, 9)))
        assert not scene.si.checkMotion(scene.state((10, 50, 5, 9)), scene.state((20, 50, 5, 0)))
        assert not scene.si.isValid(scene.state((10, 50, 0.5, 0)))
        with pytest.raises(ArgumentError, match="MovingClearance"):
            scene.solve()

    def test_paths_with_times_are_trajectories(self):
        scene = Scene()
        scene.setup.setup()
        path = og.PathGeometric(scene.si)
        rows = [(1, 2, 3, 4), (1, 2, 3, 4), (1, 2, 3, 9), (11, 2, 3, 10)]
        for row in rows:
            path.append(scene.state(row))
        flown = Trajectory.from_path(path, name="B")
        assert flown.t.tolist() == [4, 9, 10]
        assert flown.positions.tolist() == [list(row[:3]) for row in rows[1:]]
        with pytest.raises(ArgumentError, match="carry their times"):
            Trajectory.from_path(path, speed=3.0)


class ElsewhereSteering(Steering):
    def connect(self, a, b):
        return Connection(np.stack([a, b]), 1.0)


class TestWrongUse:
    @pytest.mark.parametrize("kind", [ClearanceValidityChecker, ClearanceMotionValidator])
    def test_a_space_without_time(self, kind):
        place = ob.RealVectorStateSpace(3)
        place.setBounds(0.0, ROOM)
        clearance = MovingClearance(door())
        with pytest.raises(ArgumentError, match=r"RealVector.*SpaceTimeStateSpace"):
            kind(ob.SpaceInformation(place), clearance)

    def test_an_objective_without_time(self):
        place = ob.RealVectorStateSpace(3)
        place.setBounds(0.0, ROOM)
        with pytest.raises(ArgumentError, match=r"SpaceTimeStateSpace.*rank"):
            RiskObjective(ob.SpaceInformation(place), MovingClearance(door()), speed=1.0)
        with pytest.raises(ArgumentError, match="without an objective"):
            RiskObjective(Scene().si, MovingClearance(door()), speed=1.0)
        with pytest.raises(ArgumentError, match="stands still"):
            motion_batch(MovingClearance(door()), Risk(speed=1.0))

    def test_space_time_over_something_else(self):
        space = ob.SpaceTimeStateSpace(ob.RealVectorStateSpace(2), 1.0)
        with pytest.raises(ArgumentError, match="RealVectorStateSpace"):
            RiskRoadmap(ob.SpaceInformation(space))
        with pytest.raises(ArgumentError, match="SE3StateSpace"):
            RiskRoadmap(ob.SpaceInformation(ob.SpaceTimeStateSpace(ob.SE3StateSpace(), 1.0)))

    def test_no_bounds_in_time(self):
        with pytest.raises(ArgumentError, match="setTimeBounds"):
            Scene(end=None).solve()

    def test_an_objective(self):
        scene = Scene()
        scene.setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(scene.si))
        with pytest.raises(ArgumentError, match=r"objective.*left out"):
            scene.solve()

    def test_a_checker_of_somebody_else(self):
        scene = Scene(checker=False, motions=False)
        scene.setup.setStateValidityChecker(lambda _state: True)
        with pytest.raises(ArgumentError, match="ClearanceValidityChecker"):
            scene.solve()

    def test_a_validator_of_another_clearance(self):
        scene = Scene()
        other = MovingClearance(door(), radius=2.0)
        scene.si.setMotionValidator(ClearanceMotionValidator(scene.si, other))
        with pytest.raises(ArgumentError, match="clearance of the validity checker"):
            scene.solve()

    def test_a_steering(self):
        with pytest.raises(ArgumentError, match="steering"):
            Scene(steering=ElsewhereSteering())

    def test_a_start_in_the_door(self):
        scene = Scene().between((50, 50, 50, 0), (90, 50, 50, 0))
        assert scene.solve().asString() == "Invalid start"
        assert "free at its time" in scene.planner.reason

    def test_a_goal_out_of_the_room(self):
        scene = Scene().between((10, 50, 50, 0), (90, 50, 500, 0))
        assert scene.solve().asString() == "Invalid goal"
        assert "within the bounds" in scene.planner.reason

    def test_what_needs_a_roadmap_of_risk(self):
        scene = Scene(iterations=150)
        scene.solve()
        for wrong in (scene.planner.alternatives, scene.planner.pareto):
            with pytest.raises(ArgumentError, match="space-time"):
                wrong()

    def test_a_goal_farther_than_flight_can_come(self):
        scene = Scene(end=7.9)
        assert scene.solve().asString() == "Invalid goal"
        assert "straight flight at vMax = 10 m/s arrives at t = 8 s" in scene.planner.reason

    def test_a_goal_that_is_never_free(self):
        flat = TerrainClearance(Terrain(np.full((11, 11), 20.0), spacing=(10.0, 10.0)), 1.0)
        scene = Scene(MovingClearance(door(), static=flat)).between((10, 50, 50, 0), (90, 50, 9, 0))
        assert scene.solve().asString() == "Invalid goal"
        assert scene.planner.reason == "the goal is never free until t = 60 s"
