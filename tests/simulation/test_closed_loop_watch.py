"""The continuous check of rollouts: contact, least clearance, the error of the map, endings."""

import math

import numba
import numpy as np
import pytest
from loop_scene import CRUISE, HOVER, TURN, flown, ground, hills, plan, steady
from numpy.testing import assert_allclose, assert_array_equal

from ompl_risk import TerrainClearance
from ompl_risk._kernels import watch
from ompl_risk._kernels.air import COMPLETED, LEFT_MAP, LOST_CONTROL, TOUCHED
from ompl_risk._kernels.watch import CONTACT, TOLERANCE
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.air import air_for
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.terrains import Terrain

FINE = 40
"""Samples of a step for brute force."""


def sampled(clearance, trace):
    """Clearances along a trace of every step, and the times [steps] of the samples."""
    t = np.linspace(0.0, len(trace) - 1.0, FINE * (len(trace) - 1) + 1)
    places = np.column_stack([np.interp(t, np.arange(len(trace)), x) for x in trace.T])
    return clearance(places), t


def on_other_ground(plan, clearance, disturbances, handle, *, count):
    """Rollouts in the gusts over one ground that are checked against another, or none at all."""
    outcomes = Outcomes.room(count, len(plan.times))
    draws = Draws.make(count, 0, disturbances)
    air = air_for(plan, clearance, disturbances, draws, traces=outcomes.traces)
    handle = handle.view()
    handle.setflags(write=False)  # as in any other air: another kind would be compiled anew
    plan.run(air._replace(handle=handle), 0, count, outcomes)
    return outcomes


@pytest.mark.parametrize("key", [CRUISE, TURN])
def test_the_least_clearance_is_that_of_a_dense_sample(key):
    one, clearance = plan(key, 20.0, position=(300.0, 500.0, 42.0)), hills()
    outcomes = flown(one, clearance, count=2, traced=1)
    d, _ = sampled(clearance, outcomes.traces[0])
    assert d.min() > 1.0
    assert d.min() - 0.01 <= outcomes.least[0] <= d.min() + TOLERANCE
    assert outcomes.least[0] < clearance(one.positions[:1])[0] - 2.0
    assert outcomes.least[0] == outcomes.least[1]


def test_least_when_and_where_belong_together():
    one, clearance = plan(CRUISE, 20.0, position=(100.0, 500.0, 42.0)), hills()
    level = Disturbances.level("moderate")
    disturbances = Disturbances(level.gusts, level.navigation)
    outcomes = flown(one, clearance, disturbances, count=20, traced=1)
    free = ~outcomes.hits
    assert 10 < free.sum() < 20
    assert_allclose(clearance(outcomes.where)[free], outcomes.least[free], rtol=0.0, atol=1e-9)
    for k in np.flatnonzero(free):
        steps = outcomes.when[k] / one.dt
        place = [np.interp(steps, np.arange(1001), x) for x in outcomes.traces[k].T]
        assert_allclose(place, outcomes.where[k], rtol=0.0, atol=1e-9)


def test_least_clearances_and_collisions_are_those_of_brute_force():
    level = Disturbances.level("severe")
    disturbances = Disturbances(level.gusts, level.navigation)
    one, clearance = plan(CRUISE, 20.0, position=(100.0, 500.0, 44.0)), hills()
    outcomes = flown(one, clearance, disturbances, count=30, traced=1)
    free = on_other_ground(one, clearance, disturbances, np.zeros(8, np.int64), count=30)
    assert 3 < outcomes.hits.sum() < 27
    for k in range(30):
        d, t = sampled(clearance, free.traces[k])
        touching = np.flatnonzero(d <= CONTACT)
        if outcomes.hits[k]:
            assert outcomes.endings[k] == TOUCHED
            assert_allclose(outcomes.collided[k] / one.dt, t[touching[0]], atol=2.0 / FINE)
            assert outcomes.when[k] == outcomes.collided[k]
            assert outcomes.least[k] <= 0.0
            assert_allclose(clearance(outcomes.where[k : k + 1]), 0.0, atol=2.0 * CONTACT)
        else:
            assert d.min() > 0.0
            assert d.min() - 0.01 <= outcomes.least[k] <= d.min() + TOLERANCE
            assert_array_equal(outcomes.traces[k], free.traces[k])


def test_a_wall_thinner_than_a_step_is_not_missed():
    """30 cm at the foot, in the middle between two steps of 40 cm."""
    heights = np.zeros((11, 401))
    heights[:, 201] = 40.0
    thin = TerrainClearance(Terrain(heights, spacing=(0.15, 10.0)), 0.0, threads=1)
    one = plan(CRUISE, 2.0, position=(0.15 * 201 - 0.2 - 40 * 0.4, 50.0, 20.0))
    assert (thin(one.positions) > 0.05).all()
    outcomes = flown(one, thin, count=1)
    assert outcomes.hits.all()
    at = 0.15 * 201 - 0.075  # the wall's western face at half its height
    expected = (at - one.positions[0, 0]) / 20.0
    assert_allclose(outcomes.collided, expected, atol=1e-3)
    assert_allclose(outcomes.where[:, 0], at, atol=0.02)


def test_a_rollout_that_begins_in_the_ground_ends_there():
    one = plan(CRUISE, 2.0, position=(100.0, 500.0, 3.0))
    outcomes = flown(one, ground(), count=3, traced=10)
    assert_array_equal(outcomes.collided, 0.0)
    assert_allclose(outcomes.least, -2.0)
    assert_array_equal(outcomes.where, np.tile(one.positions[0], (3, 1)))
    assert_array_equal(outcomes.traces, np.tile(one.positions[0], (3, 11, 1)))


def test_a_vehicle_that_has_collided_stays_where_it_was_in_the_traces():
    heights = np.zeros((101, 101))
    heights[:, 50] = 100.0
    outcomes = flown(plan(CRUISE, 25.0), ground(heights), count=1, traced=1)
    assert outcomes.endings[0] == TOUCHED
    step = int(outcomes.collided[0] / 0.02) + 1
    still = np.ptp(outcomes.traces[0, step + watch.SEGMENT :], axis=0)
    assert_array_equal(still, 0.0)
    assert outcomes.traces[0, -1, 0] < 500.0 + watch.SEGMENT * 0.4


def test_leaving_the_map_is_a_collision_of_its_own_kind():
    one = plan(CRUISE, 10.0, position=(900.0, 500.0, 60.0))
    outcomes = flown(one, ground(), count=2)
    assert_array_equal(outcomes.endings, LEFT_MAP)
    assert outcomes.left.all()
    assert outcomes.hits.all()
    assert_allclose(outcomes.collided, (1000.0 - 900.0) / 20.0, atol=1e-3)
    assert_array_equal(outcomes.least, -np.inf)


def test_a_vehicle_out_of_control_is_a_collision_of_its_own_kind():
    one = plan(HOVER, 60.0, position=(500.0, 500.0, 3000.0))
    blown = steady(2000.0, drag=(5.0, 5.0, 5.0))
    outcomes = flown(one, lambda q: q[:, 2], blown, count=6, traced=10)
    assert outcomes.lost.any()
    for k in np.flatnonzero(outcomes.lost):
        assert outcomes.endings[k] == LOST_CONTROL
        assert 0.0 < outcomes.collided[k] < 60.0
        assert outcomes.least[k] == -np.inf
        away = outcomes.where[k] - one.positions[0]
        assert 1000.0 <= np.linalg.norm(away) < 1100.0
        assert_array_equal(outcomes.traces[k, -1], outcomes.where[k])


def test_ground_that_is_hit_on_the_way_out_of_control_counts_first():
    one = plan(HOVER, 60.0, position=(500.0, 500.0, 60.0))
    outcomes = flown(one, ground(), steady(2000.0, drag=(5.0, 5.0, 5.0)), count=6)
    assert not outcomes.lost.any()
    assert set(outcomes.endings) <= {COMPLETED, TOUCHED, LEFT_MAP}
    assert (outcomes.endings != COMPLETED).any()


def test_a_constant_error_of_the_map_is_ground_that_is_lifted():
    """A wave of wave number 0 against a clearance over the lifted heights, hits included."""
    error = TerrainError(12.0, correlation_length=math.inf)
    level = Disturbances.level("moderate")
    disturbances = Disturbances(level.gusts, level.navigation, error)
    one, map_ = plan(CRUISE, 10.0, position=(100.0, 500.0, 48.0)), hills()
    draws = Draws.make(12, 0, disturbances)
    outcomes = flown(one, map_, disturbances, count=12)
    assert 0 < outcomes.hits.sum() < 12
    for k in range(12):
        lift = error.errors(draws.amplitudes[k], np.array([[500.0, 500.0]]))[0]
        lifted = TerrainClearance(Terrain(map_.terrain.heights + lift, spacing=(10.0, 10.0)), 5.0)
        rest = Disturbances(level.gusts, level.navigation)
        again = on_other_ground(one, map_, rest, lifted.handle, count=12)
        assert_allclose(outcomes.collided[k], again.collided[k], atol=1e-6)
        assert_allclose(outcomes.least[k], again.least[k], atol=1e-6)
        assert_allclose(outcomes.where[k], again.where[k], atol=1e-6)


def test_a_smooth_error_changes_the_clearance_within_its_slope():
    """Over flat ground d is (z - e) / sqrt(1 + slope^2) at least, and z - e at most."""
    error = TerrainError(8.0, 150.0)
    disturbances = Disturbances(terrain=error)
    one = plan(CRUISE, 30.0, position=(150.0, 500.0, 45.0))
    draws = Draws.make(10, 0, disturbances)
    outcomes = flown(one, ground(radius=0.0), disturbances, count=10)
    bounds = error.slope_bound(draws.amplitudes)
    axis = 5.0 * np.arange(201)
    posts = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    differ = 0.0
    for k in range(10):
        heights = error.errors(draws.amplitudes[k], posts).reshape(201, 201)
        true = TerrainClearance(Terrain(heights, spacing=(5.0, 5.0)), 0.0, threads=1)
        d, _ = sampled(true, one.positions)
        gap = one.positions[:, 2] - error.errors(draws.amplitudes[k], one.positions[:, :2])
        assert_allclose(outcomes.least[k], gap.min(), atol=TOLERANCE)
        assert outcomes.least[k] / math.sqrt(1.0 + bounds[k] ** 2) <= d.min() + TOLERANCE
        assert d.min() <= outcomes.least[k] + 0.1  # posts 5 m apart
        differ = max(differ, outcomes.least[k] - d.min())
    assert np.ptp(outcomes.least) > 3.0
    assert differ < 1.0


@numba.njit
def searched(handle, radius, places, air, record):
    """Walk along places and check as a rollout does."""
    work = watch.opened_watch(handle)
    going = watch.begin_watch(work, air, 0, places[0], 1.0, record)
    i = 0
    while going and i < len(places) - 1:
        i += 1
        going = watch.watched(work, air, 0, places[i], i == len(places) - 1, record)
    return going


@pytest.mark.parametrize("seed", range(6))
def test_any_way_over_any_ground_is_searched_to_the_tolerance(seed):
    """Rough ground and wild ways of long and short steps, with an error of the map."""
    rng = np.random.default_rng(seed)
    rough = TerrainClearance(Terrain(rng.uniform(0.0, 30.0, (51, 51)), spacing=(20.0, 20.0)), 1.0)
    disturbances = Disturbances(terrain=TerrainError(3.0, 200.0))
    draws = Draws.make(1, seed, disturbances)
    one = plan(HOVER, 0.1)
    outcomes = Outcomes.room(1)
    air = air_for(one, rough, disturbances, draws)
    steps = rng.normal(size=(700, 3)) * rng.choice([0.01, 0.3, 3.0], (700, 1)) * [1.0, 1.0, 0.3]
    places = np.array([500.0, 500.0, 60.0 + 3.0 * seed]) + np.cumsum(steps, axis=0)
    free = searched(rough.handle, 1.0, places, air, outcomes.record)

    def true(points):
        errors = disturbances.terrain.errors(draws.amplitudes[0], points[:, :2])
        return rough(points - errors[:, None] * [0.0, 0.0, 1.0])

    d, t = sampled(true, places)
    if free:
        assert d.min() - 0.05 <= outcomes.least[0] <= d.min() + TOLERANCE
    else:
        assert_allclose(outcomes.collided[0], t[np.argmax(d <= CONTACT)], atol=1.0 / FINE)
