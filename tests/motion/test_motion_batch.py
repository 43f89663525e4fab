"""Batches of motions: each row as the single model answers it, compiled and generic alike."""

import math

import numpy as np
import pytest
import trimesh
from batch_answers import D0, SPEED, every_answer, risk_of
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import MeshClearance, TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import (
    SampledBatch,
    SampledMotion,
    TerrainBatch,
    TerrainMotion,
    motion_batch,
)
from ompl_risk.motion.lines import BLOCK
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain

NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]
KINDS = [(TerrainBatch, TerrainMotion), (SampledBatch, SampledMotion)]
BATCHES = [TerrainBatch, SampledBatch]

norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
kinds = pytest.mark.parametrize(("batch", "model"), KINDS, ids=["terrain", "sampled"])
batches = pytest.mark.parametrize("kind", BATCHES, ids=["terrain", "sampled"])


@pytest.fixture(scope="module")
def clearance():
    y, x = np.mgrid[0:40, 0:40] / 40
    heights = 20 * np.sin(7 * x) * np.cos(9 * y) + 8 * np.sin(23 * x + 17 * y)
    return TerrainClearance(Terrain(heights, spacing=(10.0, 10.0)), radius=2.0)


def motions(clearance, n, seed=0, low=3.0, high=60.0):
    rng = np.random.default_rng(seed)
    xmin, xmax, ymin, ymax = clearance.terrain.extent
    xy = rng.uniform((xmin, ymin), (xmax, ymax), (2, n, 2))
    z = clearance.terrain.height(xy[..., 0], xy[..., 1]) + rng.uniform(low, high, (2, n))
    return np.concatenate([xy, z[..., None]], axis=-1)


@norms
@kinds
def test_a_row_is_answered_as_by_the_single_model(batch, model, norm, clearance):
    risk = risk_of(norm)
    a, b = motions(clearance, 40)
    found, single = every_answer(batch(clearance, risk), a, b), model(clearance, risk)
    for k in range(len(a)):
        single.a[:], single.b[:] = a[k], b[k]
        assert found["clearances"][k] == pytest.approx(single.clearance(), rel=1e-12)
        assert found["are_free"][k] == single.is_motion_free()
        assert found["costs"][k] == pytest.approx(single.cost(), rel=1e-9)
        assert found["heuristics"][k] == pytest.approx(single.heuristic(), rel=1e-9)
        assert found["durations"][k] == pytest.approx(np.linalg.norm(b[k] - a[k]) / SPEED)
    assert 0.1 < np.isfinite(found["costs"]).mean() < 0.9


@norms
def test_compiled_and_generic_agree(norm, clearance):
    risk = risk_of(norm, duration_weight=0.0)
    a, b = motions(clearance, 300, seed=1)
    compiled = every_answer(TerrainBatch(clearance, risk), a, b)
    generic = every_answer(SampledBatch(clearance, risk), a, b)
    assert np.array_equal(compiled["are_free"], generic["are_free"])
    assert np.array_equal(np.isinf(compiled["costs"]), np.isinf(generic["costs"]))
    flown = np.isfinite(generic["costs"])
    tau, p = risk.time_scale, risk.exponent
    grazing = tau**2 * SPEED / D0**3 if tau else D0 ** (1 - p) / SPEED
    expected, found = compiled["costs"][flown], generic["costs"][flown]
    assert (np.abs(found - expected) <= 1e-2 * (2 * expected + grazing)).all()
    assert np.allclose(compiled["durations"], generic["durations"], rtol=1e-14)
    assert np.allclose(compiled["clearances"], generic["clearances"], rtol=1e-12)


@norms
@batches
def test_heuristics_stay_below_the_costs_of_straight_and_of_bent_ways(kind, norm, clearance):
    weight = 1e-6 if norm.exponent < 9 else None
    risk = risk_of(norm, duration_weight=weight, tolerance=1e-3)
    batch = kind(clearance, risk)
    (a, b), (c, _) = motions(clearance, 300, 2, 3, 40), motions(clearance, 300, 3, 20, 90)
    lower = batch.heuristics(a, b, batch.clearances(a), batch.clearances(b))
    straight, legs = batch.costs(a, b), (batch.costs(a, c), batch.costs(c, b))
    bent = np.maximum(*legs) if math.isinf(norm.exponent) else legs[0] + legs[1]
    assert (lower <= straight * 1.001).all()
    assert (lower <= bent * 1.001).all()
    assert np.isfinite(straight).sum() > 20
    assert np.isfinite(bent).sum() > 20
    assert (lower > risk.weight * batch.durations(a, b) * 1.01).mean() > 0.5


@pytest.mark.parametrize(("p", "share"), [(1.0, 0.8), (2.0, 0.7), (4.0, 0.5)])
@batches
def test_the_bound_is_near_the_cost_of_leaving_flat_ground_the_shortest_way(kind, p, share):
    """Climbing straight up nothing is quicker to gain clearance: the bound could be the cost."""
    flat = TerrainClearance(Terrain(np.zeros((9, 9)), spacing=(50.0, 50.0)))
    batch = kind(flat, risk_of(Lp(p), duration_weight=0.0, tolerance=1e-4))
    a, b = np.array([[100.0, 100.0, 8.0]]), np.array([[100.0, 100.0, 24.0]])
    lower, cost = batch.heuristics(a, b, a[:, 2], b[:, 2])[0], batch.costs(a, b)[0]
    assert share * cost < lower <= cost * (1 + 1e-4)


@given(
    d_a=st.floats(0.01, 60.0), d_b=st.floats(0.01, 60.0), length=st.floats(0.0, 100.0),
    p=st.sampled_from([1.0, 2.0, 3.5]),
)  # fmt: skip
@settings(max_examples=100, deadline=None)
def test_the_bound_is_below_the_integral_under_the_greatest_possible_clearance(d_a, d_b, length, p):
    batch = SampledBatch(lambda x: x[:, 2], risk_of(Lp(p), duration_weight=0.0))
    a, b = np.zeros((1, 3)), np.array([[length, 0.0, 0.0]])
    lower = batch.heuristics(a, b, np.array([d_a]), np.array([d_b]))[0]
    # Exact from above: f is convex in d, so the trapezoidal rule does not fall below its integral.
    s = np.linspace(0.0, length, 20_001)
    f = InverseDistance(D0)(np.minimum(d_a + s, d_b + length - s)) ** p
    assert 0.0 <= lower <= 1.001 * np.trapezoid(f, s) / SPEED + 1e-9


@batches
def test_no_rows_one_row_and_any_layout(kind, clearance):
    batch = kind(clearance, risk_of())
    none = np.empty((0, 3))
    for name, answer in every_answer(batch, none, none).items():
        assert answer.shape == (0,), name
    assert batch.samples(none, none) == []
    ends = motions(clearance, 64, seed=4)
    ends.setflags(write=False)
    plain = every_answer(batch, *ends)
    fortran = [np.asfortranarray(x) for x in ends]
    strided = [np.repeat(x, 2, axis=0)[::2] for x in ends]
    inner = [np.hstack([x, x])[:, 3:] for x in ends]
    for other in (fortran, strided, inner):
        for name, answer in every_answer(batch, *other).items():
            assert np.allclose(answer, plain[name], rtol=1e-12), name
    for name, answer in every_answer(batch, ends[0][7:8], ends[1][7:8]).items():
        assert answer == pytest.approx(plain[name][7:8], rel=1e-9), name
    from_one = every_answer(batch, np.broadcast_to(ends[0][0], (64, 3)), ends[1])
    assert from_one["costs"][0] == pytest.approx(plain["costs"][0], rel=1e-9)


@batches
def test_straight_motions_can_be_flown_backwards_and_pass_their_ends_only(kind, clearance):
    batch = kind(clearance, risk_of(tolerance=1e-3))
    a, b = motions(clearance, 100, seed=5)
    assert batch.symmetric
    assert np.array_equal(batch.are_free(a, b), batch.are_free(b, a))
    there, back = batch.costs(a, b), batch.costs(b, a)
    assert np.allclose(there, back, rtol=1e-2, atol=1e-2 * SPEED / D0**3)
    samples = batch.samples(a, b)
    assert len(samples) == 100
    assert np.array_equal(samples[3], [a[3], b[3]])


class Counted:
    """Height above z = 0, keeping count of how it is asked."""

    def __init__(self):
        self.sizes = []

    def __call__(self, points):
        self.sizes.append(len(points))
        return points[:, 2].copy()


def test_a_clearance_is_asked_seldom_and_for_many_at_a_time():
    rng = np.random.default_rng(0)
    a, b = rng.uniform(3.0, 100.0, (2, 20_000, 3))
    for question in ("costs", "are_free", "clearances"):
        counted = Counted()
        batch = SampledBatch(counted, risk_of())
        getattr(batch, question)(*([a, b] if question != "clearances" else [a]))
        assert max(counted.sizes) <= BLOCK
        assert len(counted.sizes) < 200
        assert np.mean(counted.sizes) > 1000


def test_millions_of_pieces_are_halved_in_blocks():
    """1 km at 5 mm above the ground takes 10^5 samples at least."""
    counted = Counted()
    batch = SampledBatch(counted, risk_of(Lp(1), duration_weight=0.0))
    a = np.tile([0.0, 0.0, 0.005], (3, 1))
    b = a + np.array([[1000.0, 0.0, 0.0], [1000.0, 0.0, -0.0045], [1000.0, 0.0, 100.0]])
    assert batch.are_free(a, b).tolist() == [True, False, True]
    assert max(counted.sizes) <= BLOCK
    assert sum(counted.sizes) > 100_000
    f = 1 / 0.005 - 1 / D0
    level, diving, climbing = batch.costs(a, b)
    assert level == pytest.approx(f * 1000.0 / SPEED, rel=1e-9)
    assert diving == math.inf
    assert 0.0 < climbing < 0.1 * level


def test_infinite_distances_and_one_collision_leave_the_other_rows_alone():
    def d(points):
        x, y = points[:, 0], points[:, 1]
        return np.where(y > 0, np.inf, np.where(x > 90, -np.inf, 95.0 - x))

    a, b = np.zeros((4, 3)), np.zeros((4, 3))
    a[0, 1] = b[0, 1] = 1.0
    b[:, 0] = [40.0, 80.0, 200.0, 0.0]
    with np.errstate(all="raise"):
        for norm in NORMS:
            batch = SampledBatch(d, risk_of(norm, duration_weight=0.0))
            assert batch.are_free(a, b).tolist() == [True, True, False, True]
            costs = batch.costs(a, b)
            assert costs[[0, 3]].tolist() == [0.0, 0.0]
            assert 0.0 < costs[1] < costs[2] == math.inf
            lower = batch.heuristics(a, b, d(a), d(b))
            assert (lower[np.isfinite(costs)] <= costs[np.isfinite(costs)] * 1.01).all()


def test_bad_rows_and_answers_are_named(clearance):
    batch, a = SampledBatch(clearance, risk_of()), motions(clearance, 5)[0]
    for question in (batch.are_free, batch.costs, batch.durations):
        with pytest.raises(ArgumentError, match=r"a.shape = \(5, 2\)"):
            question(a[:, :2], a[:, :2])
        with pytest.raises(ArgumentError, match=r"rows of the arguments = \[5, 4\]"):
            question(a, a[:4])
        bad = a.copy()
        bad[3, 1] = math.nan
        with pytest.raises(ArgumentError, match=r"b\[3\]"):
            question(a, bad)
    with pytest.raises(ArgumentError, match=r"rows of the arguments = \[5, 5, 5, 4\]"):
        batch.heuristics(a, a, np.ones(5), np.ones(4))
    with pytest.raises(ArgumentError, match="shape"):
        SampledBatch(lambda p: np.zeros((len(p), 1)), risk_of()).costs(a, a)
    late = SampledBatch(lambda p: np.where(p[:, 0] == a[2, 0], math.nan, 5.0), risk_of())
    for question in (late.are_free, late.costs):
        with pytest.raises(ArgumentError, match="nan"):
            question(a, a + 1.0)
    with pytest.raises(ArgumentError, match="width = 2"):
        SampledBatch(clearance, risk_of(), 2)
    posed = MeshClearance(trimesh.creation.box(), body=trimesh.creation.box())
    with pytest.raises(ArgumentError, match="orientation"):
        SampledBatch(posed, risk_of(), 3)
    nowhere = np.zeros((2, 7))
    with pytest.raises(ArgumentError, match=r"a\[0\]\[3:7\]"):
        SampledBatch(posed, risk_of(), 7).costs(nowhere, nowhere)


def test_a_fault_of_the_clearance_comes_through():
    def broken(points):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        SampledBatch(broken, risk_of()).costs(np.zeros((2, 3)), np.ones((2, 3)))


def test_the_quickest_batch_is_chosen(clearance):
    class Lifted(TerrainClearance):
        def __call__(self, points, **options):
            return super().__call__(points, **options) - 1.0

    assert isinstance(motion_batch(clearance, risk_of()), TerrainBatch)
    assert isinstance(motion_batch(clearance, risk_of(), 7), SampledBatch)
    assert isinstance(motion_batch(Lifted(clearance.terrain), risk_of()), SampledBatch)
    assert motion_batch(clearance, risk_of()).compiled
    assert not motion_batch(lambda p: p[:, 2], risk_of()).compiled
    with pytest.raises(ArgumentError, match="clearance"):
        motion_batch(3.0, risk_of())


def test_states_may_be_wider_than_what_the_clearance_uses(clearance):
    a, b = motions(clearance, 30, seed=6)
    narrow = SampledBatch(clearance, risk_of()).costs(a, b)
    wide = [np.hstack([x, np.full((30, 6), 9.0)]) for x in (a, b)]
    assert np.array_equal(SampledBatch(clearance, risk_of(), 9).costs(*wide), narrow)
