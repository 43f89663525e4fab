"""A known scene: a straight valley through a ridge, and OMPL set-ups over it."""

import numpy as np
import pytest
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from ompl_risk import ClearanceMotionValidator, ClearanceValidityChecker, TerrainClearance
from ompl_risk.bridge import guarded, guards
from ompl_risk.terrains import Terrain

ou.setLogLevel(ou.LOG_NONE)


@pytest.fixture(scope="session")
def pass_clearance():
    """A ridge along y with two gaps: a narrow one on the straight way, a wide one off it."""
    y, x = np.mgrid[0:101, 0:101] * 10.0
    ridge = 200.0 * np.exp(-(((x - 500) / 60) ** 2))
    narrow, wide = np.exp(-(((y - 500) / 40) ** 4)), np.exp(-(((y - 800) / 130) ** 4))
    return TerrainClearance(
        Terrain(ridge * (1 - np.maximum(narrow, wide)), spacing=(10.0, 10.0)), 2.0
    )


@pytest.fixture
def make_setup(pass_clearance):
    """Builds a SimpleSetup across the ridge, under a ceiling of 60 m."""

    def make(objective=None, planner=og.RRTstar, clearance=pass_clearance):
        space = ob.RealVectorStateSpace(3)
        bounds = ob.RealVectorBounds(3)
        for k, (low, high) in enumerate([(0, 1000), (0, 1000), (0, 60)]):
            bounds.setLow(k, low)
            bounds.setHigh(k, high)
        space.setBounds(bounds)
        setup = og.SimpleSetup(space)
        si = setup.getSpaceInformation()
        setup.setStateValidityChecker(ClearanceValidityChecker(si, clearance))
        si.setMotionValidator(ClearanceMotionValidator(si, clearance))
        start, goal = si.allocState(), si.allocState()
        start[0:3], goal[0:3] = [100.0, 500.0, 30.0], [900.0, 500.0, 30.0]
        setup.setStartAndGoalStates(start, goal)
        if objective is not None:
            setup.setOptimizationObjective(objective(si))
        setup.setPlanner(planner(si))
        return setup

    return make


@pytest.fixture
def after():
    """A termination condition after so many calls: unlike a time limit, it reproduces."""

    def condition(calls):
        count = iter(range(calls))
        return ob.PlannerTerminationCondition(lambda: next(count, None) is None)

    return condition


@pytest.fixture
def guards_in_place(monkeypatch):
    """The guards in place, with nothing warned about yet, and afterwards as they were."""
    monkeypatch.delenv(guards.SWITCH, raising=False)
    before = guards.installed()
    guards.install()
    guarded.forget_warnings()
    yield
    guards.install() if before else guards.remove()
