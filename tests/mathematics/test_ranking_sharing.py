"""Trajectories shared out to threads: the same results, and nobody else's code in a thread."""

import math
import threading

import numpy as np
import pytest

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.ranking import rank
from ompl_risk.ranking.sharing import each, shared_out
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

RNG = np.random.default_rng(8)
ROUGH = Terrain(RNG.normal(size=(23, 34)) * 2.0, spacing=(3.0, 3.0))
PATHS = [
    Trajectory(np.arange(9.0), np.column_stack([np.linspace(5, 90, 9), RNG.uniform(5, 60, 9),
                                                RNG.uniform(9, 30, 9)]), f"T{k}")
    for k in range(12)
]  # fmt: skip
F = InverseDistance(20.0)
NORMS = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1), Sobolev(2))


def test_any_number_of_threads_gives_the_same_ranking():
    one, three = (rank(PATHS, TerrainClearance(ROUGH, threads=n), F, NORMS) for n in (1, 3))
    assert one.orders == three.orders
    for a, b in zip(one.assessments, three.assessments, strict=True):
        assert a.name == b.name
        assert a.norms == b.norms
        assert np.array_equal(a.d, b.d)
        assert np.array_equal(a.trajectory.positions, b.trajectory.positions)
        assert a.attribution["H1"].share == b.attribution["H1"].share


def threads_of(clearance, avoidance, norms):
    seen = set()

    def spy(points):
        seen.add(threading.get_ident())
        return clearance(points)

    rank(PATHS, spy, avoidance, norms)
    return seen


def test_a_plain_callable_is_called_by_the_caller_only():
    assert threads_of(TerrainClearance(ROUGH), F, NORMS) == {threading.get_ident()}


class OwnClearance(TerrainClearance):
    pass


class OwnNorm(Lp):
    pass


class OwnAvoidance(InverseDistance):
    pass


@pytest.mark.parametrize(
    ("clearance", "parts", "count", "threads"),
    [
        (TerrainClearance(ROUGH, threads=3), (F, *NORMS), 12, 3),
        (TerrainClearance(ROUGH, threads=3), (F, *NORMS), 6, 3),
        (TerrainClearance(ROUGH, threads=3), (F, *NORMS), 5, 1),  # too few: points are shared out
        (TerrainClearance(ROUGH, threads=1), (F, *NORMS), 12, 1),
        (OwnClearance(ROUGH, threads=3), (F, *NORMS), 12, 1),
        (TerrainClearance(ROUGH, threads=3), (F, Lp(1), OwnNorm(2)), 12, 1),
        (TerrainClearance(ROUGH, threads=3), (OwnAvoidance(9.0), Lp(1)), 12, 1),
        (len, (F, *NORMS), 12, 1),
    ],
)
def test_only_our_own_code_runs_in_threads(clearance, parts, count, threads):
    used, found = shared_out(clearance, parts, count)
    assert found == threads
    if threads > 1:
        assert used.threads == 1
        assert clearance.threads == 3  # the caller's stays as it was
        assert used.radius == clearance.radius
    elif isinstance(clearance, TerrainClearance) and clearance.threads > 1:
        assert used is clearance


def test_results_keep_their_order_and_errors_arrive():
    assert each(lambda k: k * k, range(20), 3) == tuple(k * k for k in range(20))

    def work(k):
        if k in (3, 7):
            raise KeyError(k)
        return k

    with pytest.raises(KeyError, match="3"):
        each(work, range(20), 3)


def test_a_norm_that_refuses_is_told_from_a_thread_too():
    two = [Trajectory([0.0, 1.0], [[5, 5, 14], [6, 6, 15]], f"S{k}") for k in range(8)]
    with pytest.raises(ArgumentError, match="at least 3"):
        rank(two, TerrainClearance(ROUGH, threads=2), F, [Sobolev(2)], max_step=None)
