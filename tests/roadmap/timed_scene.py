"""A door that opens, and OMPL's set-up of a planner in space and time that passes below it."""

from ompl import base as ob
from ompl import geometric as og

from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox
from ompl_risk.planners.roadmap.planner import RiskRoadmap
from ompl_risk.trajectory import Trajectory

FASTEST, ROOM, END = 10.0, 100.0, 60.0


def door(opens=20.0, rise=25.0):
    """A wall across the room, from x = 45 to 55, that rises from a time on until it is gone."""
    up = 150.0 + 10.0 * rise
    t = [0.0, opens, opens + 10.0, opens + 100.0]
    return MovingBox([10, 300, 300], t, [[50, 50, z] for z in (140.0, 140.0, up, up)])


class Scene:
    """A SimpleSetup in a room of 100 m with a RiskRoadmap."""

    def __init__(self, clearance=None, *, end=END, motions=True, checker=True, **options):
        self.clearance = clearance or MovingClearance(door(), radius=1.0)
        place = ob.RealVectorStateSpace(3)
        place.setBounds(0.0, ROOM)
        self.space = ob.SpaceTimeStateSpace(place, FASTEST)
        if end is not None:
            self.space.setTimeBounds(0.0, end)
        self.setup = og.SimpleSetup(self.space)
        self.si = self.setup.getSpaceInformation()
        if checker:
            self.setup.setStateValidityChecker(ClearanceValidityChecker(self.si, self.clearance))
        if motions:
            self.si.setMotionValidator(ClearanceMotionValidator(self.si, self.clearance))
        self.planner = RiskRoadmap(self.si, **options)
        self.setup.setPlanner(self.planner)
        self.between((10, 50, 50, 0), (90, 50, 50, 0))

    def state(self, numbers):
        state = self.si.allocState()
        state[0][0:3] = [float(x) for x in numbers[:3]]
        state[1].position = float(numbers[3])
        return state

    def between(self, start, goal):
        self.setup.setStartAndGoalStates(self.state(start), self.state(goal))
        return self

    def solve(self, condition=20.0):
        return self.setup.solve(condition)

    @property
    def path(self):
        return self.setup.getProblemDefinition().getSolutionPath()

    @property
    def flown(self):
        return Trajectory.from_path(self.path)
