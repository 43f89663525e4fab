"""What hangs or crashes in OMPL is refused, with the way round it."""

import textwrap
import warnings

import numpy as np
import pytest
from guard_scene import (
    OMPL_LENGTH,
    Length,
    PythonGoal,
    RiskyLength,
    at_the_first_solution,
    run,
    setup,
    sum_of,
    three_goals,
)
from ompl import base as ob
from ompl import geometric as og

import ompl_risk as risk
from ompl_risk.errors import TrapError

pytestmark = pytest.mark.usefixtures("guards_in_place")


class VainOverride(ob.StateCostIntegralObjective):
    def __init__(self, information):
        super().__init__(information, True)

    def stateCost(self, state):
        return ob.Cost(10.0)


class OwnRoadmap(og.PRMstar):
    pass


REFUSED = [
    (og.PRM, Length, "RRTstar"),
    (og.PRMstar, RiskyLength, "growRoadmap"),
    (OwnRoadmap, Length, "growRoadmap"),
    (og.PRM, sum_of(OMPL_LENGTH, Length), "growRoadmap"),
    (og.FMT, RiskyLength, "BITstar"),
    (og.BFMT, sum_of(RiskyLength, OMPL_LENGTH), "BITstar"),
    (og.AORRTC, RiskyLength, "RRTstar"),
    (og.RRTstar, VainOverride, "RiskObjective"),
    (og.RRTConnect, sum_of(VainOverride), "RiskObjective"),
]


@pytest.mark.parametrize("direct", [False, True])
@pytest.mark.parametrize(("planner", "objective", "way_round"), REFUSED)
def test_a_trap_is_refused_with_the_way_round(planner, objective, way_round, direct):
    simple = setup(objective, planner=planner)
    if direct:
        simple.setup()
    solve = simple.getPlanner().solve if direct else simple.solve
    with pytest.raises(TrapError, match=way_round):
        solve(0.1)


def test_the_error_names_planner_and_objective():
    with pytest.raises(TrapError, match=r"PRMstar with RiskyLength.*hangs"):
        setup(RiskyLength, planner=og.PRMstar).solve(0.1)


def test_a_planner_from_an_allocator_is_refused():
    simple = setup(RiskyLength)
    simple.setPlannerAllocator(og.PRMstar)
    with pytest.raises(TrapError, match="PRMstar"):
        simple.solve(0.1)


def test_prm_with_a_python_goal_is_refused():
    simple = setup(OMPL_LENGTH, planner=og.PRM)
    simple.setGoal(PythonGoal(simple.getSpaceInformation()))
    with pytest.raises(TrapError, match=r"PythonGoal.*GoalState"):
        simple.solve(0.1)


def test_prm_with_several_goals_and_a_python_checker_is_refused():
    simple = setup(OMPL_LENGTH, planner=og.PRM)
    simple.setGoal(three_goals(simple.getSpaceInformation()))
    with pytest.raises(TrapError, match="several goal states"):
        simple.solve(0.1)


def test_prm_with_a_python_condition_is_refused():
    simple = setup(OMPL_LENGTH, planner=og.PRM)
    condition = ob.PlannerTerminationCondition(lambda: True)
    with pytest.raises(TrapError, match="timedPlannerTerminationCondition"):
        simple.solve(condition)


def test_a_periodic_python_condition_is_refused():
    with pytest.raises(TrapError, match=r"every 0\.01 s.*leave the period out"):
        ob.PlannerTerminationCondition(lambda: True, 0.01)
    simple = setup(OMPL_LENGTH, planner=og.RRTstar)
    simple.setup()
    with pytest.raises(TrapError, match="leave the period out"):
        ob.Planner.solve(simple.getPlanner(), lambda: True, 0.01)


def test_simplification_is_refused_for_a_risk_only():
    simple = setup(RiskyLength, planner=og.RRTstar)
    simple.solve(0.1)
    with pytest.raises(TrapError, match="partialShortcutPath"):
        simple.simplifySolution()
    simple = setup(Length, planner=og.RRTstar)
    simple.solve(0.1)
    simple.simplifySolution(0.05)
    assert simple.getLastSimplificationTime() > 0.0


GOAL = """
simple = setup(ob.PathLengthOptimizationObjective, is_free, og.PRM)
simple.setGoal(PythonGoal(simple.getSpaceInformation()))
"""
CONDITION = """
simple = setup(ob.PathLengthOptimizationObjective, is_free, og.PRM)
end = time.monotonic() + 0.05
limit = ob.PlannerTerminationCondition(lambda: time.monotonic() > end)
"""
NO_OVERRIDE = """
class Nothing(Length):
    pass
simple = setup(Nothing, is_free, og.PRM)
"""
SUM = "simple = setup(sum_of(Length), is_free, og.PRMstar)"
HANGING = {"goal": GOAL, "condition": CONDITION, "no override": NO_OVERRIDE, "sum": SUM}


@pytest.mark.parametrize("problem", HANGING.values(), ids=HANGING)
def test_what_is_refused_hangs_sooner_or_later_without_guards(problem):
    """A race: most of these hang in the first solve, some in the third."""
    loop = textwrap.indent(f"{problem}\nsimple.solve(limit)\nprint('solved', flush=True)", "    ")
    body = f"import time\nlimit = 0.05\ngo()\nwhile True:\n{loop}"
    ending, lines, _ = run(body, guarded=False, limit=2.0)
    assert ending == "hangs"
    assert set(lines) <= {"solved"}
    assert len(lines) < 20  # of the 40 for which there was time


def test_a_refused_aorrtc_can_be_destroyed():
    """AORRTC's destructor crashes if it was never set up; refusing must not lead there."""
    body = """
    go()
    simple = setup(RiskyLength, is_free, og.AORRTC)
    planner = og.AORRTC(simple.getSpaceInformation())
    planner.setProblemDefinition(simple.getProblemDefinition())
    benchmark = ot.Benchmark(simple, "test")
    benchmark.addPlanner(og.PRM(simple.getSpaceInformation()))
    benchmark.addPlanner(og.AORRTC(simple.getSpaceInformation()))
    request = ot.Request(0.1, 4096.0, 1, 0.05, False, False, False)
    for call in (simple.solve, planner.solve, lambda _: benchmark.benchmark(request)):
        try:
            call(0.1)
        except TrapError:
            print("refused")
    """
    assert run(body)[:2] == ("ends", ["refused"] * 3)


@pytest.fixture
def over_flat_ground():
    """A SimpleSetup with the library's own checker and objective, 10 to 60 m above the ground."""
    flat = risk.terrains.Terrain(np.zeros((10, 10)), spacing=(10.0, 10.0))
    clearance = risk.TerrainClearance(flat)
    space = ob.RealVectorStateSpace(3)
    space.setBounds(10.0, 60.0)
    simple = og.SimpleSetup(space)
    information = simple.getSpaceInformation()
    start, goal = information.allocState(), information.allocState()
    start[0:3], goal[0:3] = [15.0, 15.0, 20.0], [50.0, 50.0, 20.0]
    simple.setStartAndGoalStates(start, goal)
    simple.setStateValidityChecker(risk.ClearanceValidityChecker(information, clearance))
    avoidance = risk.InverseDistance(40.0)
    simple.setOptimizationObjective(
        risk.RiskObjective(information, clearance, avoidance, speed=1.0)
    )
    return simple


@pytest.mark.parametrize("planner", [og.PRM, og.PRMstar, og.FMT, og.BFMT, og.AORRTC])
def test_the_risk_objective_is_kept_from_its_traps(over_flat_ground, planner):
    over_flat_ground.setPlanner(planner(over_flat_ground.getSpaceInformation()))
    with pytest.raises(TrapError, match=f"{planner.__name__} with RiskObjective"):
        over_flat_ground.solve(0.1)


@pytest.mark.parametrize("planner", [og.RRTstar, og.InformedRRTstar, og.SORRTstar, og.BITstar])
def test_the_risk_objective_solves_but_is_not_simplified(over_flat_ground, planner):
    over_flat_ground.setPlanner(planner(over_flat_ground.getSpaceInformation()))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert at_the_first_solution(over_flat_ground).solve(20.0)
    with pytest.raises(TrapError, match="RiskObjective"):
        over_flat_ground.simplifySolution()
