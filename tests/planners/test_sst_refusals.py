"""What SST cannot plan for is refused, with what is allowed."""

import math

import pytest
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og
from sst_scene import ridge, setup_of, write

from ompl_risk.bridge import ClearanceValidityChecker, RiskObjective
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.norms import Lp
from ompl_risk.planners.sst.planner import SST


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
    write(setup, buried, [100.0, 60.0, 10.0, 0.0, 0.0, 0.0, 1.0, *[0.0] * 6])
    setup.clearStartStates()
    setup.addStartState(buried)
    planner = SST(setup.getSpaceInformation())
    setup.setPlanner(planner)
    assert setup.solve(1.0).getStatus() == ob.PlannerStatus.INVALID_START
    assert "no start" in planner.reason
