"""What may surprise is warned about once, and what is safe passes without a word."""

import math
import time
import warnings

import pytest
from guard_scene import (
    OMPL_LENGTH,
    Forbidden,
    Length,
    RiskyLength,
    at_the_first_solution,
    run,
    setup,
    state_at,
    sum_of,
    three_goals,
)
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og

from ompl_risk.bridge import guards
from ompl_risk.errors import TrapWarning

pytestmark = pytest.mark.usefixtures("guards_in_place")


class NoOverride(ob.StateCostIntegralObjective):
    def __init__(self, information):
        super().__init__(information, True)


@pytest.mark.parametrize(
    ("planner", "objective", "words"),
    [
        (og.RRT, RiskyLength, "not optimised for risk.*ompl_risk.rank"),
        (og.RRTConnect, RiskyLength, "not optimised for risk"),
        (og.KPIECE1, RiskyLength, "not optimised for risk"),
        (og.BKPIECE1, RiskyLength, "not optimised for risk"),
        (og.LBKPIECE1, sum_of(RiskyLength), "not optimised for risk"),
        (og.AORRTC, Length, "minimises the path's length"),
        (og.SORRTstar, ob.PathLengthOptimizationObjective, "hangs for ever if the straight way"),
        (og.FMT, Length, "metric"),
    ],
)
def test_a_warning_once_a_planner_class(planner, objective, words):
    with pytest.warns(TrapWarning, match=words) as caught:
        setup(objective, planner=planner).solve(0.1)
    assert [w.filename for w in caught] == [__file__]  # the user's line, not ours
    with warnings.catch_warnings():
        warnings.simplefilter("error", TrapWarning)
        setup(objective, planner=planner).solve(0.1)


def test_omplss_own_choice_of_a_planner_is_warned_about():
    simple = setup(RiskyLength)
    with pytest.warns(TrapWarning, match="with RiskyLength does not look at the objective"):
        simple.solve(0.1)


def control_setup(objective, planner):
    square = setup().getStateSpace()
    controls = oc.RealVectorControlSpace(square, 2)
    bounds = ob.RealVectorBounds(2)
    bounds.setLow(-1.0)
    bounds.setHigh(1.0)
    controls.setBounds(bounds)
    simple = oc.SimpleSetup(controls)
    information = simple.getSpaceInformation()

    def propagate(state, control, duration, result):
        result[0:2] = [state[0] + control[0] * duration, state[1] + control[1] * duration]

    simple.setStatePropagator(propagate)
    simple.setStateValidityChecker(lambda state: 0 < state[0] < 1 and 0 < state[1] < 1)
    information.setPropagationStepSize(0.05)
    information.setMinMaxControlDuration(1, 5)
    start, goal = state_at(information, 0.1, 0.5), state_at(information, 0.9, 0.5)
    simple.setStartAndGoalStates(start, goal, 0.2)
    simple.setOptimizationObjective(objective(information))
    simple.setPlanner(planner(information))
    return simple


@pytest.mark.parametrize("planner", [oc.RRT, oc.EST, oc.KPIECE1])
def test_control_planners_are_warned_about(planner):
    with pytest.warns(TrapWarning, match=f"{planner.__name__} with RiskyLength"):
        control_setup(RiskyLength, planner).solve(0.2)


def test_a_path_without_finite_cost_is_warned_about():
    simple = setup(Forbidden, planner=og.RRTstar)
    with pytest.warns(TrapWarning, match="cost inf: it collides"):
        status = simple.solve(0.1)
    assert str(status) == "Exact solution"  # OMPL's word is not altered
    assert simple.getSolutionPath().cost(simple.getOptimizationObjective()).value() == math.inf


def test_goals_sampled_lazily_are_warned_about():
    ending, lines, _ = run(
        """
        import warnings
        simple = setup(ob.PathLengthOptimizationObjective, is_free, og.RRTConnect)
        sampler = lambda goal, state: False
        goal = ob.GoalLazySamples(simple.getSpaceInformation(), sampler, False, 1e-3)
        simple.setGoal(goal)
        go()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            simple.solve(0.1)
        print(*(w.category.__name__ for w in caught), "GoalStates" in str(caught[0].message))
        """
    )
    assert (ending, lines) == ("ends", ["TrapWarning True"])


@pytest.mark.parametrize(
    ("planner", "objective"),
    [
        (og.PRM, OMPL_LENGTH),
        (og.PRMstar, OMPL_LENGTH),
        (og.PRM, sum_of(OMPL_LENGTH)),
        (og.FMT, OMPL_LENGTH),
        (og.RRTConnect, Length),
        (og.RRTstar, RiskyLength),
        (og.RRTstar, NoOverride),
        (og.InformedRRTstar, RiskyLength),
        (og.BITstar, RiskyLength),
    ],
)
def test_safe_combinations_solve_without_a_word(planner, objective):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        status = at_the_first_solution(setup(objective, planner=planner)).solve(20.0)
    assert isinstance(status, ob.PlannerStatus)
    assert str(status) == "Exact solution"


def test_prm_with_several_goals_and_a_compiled_checker_passes():
    simple = setup(OMPL_LENGTH, ob.AllValidStateValidityChecker, og.PRM)
    simple.setGoal(three_goals(simple.getSpaceInformation()))
    assert str(at_the_first_solution(simple).solve(20.0)) == "Exact solution"


def test_growing_a_roadmap_with_a_risk_passes():
    simple = setup(RiskyLength, planner=og.PRMstar)
    simple.setup()
    simple.getPlanner().growRoadmap(0.1)
    assert simple.getPlanner().milestoneCount() > 2


@pytest.mark.parametrize(
    ("arguments", "seconds"),
    [
        (((0.2,), {}), 0.2),
        (((), {"time": 0.2}), 0.2),
        (((0,), {}), 0.0),
        (((1.2,), {}), 1.2),
        (((), {}), 1.0),
    ],
)
def test_a_time_limit_means_what_it_means_to_ompl(arguments, seconds):
    args, kwargs = arguments
    simple = setup(OMPL_LENGTH, planner=og.RRTstar)
    simple.setup()
    start = time.perf_counter()
    simple.solve(*args, **kwargs)
    assert seconds - 0.01 <= time.perf_counter() - start < seconds + 0.5


def test_conditions_are_passed_through():
    simple = setup(OMPL_LENGTH, planner=og.RRTstar)
    asked = []
    condition = ob.PlannerTerminationCondition(lambda: asked.append(None) or len(asked) > 50)
    simple.solve(condition)
    assert len(asked) > 50
    simple.solve(ptc=ob.timedPlannerTerminationCondition(0.05))
    simple.getPlanner().solve(ob.timedPlannerTerminationCondition(0.05))
    ob.Planner.solve(simple.getPlanner(), lambda: True)
    ob.Planner.solve(simple.getPlanner(), solveTime=0.05)


@pytest.mark.parametrize(
    ("args", "kwargs"), [(("soon",), {}), ((None,), {}), ((), {"tme": 1.0}), ((0.1, 0.1), {})]
)
def test_wrong_arguments_are_left_to_ompl(args, kwargs):
    with pytest.raises(TypeError, match="incompatible function arguments"):
        setup(OMPL_LENGTH, planner=og.RRTstar).solve(*args, **kwargs)


@pytest.mark.parametrize("args", [(3,), (lambda: True, "often")])
def test_wrong_conditions_are_left_to_ompl(args):
    with pytest.raises(TypeError, match="incompatible function arguments"):
        ob.PlannerTerminationCondition(*args)


def test_a_planner_without_a_problem_is_left_to_ompl():
    with pytest.raises(RuntimeError, match=r"(?i)problem definition|pdef|setup"):
        og.RRTstar(setup().getSpaceInformation()).solve(0.1)


class Patient(ob.Planner):
    """A planner written in Python, which runs another one inside."""

    def __init__(self, information):
        super().__init__(information, "Patient")
        self.seen = []

    def solve(self, ptc):
        self.seen.append(type(ptc))
        inner = og.RRTConnect(self.getSpaceInformation())
        inner.setProblemDefinition(self.getProblemDefinition())
        inner.setup()
        return inner.solve(ptc)


def test_planners_in_python_run_as_before():
    simple = setup(Length, planner=Patient)
    assert str(simple.solve(20.0)) == "Exact solution"
    assert str(ob.Planner.solve(simple.getPlanner(), 20.0)) == "Exact solution"
    assert simple.getPlanner().seen == [ob.PlannerTerminationCondition] * 2


def test_a_solve_costs_microseconds_more():
    simple = setup(OMPL_LENGTH, ob.AllValidStateValidityChecker, og.RRTConnect)
    simple.setup()
    planner, problem = simple.getPlanner(), simple.getProblemDefinition()

    def best(repeats=7, number=200):
        times = []
        for _ in range(repeats):
            start = time.perf_counter()
            for _ in range(number):
                planner.clear()
                problem.clearSolutionPaths()
                simple.solve(0.5)
            times.append((time.perf_counter() - start) / number)
        return min(times)

    with_guards = best()
    guards.remove()
    assert with_guards - best() < 200e-6  # 15 us measured, on an idle machine
