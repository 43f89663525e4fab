import math
import textwrap
import time
import warnings

import numpy as np
import pytest
from guard_scene import (
    Forbidden,
    Length,
    PythonGoal,
    RiskyLength,
    run,
    setup,
    state_at,
    sum_of,
    three_goals,
)
from ompl import base as ob
from ompl import control as oc
from ompl import geometric as og
from ompl import tools as ot

import ompl_risk as risk
from ompl_risk.bridge import guarded, guards
from ompl_risk.errors import TrapError, TrapWarning

OMPL_LENGTH = ob.PathLengthOptimizationObjective


@pytest.fixture(autouse=True)
def in_place(monkeypatch):
    """The guards in place, with nothing warned about yet, and afterwards as they were."""
    monkeypatch.delenv(guards.SWITCH, raising=False)
    before = guards.installed()
    guards.install()
    guarded.forget_warnings()
    yield
    guards.install() if before else guards.remove()


class VainOverride(ob.StateCostIntegralObjective):
    def __init__(self, information):
        super().__init__(information, True)

    def stateCost(self, state):
        return ob.Cost(10.0)


class NoOverride(ob.StateCostIntegralObjective):
    def __init__(self, information):
        super().__init__(information, True)


class OwnRoadmap(og.PRMstar):
    pass


# ---- what is refused --------------------------------------------------------------------------

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


def at_the_first_solution(simple):
    """The set-up, content with any path: how long planning takes depends on the machine."""
    simple.getOptimizationObjective().setCostThreshold(ob.Cost(1e9))
    return simple


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


# ---- that it is dangerous: the same calls without guards ----------------------------------------

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


# ---- what is warned about -----------------------------------------------------------------------


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


# ---- what passes unchanged ----------------------------------------------------------------------


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


# ---- benchmarks ---------------------------------------------------------------------------------


def benchmark(objective, *planners, runs=1, simplify=False):
    simple = setup(objective)
    bench = ot.Benchmark(simple, "test")
    for planner in planners:
        bench.addPlanner(planner(simple.getSpaceInformation()))
    return bench, ot.Request(0.1, 4096.0, runs, 0.05, False, False, simplify)


def test_a_benchmark_is_refused_before_its_first_run():
    bench, request = benchmark(RiskyLength, og.RRTstar, og.PRMstar)
    runs = []
    bench.setPreRunEvent(runs.append)
    with pytest.raises(TrapError, match="PRMstar with RiskyLength"):
        bench.benchmark(request)
    assert not runs


def test_an_allocated_planner_is_refused():
    bench, request = benchmark(RiskyLength)
    bench.addPlannerAllocator(og.PRMstar)
    with pytest.raises(TrapError, match="PRMstar with RiskyLength"):
        bench.benchmark(request)


def test_runs_of_aorrtc_are_refused_whatever_the_objective():
    bench, request = benchmark(OMPL_LENGTH, og.AORRTC, runs=2)
    with pytest.raises(TrapError, match="benchmark of 2 runs with AORRTC"):
        bench.benchmark(request)
    bench, request = benchmark(OMPL_LENGTH, og.AORRTC, runs=1)
    bench.benchmark(request)
    assert len(bench.getRecordedExperimentData().planners[0].runs) == 1


def test_removed_planners_are_not_judged():
    bench, request = benchmark(RiskyLength, og.PRMstar)
    bench.clearPlanners()
    bench.benchmark(request)
    assert bench.getRecordedExperimentData().planners == []


def test_a_benchmark_warns_of_simplification_for_a_risk_only():
    bench, request = benchmark(RiskyLength, og.RRTstar, simplify=True)
    with pytest.warns(TrapWarning, match="simplify=False"):
        bench.benchmark(request)
    bench, request = benchmark(OMPL_LENGTH, og.RRTstar, simplify=True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bench.benchmark(request)


def test_a_benchmark_runs_and_calls_the_users_event():
    bench, request = benchmark(RiskyLength, og.RRTstar, og.BITstar, runs=3)
    names = []
    bench.setPreRunEvent(lambda planner: names.append(planner.getName()))
    bench.benchmark(request)
    assert names == ["RRTstar"] * 3 + ["kBITstar"] * 3
    assert [len(p.runs) for p in bench.getRecordedExperimentData().planners] == [3, 3]


# ---- installing and removing --------------------------------------------------------------------

GUARDED = [
    (og.SimpleSetup, "solve"),
    (oc.SimpleSetup, "solve"),
    (ob.Planner, "solve"),
    (og.PRM, "solve"),
    (og.RRTstar, "solve"),
    (oc.RRT, "solve"),
    (og.SimpleSetup, "simplifySolution"),
    (ob.PlannerTerminationCondition, "__init__"),
    (ot.Benchmark, "benchmark"),
]


def current():
    return [vars(owner)[name] for owner, name in GUARDED]


def test_install_and_remove_are_idempotent_and_exact():
    guarded_methods = current()
    assert guards.install()
    assert current() == guarded_methods
    guards.remove()
    originals = current()
    assert not guards.installed()
    assert {type(method).__name__ for method in originals} == {"nb_method"}
    guards.remove()
    assert current() == originals
    assert guards.install()
    assert all(m.__wrapped__ is o for m, o in zip(current(), originals, strict=True))


def test_every_class_with_a_solve_of_its_own_is_guarded():
    for module in (og, oc):
        for owner in vars(module).values():
            if isinstance(owner, type) and "solve" in vars(owner):
                assert hasattr(vars(owner)["solve"], "__wrapped__"), owner


def test_documentation_is_ompls():
    documented = og.SimpleSetup.solve.__doc__
    guards.remove()
    assert documented == og.SimpleSetup.solve.__doc__
    assert "time: float = 1.0" in documented


def test_somebody_elses_patch_survives_removal():
    ours = vars(og.SimpleSetup)["solve"]

    def theirs(self, *args):
        return ours(self, *args)

    original = ours.__wrapped__
    try:
        og.SimpleSetup.solve = theirs
        guards.remove()
        assert vars(og.SimpleSetup)["solve"] is theirs
    finally:
        og.SimpleSetup.solve = original


def test_the_environment_forbids_the_guards(monkeypatch):
    guards.remove()
    monkeypatch.setenv(guards.SWITCH, "0")
    assert guards.install() is False
    assert type(vars(og.SimpleSetup)["solve"]).__name__ == "nb_method"
    monkeypatch.setenv(guards.SWITCH, "1")
    assert guards.install() is True


def test_nothing_leaks_at_exit():
    """nanobind lists what outlives the interpreter; guarded classes and objects must not."""
    body = """
    go()
    simple = setup(RiskyLength, is_free, og.RRTstar)
    simple.solve(0.05)
    simple.solve(ob.PlannerTerminationCondition(lambda: True))
    bench = ot.Benchmark(simple, "test")
    bench.addPlanner(og.RRTstar(simple.getSpaceInformation()))
    bench.setPreRunEvent(lambda planner: None)
    bench.benchmark(ot.Request(0.05, 4096.0, 2, 0.05, False, False, False))
    try:
        setup(Length, is_free, og.PRM).solve(0.1)
    except TrapError:
        print("refused")
    """
    ending, lines, errors = run(body)
    assert (ending, lines) == ("ends", ["refused"])
    assert "leaked" not in errors


# ---- the objects that the guards are for --------------------------------------------------------


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
