"""OMPL's benchmarks are guarded as its set-ups are."""

import warnings

import pytest
from guard_scene import (
    OMPL_LENGTH,
    RiskyLength,
    benchmark,
)
from ompl import geometric as og

from ompl_risk.errors import TrapError, TrapWarning

pytestmark = pytest.mark.usefixtures("guards_in_place")


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
