"""Motion models against dense sampling and closed forms; the compiled and the generic agree."""

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import MeshClearance, TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.motion import Risk, SampledMotion, TerrainMotion, motion_model
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.terrains import Terrain

NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]
D0 = 30.0


def hills(seed=0, n=40, spacing=10.0, relief=25.0):
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[0:n, 0:n] / n
    h = sum(
        rng.normal() * np.sin(2 * math.pi * (k * x + m * y) + rng.uniform(0, 6)) / (k + m)
        for k in range(1, 5)
        for m in range(1, 5)
    )
    return Terrain(relief * h, spacing=(spacing, spacing))


def random_motion(terrain, seed, low=3.0, high=60.0):
    rng = np.random.default_rng(seed)
    xmin, xmax, ymin, ymax = terrain.extent
    ends = rng.uniform((xmin, ymin), (xmax, ymax), (2, 2))
    z = terrain.height(ends[:, 0], ends[:, 1]) + rng.uniform(low, high, 2)
    return np.column_stack([ends, z])


def dense(clearance, ends, n=20_001):
    s = np.linspace(0, 1, n)[:, None]
    return clearance(ends[0] + s * (ends[1] - ends[0]))


def model(kind, clearance, norm=None, **options):
    risk = Risk(InverseDistance(D0), norm or Sobolev(1), **{"speed": 20.0, **options})
    return kind(clearance, risk)


def ask(motion, ends, question):
    motion.a[:], motion.b[:] = ends
    return getattr(motion, question)()


@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
@pytest.mark.parametrize("kind", [TerrainMotion, SampledMotion])
def test_cost_is_the_power_of_the_norm_of_densely_sampled_f(kind, norm):
    clearance = TerrainClearance(hills(), radius=2.0)
    motion = model(kind, clearance, norm, duration_weight=0.0)
    compared = 0
    for seed in range(40):
        ends = random_motion(clearance.terrain, seed)
        d = dense(clearance, ends)
        if d.min() <= 0.5:
            continue
        t = np.linspace(0, np.linalg.norm(ends[1] - ends[0]) / 20.0, len(d))
        expected = norm.power(t, InverseDistance(D0)(d))
        if isinstance(norm, Sobolev):  # what dipping just below d0 costs: errors are as small
            grazing = norm.time_scale**2 * 20.0 / D0**3
        else:
            grazing = D0 ** (1 - norm.exponent) / 20.0
        assert ask(motion, ends, "cost") == pytest.approx(expected, rel=1e-2, abs=1e-2 * grazing)
        compared += 1
    assert compared >= 10


def test_a_smaller_tolerance_is_more_accurate():
    clearance = TerrainClearance(hills(3), radius=2.0)
    errors = {1e-1: [], 1e-2: [], 1e-4: []}
    for seed in range(60):
        ends = random_motion(clearance.terrain, seed, 20, 60)
        d = dense(clearance, ends)
        if d.min() <= 1.0 or d.min() > 20.0:
            continue
        t = np.linspace(0, np.linalg.norm(ends[1] - ends[0]) / 20.0, len(d))
        expected = Sobolev(1).power(t, InverseDistance(D0)(d))
        for tolerance, found in errors.items():
            motion = model(TerrainMotion, clearance, tolerance=tolerance, duration_weight=0.0)
            found.append(abs(ask(motion, ends, "cost") / expected - 1))
    assert len(errors[1e-2]) > 5
    assert np.max(errors[1e-2]) < 1e-2
    assert np.max(errors[1e-4]) < 2e-3
    assert np.mean(errors[1e-4]) < 0.1 * np.mean(errors[1e-1])


def test_level_flight_over_flat_ground_in_closed_form():
    clearance = TerrainClearance(Terrain(np.zeros((9, 9)), spacing=(50.0, 50.0)), radius=2.0)
    ends = np.array([[10.0, 10.0, 12.0], [310.0, 210.0, 12.0]])
    f, duration = 1 / 10 - 1 / D0, math.hypot(300, 200) / 20.0
    for p in (1.0, 2.0, 3.5):
        motion = model(TerrainMotion, clearance, Lp(p), duration_weight=0.5)
        assert ask(motion, ends, "cost") == pytest.approx((f**p + 0.5) * duration, rel=1e-12)
    assert ask(model(TerrainMotion, clearance, Lp(math.inf)), ends, "cost") == pytest.approx(f)


def test_descent_towards_flat_ground_in_closed_form():
    """d falls linearly from 25 to 5: f^2 and f'^2 = v^2 / d^4 integrate by hand."""
    clearance = TerrainClearance(Terrain(np.zeros((9, 9)), spacing=(50.0, 50.0)))
    ends = np.array([[100.0, 100.0, 25.0], [100.0, 100.0, 5.0]])
    v, tau, a, b = 20.0, 2.0, 5.0, 25.0
    square = (1 / a - 1 / b - 2 * math.log(b / a) / D0 + (b - a) / D0**2) / v
    slope = v * (a**-3 - b**-3) / 3
    motion = model(
        TerrainMotion, clearance, Sobolev(1, time_scale=tau), duration_weight=0.0, tolerance=1e-4
    )
    assert ask(motion, ends, "cost") == pytest.approx(square + tau**2 * slope, rel=1e-4)


@pytest.mark.parametrize("kind", [TerrainMotion, SampledMotion])
def test_validity_never_contradicts_dense_sampling(kind):
    clearance = TerrainClearance(hills(1), radius=2.0)
    motion, outcomes = model(kind, clearance), []
    for seed in range(150):
        ends = random_motion(clearance.terrain, seed)
        least = dense(clearance, ends, 4001).min()
        free = ask(motion, ends, "is_motion_free")
        outcomes.append(free)
        assert type(free) is bool
        if least <= 0:
            assert not free
            assert ask(motion, ends, "cost") == math.inf
        elif least > 0.2:
            assert free
            assert ask(motion, ends, "cost") < math.inf
    assert 0.1 < np.mean(outcomes) < 0.9


@pytest.mark.parametrize("kind", [TerrainMotion, SampledMotion])
def test_a_needle_between_distant_samples_is_not_jumped_over(kind):
    heights = np.zeros((3, 4001))
    heights[:, 2017] = 100.0
    clearance = TerrainClearance(Terrain(heights, spacing=(1.0, 1.0)))
    motion = model(kind, clearance)
    through = np.array([[0.0, 1.0, 99.0], [4000.0, 1.0, 99.0]])
    over = through + np.array([0, 0, 1.5])
    assert not ask(motion, through, "is_motion_free")
    assert ask(motion, through, "cost") == math.inf
    assert ask(motion, over, "is_motion_free")
    assert ask(motion, over, "cost") < math.inf


@pytest.mark.parametrize("kind", [TerrainMotion, SampledMotion])
@pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
def test_heuristic_is_a_lower_bound_for_straight_and_for_bent_ways(kind, norm):
    clearance = TerrainClearance(hills(2), radius=2.0)
    motion = model(kind, clearance, norm, duration_weight=1e-4 if norm.exponent < 9 else None)
    compared = positive = 0
    for seed in range(60):
        a, b = random_motion(clearance.terrain, seed, 3, 40)
        c = random_motion(clearance.terrain, 1000 + seed, 20, 90)[0]
        lower = ask(motion, (a, b), "heuristic")
        straight = ask(motion, (a, b), "cost")
        bent = motion._risk.combine if kind is SampledMotion else Risk(norm=norm, speed=1.0).combine
        detour = bent([ask(motion, (a, c), "cost"), ask(motion, (c, b), "cost")])
        assert lower <= straight * 1.01
        assert lower <= detour * 1.01
        compared += math.isfinite(straight)
        positive += lower > 0
    assert compared > 10
    assert positive > 30


@given(seed=st.integers(0, 10_000), cut=st.floats(0.05, 0.95))
@settings(max_examples=60, deadline=None)
def test_costs_add_up_along_a_motion_and_do_not_depend_on_direction(seed, cut):
    clearance = TerrainClearance(hills(5), radius=2.0)
    motion, grazing = model(TerrainMotion, clearance, tolerance=1e-5), 20.0 / D0**3
    a, b = random_motion(clearance.terrain, seed, 10, 60)
    c = a + cut * (b - a)
    whole = ask(motion, (a, b), "cost")
    if math.isfinite(whole):
        parts = ask(motion, (a, c), "cost") + ask(motion, (c, b), "cost")
        assert parts == pytest.approx(whole, rel=1e-2, abs=1e-2 * grazing)
        assert ask(motion, (b, a), "cost") == pytest.approx(whole, rel=1e-2, abs=1e-2 * grazing)


def test_far_from_obstacles_only_the_tie_break_remains():
    clearance = TerrainClearance(hills(), radius=2.0)
    ends = np.array([[10.0, 10.0, 500.0], [300.0, 300.0, 500.0]])
    cost = ask(model(TerrainMotion, clearance), ends, "cost")
    assert cost == pytest.approx(1e-9 / D0**2 * np.linalg.norm(ends[1] - ends[0]) / 20.0)
    assert ask(model(TerrainMotion, clearance, duration_weight=0.0), ends, "cost") == 0.0


def test_turning_a_long_body_on_the_spot_is_checked_all_the_way():
    wall = trimesh.creation.box((1, 20, 20))
    wall.apply_translation((4, 0, 0))
    clearance = MeshClearance(wall, body=trimesh.creation.box((0.2, 10, 0.2)))
    motion = SampledMotion(clearance, Risk(speed=1.0), width=7)
    motion.a[:] = [0, 0, 0, 0, 0, 0, 1]
    motion.b[:] = [0, 0, 0, 0, 0, 1, 0]  # half a turn about z: the rod sweeps through the wall
    assert motion.is_free()
    assert not motion.is_motion_free()
    assert motion.cost() == math.inf


def test_outside_the_map_is_not_free():
    clearance = TerrainClearance(hills())
    motion = model(TerrainMotion, clearance)
    ends = np.array([[10.0, 10.0, 300.0], [10.0, -40.0, 300.0]])
    assert not ask(motion, ends, "is_motion_free")
    assert ask(motion, ends, "cost") == math.inf


def test_the_quickest_model_is_chosen():
    ground = TerrainClearance(hills())
    assert isinstance(motion_model(ground, Risk(speed=1.0)), TerrainMotion)
    assert isinstance(motion_model(lambda p: p[:, 2], Risk(speed=1.0)), SampledMotion)


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"speed": 0.0}, "speed = 0.0"),
        ({"speed": 1.0, "norm": Sobolev(2)}, "norm = "),
        ({"speed": 1.0, "norm": Sobolev(1, form="fourier")}, "norm = "),
        ({"speed": 1.0, "tolerance": 0.0}, "tolerance = 0.0"),
        ({"speed": 1.0, "duration_weight": -1.0}, "duration_weight = -1.0"),
        ({"speed": 1.0, "norm": Lp(math.inf), "duration_weight": 1.0}, "Lp(inf)"),
        ({"speed": 1.0, "avoidance": 100.0}, "avoidance = 100.0"),
    ],
)
def test_bad_risk_is_named(options, names):
    with pytest.raises(ArgumentError) as error:
        Risk(**options)
    assert names in str(error.value)


def test_a_clearance_that_answers_wrongly_is_named():
    with pytest.raises(ArgumentError, match="shape"):
        SampledMotion(lambda p: np.zeros(7), Risk(speed=1.0)).clearance()
    with pytest.raises(ArgumentError, match="nan"):
        SampledMotion(lambda p: np.full(len(p), np.nan), Risk(speed=1.0)).clearance()
    posed = MeshClearance(trimesh.creation.box(), body=trimesh.creation.box())
    with pytest.raises(ArgumentError, match="orientation"):
        SampledMotion(posed, Risk(speed=1.0), width=3)


def test_subclasses_that_change_d_or_f_are_not_bypassed():
    class WithTower(TerrainClearance):
        def __call__(self, points, **options):
            tower = np.hypot(points[:, 0] - 200, points[:, 1] - 200) - 20
            return np.minimum(super().__call__(points, **options), tower)

    class Steep(InverseDistance):
        def __call__(self, d):
            return 10 * super().__call__(d)

    terrain = hills()
    tower = WithTower(terrain)
    ends = np.array([[100.0, 200.0, 300.0], [300.0, 200.0, 300.0]])
    assert not ask(motion_model(tower, Risk(speed=1.0)), ends, "is_motion_free")
    assert isinstance(tower.with_radius(1.0), WithTower)
    low = np.array([[100.0, 50.0, 60.0], [120.0, 50.0, 60.0]])
    plain, steep = (
        ask(motion_model(TerrainClearance(terrain), Risk(f, Lp(1), speed=1.0)), low, "cost")
        for f in (InverseDistance(200.0), Steep(200.0))
    )
    assert steep == pytest.approx(10 * plain, rel=1e-2)


def test_regular_ground_does_not_keep_step_with_the_samples():
    x = np.arange(1025) * 0.25
    furrows = np.tile(0.25 * np.abs(np.arange(1025) % 2), (3, 1)).astype(float)
    clearance = TerrainClearance(Terrain(furrows, spacing=(0.25, 0.25)))
    ends = np.array([[10.0, 0.25, 0.6], [10.0 + 128.0, 0.25, 0.6]])
    d = dense(clearance, ends, 200_001)
    t = np.linspace(0, 128.0 / 20.0, len(d))
    expected = Sobolev(1).power(t, InverseDistance(D0)(d))
    motion = model(TerrainMotion, clearance, duration_weight=0.0)
    assert x[-1] > 138.0
    assert ask(motion, ends, "cost") == pytest.approx(expected, rel=3e-2)


def test_a_turning_body_takes_time_and_the_heuristic_stays_below():
    wall = trimesh.creation.box((1, 40, 40))
    wall.apply_translation((9, 0, 0))
    clearance = MeshClearance(wall, body=trimesh.creation.box((0.2, 10, 0.2)))
    motion = SampledMotion(clearance, Risk(InverseDistance(20.0), speed=2.0), width=7)
    rng = np.random.default_rng(0)
    for shift in (0.0, 1e-3, 1.0):
        angle = rng.uniform(0.5, 1.5)
        motion.a[:] = [0, 0, 0, 0, 0, 0, 1]
        motion.b[:] = [shift, 0, 0, 0, 0, math.sin(angle / 2), math.cos(angle / 2)]
        assert 0.0 < motion.heuristic() <= 1.01 * motion.cost() < math.inf
    at_once = motion.cost()
    motion.b[0] += 1e-6
    assert motion.cost() == pytest.approx(at_once, rel=1e-3)


def test_the_maximum_close_to_flat_ground_is_found_and_collisions_are_not_missed():
    clearance = TerrainClearance(Terrain(np.zeros((3, 3)), spacing=(500.0, 500.0)))
    motion = model(TerrainMotion, clearance, Lp(math.inf))
    level = np.array([[1.0, 1.0, 0.05], [400.0, 1.0, 0.05]])
    assert ask(motion, level, "cost") == pytest.approx(1 / 0.05 - 1 / D0)
    dipping = np.array([[1.0, 1.0, 0.05], [400.0, 1.0, -0.001]])
    assert ask(motion, dipping, "cost") == math.inf
