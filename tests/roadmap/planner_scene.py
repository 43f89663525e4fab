"""RiskRoadmap in OMPL's SimpleSetup over hills."""

import time

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from scene import D0, SPEED, box, ends, hills

from ompl_risk.avoidance import InverseDistance
from ompl_risk.bridge import ClearanceMotionValidator, ClearanceValidityChecker, RiskObjective
from ompl_risk.bridge.states import StateWriter
from ompl_risk.clearance import TerrainClearance
from ompl_risk.planners.roadmap.planner import RiskRoadmap


def space_of(terrain, kind=ob.RealVectorStateSpace):
    space = kind(3) if kind is ob.RealVectorStateSpace else kind()
    bounds = ob.RealVectorBounds(3)
    for k, (low, high) in enumerate(zip(*box(terrain), strict=True)):
        bounds.setLow(k, float(low))
        bounds.setHigh(k, float(high))
    space.setBounds(bounds)
    return space


class Scene:
    """A SimpleSetup over hills with a RiskRoadmap."""

    def __init__(self, terrain=None, clearance=None, *, kind=ob.RealVectorStateSpace, **options):
        self.terrain = hills() if terrain is None else terrain
        self.clearance = clearance or TerrainClearance(self.terrain, 2.0)
        self.setup = og.SimpleSetup(space_of(self.terrain, kind))
        self.si = self.setup.getSpaceInformation()
        planner_options = {"seed": options.pop("seed", 1)}
        if "steering" in options:
            planner_options["steering"] = options.pop("steering")
        if not options.pop("bare", False):
            self.setup.setStateValidityChecker(ClearanceValidityChecker(self.si, self.clearance))
            self.si.setMotionValidator(ClearanceMotionValidator(self.si, self.clearance))
        if not options.pop("no_objective", False):
            self.objective = RiskObjective(
                self.si, self.clearance, InverseDistance(D0), **{"speed": SPEED, **options}
            )
            self.setup.setOptimizationObjective(self.objective)
        self.planner = RiskRoadmap(self.si, **planner_options)
        self.setup.setPlanner(self.planner)

    def state(self, numbers):
        return StateWriter(self.si).state(np.asarray(numbers, dtype=float))

    def between(self, start, goal):
        self.setup.setStartAndGoalStates(self.state(start), self.state(goal))
        return self

    def usual(self):
        return self.between(*ends(self.terrain))

    def solve(self, condition=0.3):
        return self.setup.solve(condition)

    @property
    def path(self):
        return self.setup.getProblemDefinition().getSolutionPath()

    @property
    def cost(self):
        return self.path.cost(self.objective).value()


def once(reached):
    """A condition that waits for progress, not for the clock."""
    limit = time.monotonic() + 60.0
    return ob.PlannerTerminationCondition(lambda: reached() or time.monotonic() > limit)


def found(scene):
    return once(lambda: len(scene.planner.history) > 0)
