"""Candidates: free paths, the same each time, whatever happens to other tasks."""

import os
import time
from contextlib import contextmanager

import numpy as np
import pytest

from ompl_risk.errors import ArgumentError
from ompl_risk.planners import (
    Candidate,
    Length,
    Status,
    Task,
    candidates,
    low_level_flight,
    parse_criterion,
    solve_task,
)
from ompl_risk.planners.engines import Crew, Engine
from ompl_risk.planners.menu import SEARCHES, menu, parse_task
from ompl_risk.planners.searching import Budget


class Dies(Length):
    """A criterion that ends the process that plans by it."""

    def objective(self, si, problem):
        os._exit(7)


class Raises(Length):
    """A criterion that fails."""

    def objective(self, si, problem):
        raise ArgumentError("something", 1, "else")


def task(criterion, seed=1, planner="BITstar", iterations=1500):
    return Task(planner, parse_criterion(criterion), seed, iterations)


@pytest.mark.parametrize("planner", ["BITstar", "RRTstar", "InformedRRTstar"])
@pytest.mark.parametrize("criterion", ["length", "H1@20"])
def test_candidates_are_free_below_the_ceiling_and_reproducible(problem, planner, criterion):
    one = task(criterion, 3, planner, 1500 if planner == "BITstar" else 400)
    first, second = solve_task(problem, one), solve_task(problem, one)
    assert first.status is Status.SOLVED, first.reason
    np.testing.assert_array_equal(first.positions, second.positions)
    np.testing.assert_array_equal(first.positions[[0, -1]], [problem.start, problem.goal])
    path = first.trajectory(problem.speed).densify(2.0)
    assert problem.clearance(path.positions).min() > problem.min_clearance - 1e-9
    assert (path.positions <= problem.high + 1e-9).all()
    assert (path.positions >= problem.low - 1e-9).all()
    assert first.length == pytest.approx(path.length, rel=1e-12)
    assert first.iterations <= one.iterations
    assert not first.timed_out


def test_another_seed_gives_another_path(problem):
    a, b = (solve_task(problem, task("H1@20", seed)) for seed in (1, 2))
    assert a.length != b.length


def test_weighting_risk_buys_safety_with_time(problem):
    from ompl_risk import Sobolev

    short, safe = (solve_task(problem, task(c, 1, iterations=4000)) for c in ("length", "H1@70"))

    def risk(candidate):
        path = candidate.trajectory(problem.speed).densify(1.0)
        return Sobolev(1)(path.t, problem.avoidance(problem.clearance(path.positions)))

    assert risk(safe) < 0.7 * risk(short)
    assert safe.length > short.length


def test_a_way_that_is_barred_is_no_exception(clearance):
    barred = low_level_flight(
        clearance, (200.0, 1000.0), (2800.0, 1000.0), ceiling=90.0, speed=20.0, margin=0.3
    )
    found = solve_task(barred, task("length"))
    assert found.status is Status.NO_PATH
    assert found.positions is None
    assert "1500 iterations" in found.reason


def test_the_time_limit_stops_a_planner_and_is_told(problem):
    hasty = Task("BITstar", parse_criterion("length"), 1, 10**9, time_limit=0.2)
    begin = time.monotonic()
    found = solve_task(problem, hasty)
    assert found.timed_out
    assert time.monotonic() - begin < 5.0


def test_the_budget_counts_questions():
    budget = Budget(3, 60.0)
    assert [budget() for _ in range(5)] == [False, False, False, True, True]
    assert not budget.timed_out


def test_workers_give_what_this_process_gives_and_survive_deaths(problem):
    good = [task(c, seed) for seed, c in enumerate(("length", "H1@20", "L1@20", "length"), 1)]
    bad = [Task("BITstar", Dies(), 1), Task("BITstar", Raises(), 2)]
    mixed = [good[0], bad[0], good[1], bad[1], good[2], good[3]]
    arrived = []
    found = candidates(problem, mixed, workers=2, on_done=arrived.append)
    assert [c.task for c in found] == mixed
    assert sorted(map(id, arrived)) == sorted(map(id, found))
    assert [c.status for c in found] == [
        Status.SOLVED, Status.FAILED, Status.SOLVED, Status.FAILED, Status.SOLVED, Status.SOLVED
    ]  # fmt: skip
    assert "worker process died" in found[1].reason
    assert found[3].reason == "ArgumentError: something = 1: must be else"
    here = candidates(problem, good, workers=1)
    there = [c for c in found if c.solved]
    for a, b in zip(here, there, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)


class LatestFirst(Engine, Crew):
    """Answers without planning, the last task first."""

    @contextmanager
    def crew(self, problem):
        yield self

    def run(self, jobs):
        for index, each in reversed(list(jobs)):
            yield index, Candidate(each, Status.NO_PATH)


def test_candidates_are_in_the_order_of_the_tasks_not_of_arrival():
    tasks = [task("length", seed) for seed in (1, 2, 3)]
    arrived = []
    found = candidates(None, tasks, engine=LatestFirst(), on_done=arrived.append)
    assert [c.task.seed for c in found] == [1, 2, 3]
    assert [c.task.seed for c in arrived] == [3, 2, 1]


def test_nothing_is_started_for_no_tasks():
    assert candidates(None, [], engine="loky", workers=2) == []


def test_the_time_for_all_tasks_stops_one_and_does_not_start_the_next(problem):
    endless = [Task("BITstar", Length(), seed, 10**9) for seed in (1, 2)]
    arrived = []
    first, second = candidates(problem, endless, total_time=0.3, on_done=arrived.append)
    assert first.timed_out
    assert first.task == endless[0]
    assert first.seconds < 5.0
    assert second.status is Status.NOT_STARTED
    assert "0.3 s" in second.reason
    assert arrived == [first, second]


def test_what_was_found_before_an_interruption_has_been_handed_over(problem):
    arrived = []

    def stop_after_one(candidate):
        arrived.append(candidate)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        candidates(problem, [task("length", k) for k in (1, 2)], on_done=stop_after_one)
    assert len(arrived) == 1


def test_the_menu_gives_each_task_a_seed_of_its_own():
    tasks = menu(runs=3, seed=5)
    assert len(tasks) == 3 * len(SEARCHES)
    assert [t.seed for t in tasks] == list(range(5, 5 + len(tasks)))
    assert {t.planner for t in tasks} == {"BITstar", "RRTstar", "InformedRRTstar"}
    assert menu(["H1@20"], runs=1, effort=0.5)[0].iterations == 7500


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("planner", lambda: Task("PRX", Length())),
        ("criterion", lambda: Task("BITstar", "length")),
        ("seed", lambda: Task("BITstar", Length(), 0)),
        ("seed", lambda: Task("BITstar", Length(), True)),
        ("iterations", lambda: Task("BITstar", Length(), 1, -1)),
        ("time_limit", lambda: Task("BITstar", Length(), 1, 1, 0.0)),
        ("searches", lambda: menu([])),
        ("searches", lambda: menu(["PRX:length"])),
        ("searches", lambda: menu(["AORRTC:length"])),
        ("search", lambda: parse_task("L2.5")),
        ("search", lambda: parse_task(5)),
        ("searches", lambda: menu(["risk"])),
        ("runs", lambda: menu(runs=0)),
        ("effort", lambda: menu(effort=0.0)),
        ("workers", lambda: candidates(None, [], workers=0)),
        ("workers", lambda: candidates(None, [], workers=True)),
        ("total_time", lambda: candidates(None, [], total_time=0.0)),
    ],
)
def test_wrong_tasks_are_refused(argument, make):
    with pytest.raises(ArgumentError) as caught:
        make()
    assert caught.value.argument == argument
