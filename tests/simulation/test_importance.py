"""Rare collisions by errors of height: unbiased, and orders of magnitude fewer rollouts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from level_plan import RADIUS, LevelPlan, flat
from scipy import stats

from ompl_risk import MeshClearance, TerrainClearance, Trajectory, UnionClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.closed_loop import closed_loop_probability
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.navigation import Drift, NavigationError
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.estimates.paired import compare
from ompl_risk.simulation.loop.point_plan import PointPlan
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.simulation.rare.importance import Design, RaisedGround, wave_vectors
from ompl_risk.simulation.rare.raised_ground import PRECISION, lifts
from ompl_risk.simulation.rare.steered_seeds import upward_biases, with_upward_biases
from ompl_risk.terrains import Terrain

SIGMA = 10.0
CONSTANT = Disturbances(terrain=TerrainError(SIGMA, math.inf, waves=8))
NONE = Drift((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
TAU = 7.0
MISLED = Disturbances(
    terrain=CONSTANT.terrain,
    navigation=NavigationError(Drift((3.0, 3.0, TAU), (0.0, 0.0, 0.0), 1e12), NONE, NONE),
)
WAVY = Disturbances(terrain=TerrainError(SIGMA, 300.0, waves=32))


def probability(plans, disturbances, **rest):
    return closed_loop_probability(plans, flat(), disturbances, threads=1, **rest)


@pytest.mark.parametrize("p", [0.3, 0.05, 1e-3, 1e-6, 1e-9])
def test_constant_error_has_the_normal_tail(p):
    """Collision if and only if e > clearance: P = 1 - Phi(clearance / sigma)."""
    plan = LevelPlan(float(SIGMA * stats.norm.isf(p)), "A")
    (found,) = probability(plan, CONSTANT, rollouts=4000, importance=RaisedGround())
    error = math.sqrt(p * (1.0 - p) / found.equivalent_rollouts)
    assert abs(found.probability - p) < 4.0 * error
    assert found.low < p < found.high


def test_a_rare_collision_takes_orders_of_magnitude_fewer_rollouts():
    plan = LevelPlan(float(SIGMA * stats.norm.isf(1e-6)), "A")
    (found,) = probability(plan, CONSTANT, rollouts=1000, importance=RaisedGround())
    assert found.equivalent_rollouts > 1e7
    assert found.high < 2e-6
    assert found.upper_bound() > 1e-3  # that nothing else was missed, 1,000 rollouts cannot say


@pytest.mark.parametrize("p", [0.05, 1e-6, 1e-9])
def test_both_errors_of_height_together_have_the_normal_tail(p):
    """Collision if and only if e + tau b > clearance."""
    plan = LevelPlan(math.hypot(SIGMA, TAU) * float(stats.norm.isf(p)), "A", misled=TAU)
    (found,) = probability(plan, MISLED, rollouts=4000, importance=RaisedGround())
    error = math.sqrt(p * (1.0 - p) / found.equivalent_rollouts)
    assert abs(found.probability - p) < 4.0 * error
    assert found.low < p < found.high
    assert found.equivalent_rollouts > 100 * 4000 or p > 1e-3


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Of 250 estimates, with 2 m that no design knows of beside the two errors."""
    p, wrong = 1e-4, 0
    height = math.sqrt(SIGMA**2 + TAU**2 + 4.0) * float(stats.norm.isf(p))
    plan = LevelPlan(height, "A", misled=TAU, shake=2.0)
    for seed in range(250):
        rest = {"rollouts": 200, "seed": seed, "importance": RaisedGround(points=4)}
        (found,) = probability(plan, MISLED, **rest)
        wrong += not found.low <= p <= found.high
    assert wrong <= stats.binom.ppf(0.9999, 250, 0.05)


@pytest.mark.parametrize("shake", [0.0, 5.0])
def test_as_likely_as_by_plain_rollouts(shake):
    """A case of probability of about 0.05; other seeds, so that both are independent."""
    plan = LevelPlan(25.0, "A", shake=shake)
    (plain,) = probability(plan, WAVY, rollouts=20_000, seed=1)
    (shifted,) = probability(plan, WAVY, rollouts=5_000, seed=2, importance=RaisedGround())
    assert 0.03 < plain.probability < 0.12
    variances = [
        each.probability * (1.0 - each.probability) / each.equivalent_rollouts
        for each in (plain, shifted)
    ]
    assert abs(plain.probability - shifted.probability) < 4.0 * math.sqrt(sum(variances))
    assert shifted.equivalent_rollouts > 1.25 * 5_000


@settings(max_examples=20, deadline=None)
@given(st.floats(0.05, 0.95), st.integers(0, 2**32 - 1))
def test_any_design_is_unbiased(nominal, seed):
    """E_q[w h] = P(h), and E_q[w] = 1, with shifts that have nothing to do with the event."""
    rng = np.random.default_rng(seed)
    shares = np.concatenate([[nominal], (1.0 - nominal) * rng.dirichlet(np.ones(3))])
    design = Design(shares, rng.normal(scale=1.0, size=(3, 17)), CONSTANT)
    draws = design.draws(20_000, seed)
    weights = np.exp(draws.log_weights)
    event = draws.amplitudes[:, 2] + upward_biases(draws.seeds) > 1.0
    for terms, truth in ((weights, 1.0), (weights * event, stats.norm.sf(1.0 / math.sqrt(2.0)))):
        assert abs(terms.mean() - truth) < 4.5 * terms.std() / math.sqrt(len(terms))


def test_weights_are_the_ratio_of_the_densities_and_bounded():
    rng = np.random.default_rng(5)
    shares, shifts = np.array([0.2, 0.5, 0.3]), rng.normal(size=(2, 17))
    design = Design(shares, shifts, CONSTANT)
    seeds, amplitudes = words(50), 3.0 * rng.normal(size=(50, 16))
    points = np.column_stack([amplitudes, upward_biases(seeds)])
    densities = [stats.multivariate_normal(mean=v).pdf(points) for v in (np.zeros(17), *shifts)]
    expected = densities[0] / (shares @ np.array(densities))
    assert np.exp(design.log_weights(seeds, amplitudes)) == pytest.approx(expected, rel=1e-9)
    assert design.heaviest == 5.0
    far = np.exp(design.log_weights(seeds, 100.0 * amplitudes))
    assert far.max() <= 5.0 * (1.0 + 1e-12)


def words(count: int) -> np.ndarray:
    return np.random.default_rng(9).integers(0, 2**64, count, dtype=np.uint64)


def test_rollouts_are_drawn_in_their_shares_and_do_not_depend_on_how_many():
    shifts = np.zeros((2, 17))
    shifts[:, 0] = 100.0, 200.0
    design = Design(np.array([0.25, 0.15, 0.6]), shifts, CONSTANT)
    draws = design.draws(2000, 7)
    counts = np.bincount(np.round(draws.amplitudes[:, 0] / 100.0).astype(int), minlength=3)
    assert np.abs(counts - 2000 * design.shares).max() <= 4  # far more even than by chance
    few = design.draws(100, 7)
    assert np.array_equal(few.amplitudes, draws.amplitudes[:100])
    assert np.array_equal(few.log_weights, draws.log_weights[:100])
    assert not np.array_equal(design.draws(100, 8).amplitudes, few.amplitudes)


def test_wind_and_the_nominal_share_are_those_of_plain_rollouts():
    design = RaisedGround().design([LevelPlan(40.0)], flat(), WAVY)
    shifted, plain = design.draws(400, 3), Draws.make(400, 3, WAVY)
    assert np.array_equal(shifted.seeds, plain.seeds)
    same = (shifted.amplitudes == plain.amplitudes).all(axis=1)
    assert 95 <= same.sum() <= 105


def test_shifts_raise_the_ground_by_the_lift_and_no_shorter_one_does():
    design = RaisedGround(points=8).design([LevelPlan(40.0)], flat(), WAVY)
    places = LevelPlan(40.0).positions[:, :2]
    errors = SIGMA * wave_vectors(WAVY.terrain.wave_numbers, places) @ design.shifts[:, :-1].T
    assert errors.max(axis=0) == pytest.approx(np.full(8, 40.0), abs=2 * PRECISION)
    length = np.linalg.norm(design.shifts, axis=1)
    assert length == pytest.approx(np.full(8, 40.0 / SIGMA), abs=2 * PRECISION / SIGMA)


def test_ground_and_vehicle_share_the_way_as_their_variances():
    design = RaisedGround(points=1).design([LevelPlan(40.0)], flat(), MISLED)
    raised, lower = SIGMA * np.linalg.norm(design.shifts[0, :-1]), TAU * design.shifts[0, -1]
    assert raised + lower == pytest.approx(40.0, abs=2 * PRECISION)
    assert raised / lower == pytest.approx((SIGMA / TAU) ** 2, rel=1e-9)
    high = RaisedGround(points=1).design([LevelPlan(90.0)], flat(), MISLED)
    assert high.shifts[0, -1] == 4.0
    assert SIGMA * np.linalg.norm(high.shifts[0, :-1]) == pytest.approx(90.0 - 4.0 * TAU, abs=0.02)


def test_seeds_lead_to_the_wanted_bias():
    seeds = words(2000)
    numbers = upward_biases(seeds)
    assert stats.kstest(numbers, "norm").pvalue > 1e-3
    for shift in (0.0, 1.5, 4.0, -3.0):
        found, wanted = upward_biases(with_upward_biases(seeds, numbers + shift)), numbers + shift
        assert (np.abs(found - wanted) < 1e-9 + 2.0**-51 / stats.norm.pdf(wanted)).all()
    assert np.abs(upward_biases(with_upward_biases(seeds, np.full(2000, 99.0)))).max() < 8.3
    again = upward_biases(with_upward_biases(seeds, np.full(2000, 1.0)))
    assert again == pytest.approx(np.ones(2000), abs=1e-9)
    assert len(set(with_upward_biases(seeds, np.full(2000, 1.0)).tolist())) > 1000


def test_a_vehicle_with_an_upward_bias_flies_as_much_too_low():
    """What the seeds are steered by is what a rollout does: height above flat ground."""
    line = Trajectory([0.0, 40.0], [[500.0, 2000.0, 205.0], [1500.0, 2000.0, 205.0]])
    navigation = NavigationError(Drift((0.0, 0.0, TAU), (0.0, 0.0, 0.0), 1e12), NONE, NONE)
    disturbances, plan = Disturbances(navigation=navigation), PointPlan(line)
    plain = Draws.make(40, 0, disturbances)
    numbers = np.linspace(0.5, 6.0, 40)
    steered = Draws(with_upward_biases(plain.seeds, numbers), plain.amplitudes)
    found = fly(plan, flat(), disturbances, steered, threads=1, traced=len(plan.times) - 1)
    assert found.traces[:, -1, 2] == pytest.approx(205.0 - TAU * numbers, abs=0.01)


@pytest.mark.parametrize("disturbances", [WAVY, MISLED])
def test_points_near_the_ground_have_the_most_rollouts(disturbances):
    plan = LevelPlan(40.0)
    plan.positions[150:, 2] += np.linspace(0.0, 60.0, 151)
    design = RaisedGround(points=10).design([plan], flat(), disturbances)
    rise = np.linalg.norm(design.shifts, axis=1)
    shares = design.shares[1:]
    assert design.shares.sum() == pytest.approx(1.0)
    assert shares[:5] == pytest.approx(np.full(5, shares[0]), rel=0.05)
    expected = stats.norm.sf(rise) / stats.norm.sf(rise).sum() * 0.75
    assert shares == pytest.approx(expected, rel=0.01)
    assert len(shares) < 10  # 100 m above ground is 8 or 10 standard deviations: left out


def test_plans_share_one_design_so_that_they_can_be_compared():
    plans = [LevelPlan(45.0, "low"), LevelPlan(48.0, "high")]
    low, high = probability(plans, WAVY, rollouts=2000, importance=RaisedGround())
    assert np.array_equal(low.weights, high.weights)
    found = compare(low, high)
    assert found.certain
    assert found.less == 0
    assert found.difference > 0.0
    alone = probability(plans[0], WAVY, rollouts=2000, importance=RaisedGround())[0]
    assert not np.array_equal(alone.weights, low.weights)


def test_lifts_are_vertical_whatever_the_slope():
    """Over a plane of slope s a sphere touches when raised by z - r sqrt(1 + s^2)."""
    heights = np.tile(0.8 * 10.0 * np.arange(41), (41, 1))
    slope = TerrainClearance(Terrain(heights, spacing=(10.0, 10.0)), radius=2.0, threads=1)
    points = np.array([[200.0, 200.0, 160.0 + up] for up in (0.0, 10.0, 35.0, 90.0)])
    expected = np.array([0.0, 10.0, 35.0, 50.0])
    expected[1:3] -= 2.0 * math.hypot(1.0, 0.8)
    assert lifts(slope, points, 50.0) == pytest.approx(expected, abs=2 * PRECISION)
    assert lifts(slope, np.array([[-1.0, 0.0, 500.0]]), 50.0).tolist() == [0.0]


def test_terrain_in_a_union_is_raised(box):
    union = UnionClearance([box, UnionClearance([flat()])])
    points = np.array([[500.0, 500.0, RADIUS + 7.0]])
    assert lifts(union, points, 50.0) == pytest.approx([7.0], abs=2 * PRECISION)


@pytest.fixture
def box() -> MeshClearance:
    import trimesh

    return MeshClearance([trimesh.creation.box((1.0, 1.0, 1.0))])


def test_nothing_to_raise_is_refused(box):
    with pytest.raises(ArgumentError, match="without a terrain error"):
        probability(LevelPlan(9.0), Disturbances(), importance=RaisedGround())
    with pytest.raises(ArgumentError, match="clearance without a terrain"):
        RaisedGround().design([LevelPlan(9.0)], box, WAVY)


@pytest.mark.parametrize(
    "wrong", [{"nominal": 0.0}, {"nominal": 1.0}, {"nominal": math.nan}, {"points": 0}]
)
def test_wrong_designs_are_refused(wrong):
    with pytest.raises(ArgumentError) as caught:
        RaisedGround(**wrong)
    assert caught.value.argument in wrong
