"""P_c(t) among obstacles that move: they count as they stand at that time."""

import math

import numpy as np
import pytest

from ompl_risk.clearance import TerrainClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingSphere
from ompl_risk.errors import ArgumentError
from ompl_risk.probability import (
    BallSampling,
    ColumnQuadrature,
    collision_probabilities,
    collision_probability,
)
from ompl_risk.probability.mixed import ColumnsAndSampling
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

R = 20.0
FLAT = Terrain(np.zeros((11, 11)), spacing=(20.0, 20.0), origin=(-100.0, -100.0))


def lens(distance, a, b):
    """Volume that two balls share."""
    if distance >= a + b:
        return 0.0
    if distance <= abs(a - b):
        return 4.0 / 3.0 * math.pi * min(a, b) ** 3
    s = a + b - distance
    rest = distance**2 + 2 * distance * (a + b) - 3 * (a - b) ** 2
    return math.pi * s**2 * rest / (12 * distance)


def passing(radius=10.0, height=0.0):
    """A ball that passes (0, 0) at t = 10."""
    return MovingSphere(radius, [0.0, 20.0], [[-100.0, 5.0, height], [100.0, 5.0, height]])


def hover(height=0.0, duration=20.0):
    return Trajectory([0.0, duration], [[0.0, 0.0, height]] * 2, "hover")


def share(t, radius=10.0):
    gap = np.hypot(10.0 * (np.asarray(t) - 10.0), 5.0)
    return np.array([lens(d, radius, R) for d in gap]) / (4.0 / 3.0 * math.pi * R**3)


def alone(height):
    """The ground's share."""
    return collision_probability(hover(height), TerrainClearance(FLAT), R).p[0]


def test_share_of_a_ball_that_passes_in_closed_form():
    estimator = BallSampling(4000, seed=1, confidence=0.999)
    path = hover().resample(np.linspace(0, 20, 41))
    clearance = MovingClearance(passing(), radius=3.0)
    profile = collision_probability(path, clearance, R, estimator=estimator, max_step=None)
    true = share(profile.t)
    assert true.max() > 0.1
    assert ((profile.low <= true + 1e-12) & (true <= profile.high)).all()
    assert profile.p == pytest.approx(true, abs=0.025)
    grown = collision_probability(path, clearance, R, estimator=estimator, max_step=None, grow=True)
    assert grown.p == pytest.approx(share(profile.t, 13.0), abs=0.03)


def test_waiting_is_sampled_while_something_passes():
    profile = collision_probability(hover(), MovingClearance(passing()), R)
    gap = np.hypot(10.0 * (profile.t - 10.0), 5.0)
    moved = 10.0 * np.diff(profile.t)
    near = np.minimum(gap[1:], gap[:-1]) < R + 10.0
    assert (moved[near] <= R / 50 * (1 + 1e-6)).all()
    assert profile.p.max() > 0.1
    assert moved.max() > 5 * R / 50  # not where it is far
    assert "ball sampling" in profile.method


def test_over_terrain_the_ground_is_integrated_and_the_rest_sampled():
    """Half the passing ball is under the ground: it counts once."""
    height = 8.0
    clearance = MovingClearance(passing(), static=TerrainClearance(FLAT))
    path = hover(height).resample(np.linspace(0, 20, 61))
    profile = collision_probability(path, clearance, R, max_step=None)
    assert profile.method.startswith("column quadrature of the ground, ball sampling")
    ground = (1 - height / R) ** 2 * (2 + height / R) / 4
    level = alone(height)
    assert level == pytest.approx(ground, abs=1e-3)
    gap = np.hypot(10.0 * (profile.t - 10.0), math.hypot(5.0, height))
    away = gap > R + 10.0
    assert away.any()
    assert profile.p[away] == pytest.approx(level, abs=1e-15)
    assert (profile.high - profile.low)[away].max() < 0.02
    sampled = collision_probability(
        path, clearance, R, estimator=BallSampling(20_000, seed=3), max_step=None
    )
    assert profile.p == pytest.approx(sampled.p, abs=0.03)
    assert profile.p[~away].max() > ground + 0.02
    assert (profile.low <= sampled.high).all()
    assert (sampled.low <= profile.high).all()


def test_buried_obstacles_add_nothing_and_whole_balls_are_no_more_than_certain():
    under = MovingSphere(10.0, [0.0, 20.0], [[-100.0, 0.0, -11.0], [100.0, 0.0, -11.0]])
    clearance = MovingClearance(under, static=TerrainClearance(FLAT))
    found = collision_probability(hover(5.0), clearance, R)
    assert found.p == pytest.approx(alone(5.0), abs=1e-15)
    huge = MovingBox([400.0, 400.0, 400.0], [0.0, 20.0], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    clearance = MovingClearance(huge, static=TerrainClearance(FLAT))
    found = collision_probability(hover(5.0), clearance, R)
    assert found.p == pytest.approx(1.0, abs=0.06)
    assert (found.high <= 1.0).all()
    assert (found.p <= 1.0).all()


def test_beyond_the_map_the_ground_goes_on_level():
    clearance = MovingClearance(passing(), static=TerrainClearance(FLAT))
    beyond = Trajectory([0.0, 20.0], [[300.0, 0.0, 30.0]] * 2, "beyond")
    found = collision_probability(beyond, clearance, R, estimator=BallSampling(500))
    assert found.p.max() == 0.0


def test_shared_offsets_say_whether_the_whole_wait_ends_well():
    estimator = BallSampling(4000, offsets="shared", seed=2)
    path = hover().resample(np.linspace(0, 20, 401))
    profile = collision_probability(
        path, MovingClearance(passing()), R, estimator=estimator, max_step=None
    )
    # The ball sweeps a cylinder of radius 10 m, whose axis is 5 m from the centre.
    rng = np.random.default_rng(0)
    points = rng.uniform(-R, R, (400_000, 3))
    points = points[np.linalg.norm(points, axis=1) < R]
    swept = (np.hypot(points[:, 1] - 5.0, points[:, 2]) < 10.0).mean()
    assert profile.ever is not None
    assert profile.ever.p == pytest.approx(swept, abs=0.03)
    assert profile.ever.p > profile.p.max() + 0.1


def test_many_trajectories_by_name():
    clearance = MovingClearance(passing(), static=TerrainClearance(FLAT))
    late = Trajectory([20.0, 30.0], [[0.0, 0.0, 30.0]] * 2, "late")
    found = collision_probabilities([hover(15.0), late], clearance, R)
    assert found["hover"].p.max() > alone(15.0) + 0.01
    assert found["late"].p.max() == 0.0


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (
            lambda: collision_probability(
                hover(), MovingClearance(passing()), R, estimator=ColumnQuadrature()
            ),
            "estimator",
        ),
        (
            lambda: collision_probability(
                hover(), MovingClearance(passing()), R, estimator=ColumnsAndSampling()
            ),
            "estimator",
        ),
        (
            lambda: collision_probability(
                hover(), TerrainClearance(FLAT), R, estimator=ColumnsAndSampling()
            ),
            "estimator",
        ),
        (
            lambda: ColumnsAndSampling(sampling=BallSampling(offsets="shared")),
            "sampling.offsets",
        ),
        (
            lambda: BallSampling().estimate(MovingClearance(passing()), np.zeros((1, 3)), R),
            "times",
        ),
        (
            lambda: ColumnsAndSampling().estimate(
                MovingClearance(passing(), static=TerrainClearance(FLAT)), np.zeros((1, 3)), R
            ),
            "times",
        ),
    ],
)
def test_wrong_arguments(make, argument):
    with pytest.raises(ArgumentError) as caught:
        make()
    assert caught.value.argument == argument
