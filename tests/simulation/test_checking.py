"""Rollouts over any clearance: as the compiled checks, and as brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from level_plan import LevelPlan, flat

from ompl_risk import MeshClearance, TerrainClearance, Trajectory, UnionClearance
from ompl_risk._kernels.air import LEFT_MAP, LOST_CONTROL, TOUCHED
from ompl_risk._kernels.watch import CONTACT, TOLERANCE
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingSphere
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.closed_loop import closed_loop_probability
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.gusts import DrydenGusts
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop import checking
from ompl_risk.simulation.loop.checking import fly_checked
from ompl_risk.simulation.loop.plans import Plan
from ompl_risk.simulation.loop.point_plan import PointPlan
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.simulation.loop.true_clearance import TrueClearance
from ompl_risk.terrains import Terrain

CALM = Disturbances()
FIELDS = ("least", "when", "where", "collided", "endings")


class Wandering(Plan):
    """Rollouts that wander about a line, each its own way; some lose control at a given time."""

    def __init__(self, *, lost: float = math.inf, steps: int = 300, height: float = 30.0) -> None:
        self.name, self.dt, self.lost = "wandering", 0.1, lost
        self.times = np.arange(steps + 1) * self.dt
        self.positions = np.column_stack([5.0 * self.times, 0.0 * self.times, 0.0 * self.times])
        self.positions += [500.0, 500.0, height]
        self.velocities = np.gradient(self.positions, self.dt, axis=0)
        self.drag = np.zeros(3)

    def trace(self, seed: int) -> np.ndarray:
        rng = np.random.default_rng(int(seed))
        phases = rng.uniform(0.0, 2.0 * math.pi, (3, 4)), rng.normal(0.0, 4.0, (3, 4))
        waves = np.arange(1, 5)[:, None] * self.times / 5.0
        swing = [size @ np.sin(waves + phase[:, None]) for phase, size in zip(*phases, strict=True)]
        return self.positions + np.array(swing).T

    def run(self, air, first, last, outcomes):
        for k in range(first, last):
            outcomes.traces[k] = self.trace(air.seeds[k])[:: air.trace_every]
            outcomes.collided[k] = self.lost
            if self.lost < math.inf:
                step = round(self.lost / self.dt)
                outcomes.traces[k, step:] = outcomes.traces[k, step]
                outcomes.endings[k] = LOST_CONTROL


def draws(count: int, disturbances: Disturbances = CALM, seed: int = 0) -> Draws:
    return Draws.make(count, seed, disturbances)


def dense(plan: Wandering, seed: int, clearance, parts: int = 200) -> tuple:
    """Times and clearances at very many moments of a rollout."""
    fine = np.linspace(0.0, plan.times[-1], parts * (len(plan.times) - 1) + 1)
    trace = plan.trace(seed)
    points = np.column_stack([np.interp(fine, plan.times, column) for column in trace.T])
    moves = getattr(clearance, "moves", False)
    return fine, clearance(points, fine) if moves else clearance(points), points


POLES = np.array([[540.0, 503.0, 30.0], [600.0, 495.0, 30.0], [625.0, 508.0, 30.0]])
HALF = np.array([1.0, 1.0, 40.0])


def poles() -> MeshClearance:
    boxes = [trimesh.creation.box(2.0 * HALF) for _ in POLES]
    for box, place in zip(boxes, POLES, strict=True):
        box.apply_translation(place)
    return MeshClearance(boxes, radius=2.0)


def to_poles(points: np.ndarray) -> np.ndarray:
    """The same in closed form."""
    q = np.abs(points[:, None] - POLES) - HALF
    outside = np.linalg.norm(np.maximum(q, 0.0), axis=2)
    return (outside + np.minimum(q.max(axis=2), 0.0)).min(axis=1) - 2.0


def traffic() -> MovingClearance:
    """One across the way, and one so fast that it passes between two steps."""
    slow = MovingSphere(8.0, [0.0, 30.0], [[560.0, 350.0, 30.0], [560.0, 650.0, 34.0]])
    fast = MovingSphere(1.0, [20.0, 21.0], [[610.0, 0.0, 30.0], [610.0, 1000.0, 30.0]])
    return MovingClearance([slow, fast], radius=2.0)


@pytest.mark.parametrize(("clearance", "oracle"), [(poles(), to_poles), (traffic(), traffic())])
def test_least_clearance_and_first_contact_are_those_of_brute_force(clearance, oracle):
    plan, sample = Wandering(), draws(25)
    found = fly_checked(plan, clearance, CALM, sample)
    assert 3 <= found.hits.sum() <= 22
    for k, seed in enumerate(sample.seeds):
        t, d, points = dense(plan, seed, oracle)
        slack = (2.0 + 1000.0) * (t[1] - t[0])  # what d can do between two of the moments
        if not found.hits[k]:
            assert d.min() - slack <= found.least[k] <= d.min() + TOLERANCE
            assert found.collided[k] == math.inf
            at = round(found.when[k] / (t[1] - t[0]))
            assert found.where[k] == pytest.approx(points[at], abs=0.05)
            continue
        assert found.endings[k] == TOUCHED
        assert -0.1 <= found.least[k] <= 0.0
        before = t < found.collided[k] - 1e-3
        assert d[before].min(initial=np.inf) > CONTACT - 0.02
        soon = (t >= found.collided[k] - 1e-3) & (t < found.collided[k] + 0.02)
        assert d[soon].min() < CONTACT + 0.02


def test_a_moving_ball_that_passes_between_two_steps_is_met():
    """A plan that stands still, and a ball of 1 m at 1,000 m/s: 100 m in a step of 0.1 s."""
    plan = Wandering()
    plan.trace = lambda _seed: np.tile([610.0, 500.0, 30.0], (301, 1))
    found = fly_checked(plan, traffic(), CALM, draws(1))
    assert found.collided == pytest.approx([20.0 + 0.497], abs=1e-4)  # 3 m before it is there
    clock = Trajectory(20.0 + plan.times, plan.trace(0), name="later")
    assert fly_checked(PointPlan(clock), traffic(), CALM, draws(1)).collided == pytest.approx(
        [0.497], abs=1e-4
    )


def hills(radius: float = 2.0) -> TerrainClearance:
    x = np.linspace(0.0, 1000.0, 101)
    heights = 25.0 * np.sin(x / 60.0)[:, None] * np.cos(x / 45.0)
    return TerrainClearance(Terrain(heights, spacing=(10.0, 10.0)), radius=radius, threads=1)


@pytest.fixture(scope="module")
def low_flight() -> PointPlan:
    ground, x = hills(), np.linspace(150.0, 850.0, 60)
    line = np.column_stack([x, np.full(60, 480.0), np.zeros(60)])
    line[:, 2] = ground.terrain.height(x, line[:, 1]) + 5.2
    return PointPlan(Trajectory.at_constant_speed(line, 15.0, "low"))


@pytest.mark.parametrize(
    "disturbances",
    [
        Disturbances(gusts=DrydenGusts(25.0)),
        Disturbances(terrain=TerrainError(2.0, 100.0, waves=16)),
        Disturbances(gusts=DrydenGusts(10.0), terrain=TerrainError(1.0, 200.0, waves=16)),
    ],
)
def test_over_terrain_as_the_compiled_checks(low_flight, disturbances):
    sample = draws(120, disturbances)
    compiled = fly(low_flight, hills(), disturbances, sample, threads=1)
    far = MeshClearance([trimesh.creation.box((1.0, 1.0, 1.0))], radius=2.0)
    checked = fly_checked(low_flight, UnionClearance([hills(), far]), disturbances, sample)
    assert 5 <= compiled.hits.sum() <= 115
    assert np.array_equal(checked.endings, compiled.endings)
    free = ~compiled.hits
    assert np.abs(checked.least - compiled.least)[free].max() <= TOLERANCE
    assert checked.collided[~free] == pytest.approx(compiled.collided[~free], abs=1e-3)
    assert checked.where[~free] == pytest.approx(compiled.where[~free], abs=0.05)
    assert checked.least[~free] == pytest.approx(compiled.least[~free], abs=0.02)


def test_the_ground_under_moving_obstacles_is_raised_too(low_flight):
    disturbances = Disturbances(terrain=TerrainError(2.0, 100.0, waves=16))
    sample = draws(60, disturbances)
    away = MovingSphere(1.0, [0.0, 1.0], [[0.0, 0.0, 900.0], [1.0, 0.0, 900.0]])
    clearance = MovingClearance(away, static=hills(), radius=2.0)
    found = fly_checked(low_flight, clearance, disturbances, sample)
    compiled = fly(low_flight, hills(), disturbances, sample, threads=1)
    assert np.array_equal(found.endings, compiled.endings)
    assert compiled.hits.any()


def test_an_error_of_the_map_moves_no_other_obstacle():
    disturbances = Disturbances(terrain=TerrainError(2.0, 100.0, waves=16))
    sample, calm = draws(10, disturbances), draws(10)
    raised = fly_checked(Wandering(), poles(), disturbances, sample)
    still = fly_checked(Wandering(), poles(), CALM, Draws(sample.seeds, *rest(calm)))
    for field in FIELDS:
        assert np.array_equal(getattr(raised, field), getattr(still, field))


def test_ways_are_stretched_by_the_greatest_singular_value_of_the_shear():
    disturbances = Disturbances(terrain=TerrainError(9.0, 50.0, waves=16))
    amplitudes = draws(5, disturbances).amplitudes
    slopes = disturbances.terrain.slope_bound(amplitudes)
    shears = [np.array([[1, 0, 0], [0, 1, 0], [-slope, 0, 1]]) for slope in slopes]
    expected = [np.linalg.norm(shear, 2) for shear in shears]
    found = TrueClearance(UnionClearance([hills()]), disturbances, amplitudes).stretches()
    assert found == pytest.approx(expected, rel=1e-12)
    assert found.min() > 1.1
    assert (TrueClearance(poles(), disturbances, amplitudes).stretches() == 1.0).all()
    assert (TrueClearance(hills(), CALM, amplitudes).stretches() == 1.0).all()


def rest(sample: Draws) -> tuple:
    return sample.amplitudes, sample.log_weights


def test_batches_make_no_difference(monkeypatch):
    whole = fly_checked(Wandering(), poles(), CALM, draws(11))
    monkeypatch.setattr(checking, "MEMORY", 3 * 24 * 301)
    parts = fly_checked(Wandering(), poles(), CALM, draws(11))
    for field in FIELDS:
        assert np.array_equal(getattr(parts, field), getattr(whole, field))


def test_control_is_lost_unless_something_is_touched_before():
    plan, sample = Wandering(lost=15.0), draws(25)
    free = fly_checked(Wandering(), poles(), CALM, sample)
    found = fly_checked(plan, poles(), CALM, sample)
    before = free.collided < 15.0
    assert 0 < before.sum() < 25
    assert (found.endings[before] == TOUCHED).all()
    assert found.collided[before] == pytest.approx(free.collided[before], abs=2e-3)
    assert (found.endings[~before] == LOST_CONTROL).all()
    assert (found.least[~before] == -np.inf).all()
    assert (found.collided[~before] == 15.0).all()


def test_leaving_the_map_is_told_apart():
    plan = LevelPlan(50.0, "out", end=4200.0)
    found = fly_checked(plan, UnionClearance([flat()]), CALM, draws(2))
    assert found.endings.tolist() == [LEFT_MAP, LEFT_MAP]
    assert found.collided == pytest.approx(30.0 * (4000.0 - 500.0) / (4200.0 - 500.0) * np.ones(2))
    assert (found.least == -np.inf).all()


def test_a_clear_sky_is_free():
    found = fly_checked(Wandering(), lambda points: np.full(len(points), np.inf), CALM, draws(2))
    assert (found.least == np.inf).all()
    assert not found.hits.any()


def test_probability_over_any_clearance():
    (found,) = closed_loop_probability(Wandering(), poles(), CALM, rollouts=40)
    direct = fly_checked(Wandering(), poles(), CALM, draws(40))
    assert found.hits == direct.hits.sum() > 0
    assert np.array_equal(found.least, direct.least)


class Unbounded:
    moves = True

    def __call__(self, points, times):
        return np.full(len(points), 5.0)


class Jumping(Unbounded):
    def speed_bound(self, t0, t1):
        return np.full(len(t0), np.inf)


def test_clearances_that_cannot_be_checked_are_refused():
    body = MeshClearance(
        [trimesh.creation.box((1.0, 1.0, 1.0))], body=trimesh.creation.box((2.0, 1.0, 1.0))
    )
    for clearance, message in (
        (body, "orientation"),
        (Unbounded(), "speed_bound"),
        (Jumping(), "finite"),
        (lambda points: np.full(len(points), np.nan), "without NaN"),
        (lambda points: np.zeros(3), "of shape"),
    ):
        with pytest.raises(ArgumentError, match=message) as caught:
            fly_checked(Wandering(), clearance, CALM, draws(2))
        assert caught.value.argument.startswith("clearance")
