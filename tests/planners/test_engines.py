"""Engines: the same candidates everywhere, and a death costs only the task that died."""

import ctypes
import os
import sys
from contextlib import contextmanager
from dataclasses import replace
from pickle import PicklingError

import joblib.parallel
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ompl_risk import TerrainClearance
from ompl_risk.errors import ArgumentError, ExtraError
from ompl_risk.planners import Candidate, Length, Problem, Status, Task, candidates, parse_criterion
from ompl_risk.planners.engine_choice import engine_of
from ompl_risk.planners.engines import Crew, Death, Engine, InProcess, Loky
from ompl_risk.planners.working import PROCESS, BytesParcel, FileParcel, packed, work


class Dies(Length):
    """A criterion that ends the process that plans by it."""

    def objective(self, si, problem):
        os._exit(7)


class Hangs(Length):
    """A criterion that sleeps with the interpreter's lock held, as a planner in C++ would hang."""

    def objective(self, si, problem):
        ctypes.PyDLL(None).sleep(100)


class StaysHere(Length):
    """A criterion that cannot be pickled."""

    def __reduce__(self):
        raise TypeError("not to be pickled")


def tasks_of(*criteria):
    return [Task("BITstar", parse_criterion(c), k, 800) for k, c in enumerate(criteria, 1)]


def assert_same(found, expected):
    assert [c.status for c in found] == [c.status for c in expected]
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_array_equal(a.positions, b.positions)


# --- deaths, with workers that are only played -------------------------------------------------


class Mortal(Engine):
    """Plays workers of which those with a culprit die.

    Args:
        culprits: indices of the tasks that kill.
        size: number of workers.
        tells: whether it knows whose worker died; else it raises, and what ran is lost.
        rng: decides which of the running tasks comes to its end first.
    """

    deaths = (ChildProcessError, PicklingError)

    def __init__(self, culprits, size, tells, rng):
        self.culprits, self.size, self.tells, self.rng = culprits, size, tells, rng
        self.runs = []

    @contextmanager
    def crew(self, problem):
        yield _Played(self)


class _Played(Crew):
    def __init__(self, engine):
        self.engine = engine

    @property
    def size(self):
        return self.engine.size

    def run(self, jobs):
        engine, waiting, running = self.engine, list(jobs), []
        while waiting or running:
            while waiting and len(running) < engine.size:
                running.append(waiting.pop(0))
            index, task = running.pop(engine.rng.randrange(len(running)))
            engine.runs.append(index)
            if index not in engine.culprits:
                yield index, Candidate(task, Status.NO_PATH)
            elif engine.tells:
                yield index, Death(ChildProcessError(f"task {index}"))
            else:
                raise ChildProcessError(f"task {index}. And so on")


@given(
    st.integers(1, 12),
    st.sets(st.integers(0, 11)),
    st.integers(1, 4),
    st.booleans(),
    st.randoms(use_true_random=False),
)
def test_whoever_dies_is_told_and_nobody_else(count, culprits, size, tells, rng):
    tasks = [Task("BITstar", Length(), seed) for seed in range(1, count + 1)]
    arrived = []
    engine = Mortal(culprits, size, tells, rng)
    found = candidates(None, tasks, engine=engine, on_done=arrived.append)
    assert [c.task for c in found] == tasks
    assert sorted(c.task.seed for c in arrived) == list(range(1, count + 1))
    for index, candidate in enumerate(found):
        dead = index in culprits
        assert candidate.status is (Status.FAILED if dead else Status.NO_PATH)
        assert candidate.reason == (f"the worker process died: task {index}" if dead else "")
    if tells and count > 1:  # a second try for each who seemed to die, and no more
        assert len(engine.runs) == count + len(culprits & set(range(count)))


def test_other_errors_of_an_engine_pass_through(problem):
    class Broken(InProcess):
        @contextmanager
        def crew(self, problem):
            raise OSError("no network")
            yield

    with pytest.raises(OSError, match="no network"):
        candidates(problem, tasks_of("length"), engine=Broken())


# --- real processes ----------------------------------------------------------------------------


def test_processes_survive_a_hang_and_a_task_that_cannot_travel(problem):
    good = tasks_of("length", "H1@20")
    bad = [Task("BITstar", Hangs(), 1, 10, 0.3), Task("BITstar", StaysHere(), 1, 10)]
    found = candidates(problem, [good[0], *bad, good[1]], workers=2, grace=0.7)
    assert [c.status for c in found] == [
        Status.SOLVED, Status.FAILED, Status.FAILED, Status.SOLVED
    ]  # fmt: skip
    assert "hung" in found[1].reason
    assert "cannot be sent" in found[2].reason
    assert found[1].timed_out
    assert not found[2].timed_out
    assert_same([found[0], found[3]], candidates(problem, good))


def test_functions_travel_to_processes_too(problem):
    """A clearance that only this process knows: a lambda over a terrain."""
    inner = problem.clearance
    private = replace_clearance(problem, lambda points: 1.0 * inner(points))
    tasks = [replace(t, iterations=150) for t in tasks_of("length", "length")]
    assert_same(candidates(private, tasks, workers=2), candidates(private, tasks))


def test_a_problem_that_cannot_travel_is_refused_and_may_stay(problem):
    class Rooted(TerrainClearance):
        def __reduce_ex__(self, protocol):
            raise TypeError("rooted")

    rooted = replace_clearance(problem, Rooted(problem.clearance.terrain, radius=5.0))
    with pytest.raises(ArgumentError, match=r"rooted.*workers=1"):
        candidates(rooted, tasks_of("length"), workers=2)
    (found,) = candidates(rooted, tasks_of("length"))
    assert found.solved


def replace_clearance(problem, clearance):
    return Problem(
        clearance,
        problem.start,
        problem.goal,
        problem.low,
        problem.high,
        speed=problem.speed,
        avoidance=problem.avoidance,
        min_clearance=problem.min_clearance,
    )


def test_any_backend_registered_with_joblib_will_do(problem, monkeypatch):
    """Threads, under another name: they plan one after the other, and nobody ends the process."""
    monkeypatch.setitem(joblib.parallel.BACKENDS, "house", joblib.parallel.BACKENDS["threading"])
    tasks = tasks_of("length", "H1@20", "L1@20")
    found = candidates(problem, tasks, engine="house", workers=2, grace=0.0)
    assert_same(found, candidates(problem, tasks))


# --- parcels -----------------------------------------------------------------------------------


def test_a_parcel_is_opened_once(problem, tmp_path):
    path = tmp_path / "problem"
    path.write_bytes(packed(problem))
    (task,) = tasks_of("length")
    for parcel in (FileParcel(str(path)), BytesParcel("key", packed(problem))):
        index, first = work(parcel, 5, task, 1.0, PROCESS)
        path.unlink(missing_ok=True)  # what is gone now is not read a second time
        same = BytesParcel("key", b"") if isinstance(parcel, BytesParcel) else parcel
        _, second = work(same, 5, task, 1.0, PROCESS)
        assert index == 5
        assert_same([first], [second])


# --- names -------------------------------------------------------------------------------------


def test_one_worker_of_this_machine_is_this_process():
    assert isinstance(engine_of("loky", 1), InProcess)
    assert isinstance(engine_of("loky", 2), Loky)
    made = Loky(2)
    assert engine_of(made, 1) is made


@pytest.mark.parametrize(
    ("argument", "make"),
    [
        ("engine", lambda: engine_of("lucky")),
        ("engine", lambda: engine_of("multiprocessing")),
        ("engine", lambda: engine_of("threading")),
        ("engine", lambda: engine_of(None)),
        ("workers", lambda: engine_of("loky", 0)),
        ("workers", lambda: engine_of("loky", 1.5)),
        ("grace", lambda: engine_of("loky", 2, grace=-1.0)),
        ("grace", lambda: engine_of("loky", 2, grace="long")),
        ("options", lambda: engine_of("loky", 2, scheduler="tcp://127.0.0.1:1")),
        ("options", lambda: engine_of(InProcess(), grace=1.0)),
    ],
)
def test_wrong_engines_are_refused(argument, make):
    with pytest.raises(ArgumentError) as caught:
        make()
    assert caught.value.argument == argument


def test_the_refusal_names_what_there_is_and_why_others_will_not_do():
    with pytest.raises(ArgumentError, match="one of loky, dask, ray"):
        engine_of("lucky")
    with pytest.raises(ArgumentError, match="waits for ever for a process that died"):
        engine_of("multiprocessing")


@pytest.mark.parametrize(("engine", "package"), [("dask", "distributed"), ("ray", "ray")])
def test_a_missing_package_is_named_with_its_extra(engine, package, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ExtraError, match=rf"{package} is not installed.*ompl-risk\[{engine}\]"):
        engine_of(engine)


# --- Dask, where it is installed ---------------------------------------------------------------


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    config = pytest.importorskip("dask").config
    with (
        config.set({"distributed.scheduler.allowed-failures": 1}),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50
        ) as cluster,
    ):
        yield cluster


@pytest.mark.timeout(200)
def test_a_dask_cluster_gives_what_this_process_gives_and_survives_deaths(problem, cluster):
    good = tasks_of("length", "H1@20", "L1@20")
    mixed = [good[0], Task("BITstar", Dies(), 1), good[1], good[2]]
    arrived = []
    found = candidates(
        problem,
        mixed,
        workers=2,
        engine="dask",
        scheduler=cluster.scheduler_address,
        on_done=arrived.append,
    )
    assert [c.task for c in found] == mixed
    assert sorted(map(id, arrived)) == sorted(map(id, found))
    assert found[1].status is Status.FAILED
    assert "died" in found[1].reason
    assert_same([found[0], *found[2:]], candidates(problem, good))


@pytest.mark.timeout(200)
def test_a_dask_cluster_of_our_own_survives_deaths_too(problem):
    pytest.importorskip("distributed")
    good = tasks_of("length", "length")
    found = candidates(problem, [good[0], Task("BITstar", Dies(), 1), good[1]], engine="dask")
    assert [c.status for c in found] == [Status.SOLVED, Status.FAILED, Status.SOLVED]
    assert_same([found[0], found[2]], candidates(problem, good))


def test_dask_takes_a_client_and_refuses_what_contradicts_or_does_not_answer(problem, cluster):
    from distributed import Client

    with Client(cluster, set_as_default=False) as client:
        (found,) = candidates(problem, tasks_of("length"), engine="dask", client=client)
        assert client.status == "running"
        with pytest.raises(ArgumentError, match="left out where client is given"):
            engine_of("dask", client=client, scheduler=cluster.scheduler_address)
    assert found.solved
    with pytest.raises(ArgumentError, match="running Dask scheduler"):
        candidates(problem, tasks_of("length"), engine="dask", scheduler="nowhere")
