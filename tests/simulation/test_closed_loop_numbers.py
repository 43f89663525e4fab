"""Rollouts of the helicopter: the same random numbers whatever else is flown, and what is kept."""

from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from loop_scene import CRUISE, HOVER, flown, ground, hills, plan
from numpy.testing import assert_allclose, assert_array_equal

from ompl_risk import MeshClearance
from ompl_risk._kernels import gusts
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.gusts import DrydenGusts
from ompl_risk.simulation.disturbances.navigation import NavigationError
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.rollouts import fly


def test_two_plans_meet_the_same_gusts_and_errors():
    """Hover at two places, one much faster to collide: the same deviations at the same times."""
    a, b = (plan(HOVER, 6.0, position=p) for p in ((300.0, 300.0, 80.0), (600.0, 700.0, 80.0)))
    both = Disturbances(gusts=DrydenGusts(10.0), navigation=NavigationError())
    one, other = (flown(p, disturbances=both, traced=1) for p in (a, b))
    assert np.abs(one.traces - a.positions).max() > 0.2
    assert_allclose(one.traces - a.positions, other.traces - b.positions, atol=1e-9)


def test_a_plan_does_not_change_the_random_numbers_of_another():
    """A cruise and a turn: at every step their gusts come from the same normal numbers."""
    white = SimpleNamespace(drag=(2.0, 2.0, 2.0), filters=lambda h, *rest: _white(len(h)))
    disturbances = SimpleNamespace(gusts=white, navigation=None, terrain=None)
    ends = []
    for key in (CRUISE, HOVER):
        one = plan(key, 1.0)
        traces = flown(one, disturbances=disturbances, traced=1).traces - one.positions
        ends.append(np.diff(traces, n=2, axis=1)[:, :, 0])
    # in the first steps the law has hardly answered: the accelerations are those of the gusts
    assert np.corrcoef(ends[0][:, :10].ravel(), ends[1][:, :10].ravel())[0, 1] > 0.99


def _white(n):
    rows = np.zeros((n, gusts.FILTER))
    rows[:, gusts.ALONG + 1] = rows[:, gusts.COSINE] = rows[:, gusts.LEVEL_SIGMA] = 1.0
    return rows


def test_each_switch_leaves_the_others_numbers_alone():
    one, navigation = plan(CRUISE, 5.0), NavigationError()
    alone = flown(one, hills(), Disturbances(navigation=navigation))
    none = Disturbances(DrydenGusts(10.0, drag=(0.0, 0.0, 0.0)), navigation)
    with_gusts = flown(one, hills(), none)
    for field in ("least", "when", "where", "collided"):
        assert_allclose(getattr(alone, field), getattr(with_gusts, field), rtol=1e-12)
    with_ground = flown(one, hills(), Disturbances(None, navigation, TerrainError(1e-9)))
    assert_allclose(with_ground.least, alone.least, atol=0.1)


def test_rollouts_do_not_depend_on_threads_chunks_or_how_many_there_are():
    level = Disturbances.level("severe")
    one, clearance = plan(CRUISE, 10.0, position=(100.0, 500.0, 48.0)), hills()
    whole = flown(one, clearance, level, count=60)
    assert 0 < whole.hits.sum() < 60
    threaded = flown(one, clearance, level, count=60, threads=3)
    few = flown(one, clearance, level, count=17)
    for field in ("least", "when", "where", "collided", "endings"):
        assert_array_equal(getattr(threaded, field), getattr(whole, field))
        assert_array_equal(getattr(few, field), getattr(whole, field)[:17])


def test_outcomes_are_read_only_and_counted():
    outcomes = flown(plan(CRUISE, 0.2), count=5)
    assert len(outcomes) == 5
    assert isinstance(outcomes, Outcomes)
    for field in ("least", "when", "where", "collided", "endings", "traces"):
        assert not getattr(outcomes, field).flags.writeable


def test_traces_hold_every_so_manieth_position():
    one = plan(CRUISE, 1.0)
    level = Disturbances.level("moderate")
    fine, coarse = (flown(one, disturbances=level, traced=n).traces for n in (1, 7))
    assert coarse.shape == (8, 50 // 7 + 1, 3)
    assert_array_equal(coarse, fine[:, ::7])


def test_another_clearance_must_be_traced():
    one, nothing = plan(CRUISE, 0.2), Disturbances()
    draws = Draws.make(2, 0, nothing)
    box = MeshClearance([trimesh.creation.box((1.0, 1.0, 1.0))])
    with pytest.raises(ArgumentError, match=r"clearance = .*TerrainClearance"):
        fly(one, box, nothing, draws)
    outcomes = fly(one, box, nothing, draws, traced=5)
    assert_array_equal(outcomes.least, np.inf)
    for bad in (0, -1, 1.5, True):
        with pytest.raises(ArgumentError, match="traced"):
            fly(one, ground(), nothing, draws, traced=bad)
    with pytest.raises(ArgumentError, match="threads"):
        fly(one, ground(), nothing, draws, threads=0)
