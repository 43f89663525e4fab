"""Units are worked on in processes and on a Dask cluster, and no death stops the rest."""

import contextlib
import os
from functools import partial

import pytest
from evidence_pieces import deadly, noted, one_code, square

from benchmarks import working
from benchmarks.evidence import engines
from benchmarks.evidence.engines import ClusterLostError, Dask, Local, Lost
from ompl_risk.errors import ArgumentError


@pytest.mark.parametrize("workers", [1, 2])
def test_local_processes_do_each_unit_once(workers):
    found = dict(Local(workers).run(square, [4, 0, 9], pytest.fail))
    assert {unit: answer for unit, (answer, _) in found.items()} == {4: 16, 0: 0, 9: 81}
    here = {pid for _, pid in found.values()} == {os.getpid()}
    assert here == (workers == 1)
    assert list(Local(workers).run(square, [], pytest.fail)) == []


def test_a_local_process_that_dies_is_replaced(tmp_path):
    said = []
    found = dict(Local(2).run(partial(noted, tmp_path), range(6), said.append))
    assert {unit: answer for unit, (answer, _) in found.items()} == {k: k * k for k in range(6)}
    assert len(list(tmp_path.glob("1.*"))) == 2
    assert len(said) == 1
    assert said[0].startswith("a worker process died; ")
    assert said[0].endswith(" units are left and started again")


def test_local_processes_that_always_die_are_given_up():
    found = []
    with pytest.raises(working.WorkersDiedError, match=r"3 times.* units are left") as death:
        found.extend(Local(2).run(deadly, [0, 1], lambda _: None))
    assert 1 in death.value.left


@pytest.fixture(autouse=True)
def code(monkeypatch):
    monkeypatch.setattr(engines, "code", one_code)


@pytest.fixture(scope="module")
def address():
    """A running cluster of two processes, which gives a unit up at its second death."""
    distributed = pytest.importorskip("distributed")
    from dask import config

    with (
        config.set({"distributed.scheduler.allowed-failures": 1}),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, memory_limit=0, dashboard_address=":0",
            silence_logs=50,
        ) as cluster,
    ):  # fmt: skip
        yield cluster.scheduler_address


def test_a_cluster_does_each_unit_in_other_processes(address):
    said = []
    found = dict(Dask(2, address).run(square, range(12), said.append))
    assert {unit: answer for unit, (answer, _) in found.items()} == {k: k * k for k in range(12)}
    pids = {pid for _, pid in found.values()}
    assert os.getpid() not in pids
    assert said == ["2 threads of a Dask cluster at work"]


def test_a_worker_of_a_cluster_that_dies_loses_nothing(address, tmp_path):
    found = dict(Dask(2, address).run(partial(noted, tmp_path), range(6), lambda _: None))
    assert {unit: answer for unit, (answer, _) in found.items()} == {k: k * k for k in range(6)}
    assert len(list(tmp_path.glob("1.*"))) == 2


def test_a_unit_whose_workers_died_is_tried_again_alone(address, tmp_path):
    work = partial(noted, tmp_path, deaths=2)  # once more than the cluster tries
    found = list(Dask(2, address).run(work, range(4), lambda _: None))
    assert found[-1][0] == 1
    assert found[-1][1][0] == 1
    assert {unit: answer for unit, (answer, _) in found} == {k: k * k for k in range(4)}
    assert len(list(tmp_path.glob("1.*"))) == 3


def test_a_unit_that_kills_or_raises_is_lost_and_the_others_go_on(address):
    found = dict(Dask(2, address).run(deadly, [1, 2, 3, 4], lambda _: None))
    assert found[3][0] == 9
    assert found[4][0] == 16
    assert isinstance(found[1], Lost)
    assert found[1].reason.startswith("KilledWorker: ")
    assert found[2] == Lost("RuntimeError: no wind")


def test_a_run_that_is_left_leaves_the_cluster_usable(address):
    coming = Dask(2, address).run(square, range(50), lambda _: None)
    next(coming)
    coming.close()
    assert dict(Dask(2, address).run(square, [3], lambda _: None))[3][0] == 9


class Elsewhere:
    """A client of a cluster whose workers are not what they should be."""

    def __init__(self, codes):
        self.codes = codes

    def wait_for_workers(self, _count, timeout):
        if self.codes is None:
            raise TimeoutError

    def run(self, _function):
        if isinstance(self.codes, Exception):
            raise self.codes
        return self.codes


@pytest.mark.parametrize(
    ("codes", "message"),
    [
        (None, "a cluster with workers: it had none in 60 s"),
        (ImportError("No module named 'benchmarks'"), "can import what is here .No module named"),
        ({"a": one_code(), "b": "old"}, "the code c0de of here, not old"),
    ],
)
def test_workers_that_cannot_do_it_are_refused(monkeypatch, codes, message):
    pytest.importorskip("distributed")
    client = contextlib.nullcontext(Elsewhere(codes))
    monkeypatch.setattr(Dask, "_client", lambda _self: client)
    with pytest.raises(ArgumentError, match=f"scheduler = 'tcp://far:1': must be .*{message}"):
        list(Dask(2, "tcp://far:1").run(square, [3], pytest.fail))


def test_a_cluster_that_goes_away_is_told():
    class Gone:
        status = "cancelled"

    pytest.importorskip("distributed")
    with pytest.raises(ClusterLostError, match="the Dask cluster has gone"):
        Dask(2)._result(Gone())


def test_an_address_where_nothing_listens_is_refused():
    pytest.importorskip("distributed")
    from dask import config

    with (
        config.set({"distributed.comm.timeouts.connect": "1s"}),
        pytest.raises(ArgumentError, match="the address of a running Dask scheduler"),
    ):
        list(Dask(2, "tcp://127.0.0.1:9").run(square, [3], pytest.fail))
    assert list(Dask(2, "tcp://127.0.0.1:9").run(square, [], pytest.fail)) == []
