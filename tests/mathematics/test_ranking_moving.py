"""Ranking among obstacles that move: the time of each sample counts."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance, UnionClearance
from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingSphere
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.ranking import DEFAULT_NORMS, rank
from ompl_risk.ranking.sampling import sample
from ompl_risk.terrains import Terrain
from ompl_risk.trajectory import Trajectory

D0 = 50.0
F = InverseDistance(d0=D0)


def passing(speed=20.0, miss=10.0, radius=2.0, duration=20.0):
    """A ball that passes the origin at half time."""
    half = 0.5 * speed * duration
    return MovingSphere(radius, [0.0, duration], [[-half, miss, 0.0], [half, miss, 0.0]])


def hover(duration=20.0, name="hover"):
    return Trajectory([0.0, duration], np.zeros((2, 3)), name)


def test_norms_of_a_hover_that_a_ball_passes_in_closed_form():
    ranking = rank([hover()], MovingClearance(passing(), radius=1.0), F)

    def d(t):
        return math.hypot(10.0, 20.0 * (t - 10.0)) - 3.0

    def f(t):
        return max(1.0 / d(t) - 1.0 / D0, 0.0)

    def slope(t):
        return 20.0**2 * (t - 10.0) / (d(t) + 3.0) / d(t) ** 2 if d(t) < D0 else 0.0

    reach = math.sqrt((D0 + 3.0) ** 2 - 100.0) / 20.0
    ends = {"points": [10.0 - reach, 10.0, 10.0 + reach], "limit": 200}
    one = quad(f, 0.0, 20.0, **ends)[0]
    two = quad(lambda t: f(t) ** 2, 0.0, 20.0, **ends)[0]
    rise = quad(lambda t: slope(t) ** 2, 0.0, 20.0, **ends)[0]
    found = ranking["hover"].norms
    assert found["L1"] == pytest.approx(one, rel=1e-3)
    assert found["L2"] == pytest.approx(math.sqrt(two), rel=1e-3)
    assert found["H1"] == pytest.approx(math.sqrt(two + rise), rel=1e-3)
    assert ranking["hover"].min_clearance == pytest.approx(7.0, abs=0.01)
    assert ranking["hover"].min_clearance_time == pytest.approx(10.0, abs=0.05)
    part = ranking["hover"].attribution["H1"]
    assert part.start < 10.0 < part.end
    assert part.end - part.start < 1.0


def test_trajectories_that_differ_in_timing_alone():
    """Both fly the same way in the same time; one waits for the ball first, one afterwards."""
    ball = MovingSphere(5.0, [0.0, 20.0], [[60.0, -100.0, 0.0], [60.0, 100.0, 0.0]])
    way = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
    waits = Trajectory([0.0, 10.0, 20.0], way, "waits")
    hurries = Trajectory([0.0, 10.0, 20.0], way[[0, 2, 2]], "hurries")
    meets = Trajectory([0.0, 4.0, 14.0, 20.0], way[[0, 0, 2, 2]], "meets")
    clearance = MovingClearance(ball, radius=1.0)
    ranking = rank([meets, hurries, waits], clearance, F)
    for norm in DEFAULT_NORMS:
        assert ranking.orders[norm.label][-1] == "meets"
    assert ranking["meets"].collides
    assert ranking["meets"].collision_time == pytest.approx(9.7, abs=0.4)
    assert not ranking["waits"].collides
    # Over what stands still all three are one way.
    still = rank([meets, hurries, waits], clearance.at(0.0), F, norms=[Lp(math.inf)])
    assert len({round(a.norms[Lp(math.inf).label], 9) for a in still.assessments}) == 1


def test_a_bullet_that_crosses_between_the_samples_is_a_collision():
    bullet = MovingSphere(0.05, [0.0, 10.0], [[-5000.0, 0.0, 0.0], [5000.0, 0.0, 0.0]])
    away = MovingSphere(0.05, [0.0, 10.0], [[-5000.0, 1.0, 0.0], [5000.0, 1.0, 0.0]])
    for trajectory in (
        hover(10.0),
        Trajectory([0.0, 10.0], [[0.0, -50.0, 0.0], [0.0, 50.0, 0.0]], "hover"),
    ):
        ranking = rank([trajectory], MovingClearance(bullet), F)
        assert ranking["hover"].collides
        assert ranking["hover"].collision_time == pytest.approx(5.0, abs=1e-3)
        assert all(math.isinf(value) for value in ranking["hover"].norms.values())
    near = rank([hover(10.0)], MovingClearance(away), F)["hover"]
    assert not near.collides
    assert near.min_clearance == pytest.approx(0.95, abs=1e-2)


def test_steps_are_short_against_the_distance_over_the_relative_motion():
    clearance = MovingClearance(passing(speed=40.0), radius=1.0)
    samples = sample(hover(), clearance, F, D0 / 50)
    t, d = samples.trajectory.t, np.minimum(samples.d, D0)
    travel = 40.0 * np.diff(t)
    near = np.minimum(d[:-1], d[1:])
    assert (travel[near < D0] <= np.maximum(0.1 * near, 0.0)[near < D0] * (1 + 1e-6)).all()
    assert (travel[near < D0] <= D0 / 50 * (1 + 1e-6)).all()
    assert np.diff(t).max() > 2.0  # far away a few samples do


def test_what_comes_near_in_the_middle_of_a_long_step_is_found():
    """Beyond d0 until it is 2 s away, and again 2 s later: the ends of the step say nothing."""
    x = [-900.0, -60.0, 60.0, 900.0]
    comet = MovingSphere(1.0, [0.0, 1.0, 5.0, 6.0], [[each, 6.0, 0.0] for each in x])
    found = rank([hover(6.0)], MovingClearance(comet), F, norms=[Lp(2)], max_step=1e6)["hover"]
    assert found.min_clearance == pytest.approx(5.0, abs=0.05)
    assert found.norms["L2"] > 0.0


def test_in_formation_nothing_has_to_be_sampled():
    beside = MovingSphere(1.0, [0.0, 10.0], [[0.0, 5.0, 0.0], [300.0, 5.0, 0.0]])
    flight = Trajectory([0.0, 10.0], [[0.0, 0.0, 0.0], [300.0, 0.0, 0.0]], "A")
    samples = sample(flight, MovingClearance(beside), F, 1e9)
    assert len(samples.trajectory) == 2
    assert samples.d == pytest.approx([4.0, 4.0])


def test_obstacles_that_stand_still_are_ranked_as_ever():
    terrain = Terrain(np.zeros((21, 21)), spacing=(10.0, 10.0), origin=(-100.0, -100.0))
    ground = TerrainClearance(terrain, radius=1.0)
    parked = MovingBox([8.0, 8.0, 8.0], [0.0, 1.0], [[0.0, 30.0, 20.0], [0.0, 30.0, 20.0]])
    x = np.linspace(-80.0, 80.0, 5)
    flight = Trajectory(np.arange(5.0), np.column_stack([x, 0.0 * x, 15.0 + np.abs(x) / 4]), "A")
    moving = MovingClearance(parked, static=ground)
    norms = (*DEFAULT_NORMS, Sobolev(2))
    found = rank([flight], moving, F, norms)["A"]
    still = rank([flight], UnionClearance([ground, moving.with_static(None).at(0.0)]), F, norms)[
        "A"
    ]
    for label in [norm.label for norm in DEFAULT_NORMS]:
        assert found.norms[label] == pytest.approx(still.norms[label], rel=1e-3)
    assert found.min_clearance == pytest.approx(still.min_clearance, abs=1e-9)


def test_given_samples_are_taken_at_their_times():
    ranking = rank([hover()], MovingClearance(passing()), F, norms=[Lp(1)], max_step=None)
    assert ranking["hover"].d == pytest.approx([math.hypot(200.0, 10.0) - 2.0] * 2)


def test_uniform_times_of_higher_norms_are_used_too():
    clearance = MovingClearance(passing())
    found = rank([hover()], clearance, F, norms=[Lp(2), Sobolev(2)])["hover"]
    assert found.norms["H2"] > found.norms["L2"] > 0.0


def test_a_union_of_what_moves_is_refused():
    with pytest.raises(ArgumentError, match="stands still"):
        UnionClearance([MovingClearance(passing()), lambda points: points[:, 2] + 99.0])
