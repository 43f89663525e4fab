"""A point mass in closed loop: exact without disturbances, of known variance and risk with them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov
from scipy.stats import binomtest, norm

from ompl_risk import terrains
from ompl_risk._kernels import gusts as gust_kernels
from ompl_risk._kernels.watch import CONTACT
from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.gusts import DrydenGusts
from ompl_risk.simulation.disturbances.navigation import Drift, NavigationError
from ompl_risk.simulation.disturbances.terrain_error import TerrainError
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.outcomes import Outcomes
from ompl_risk.simulation.loop.point_plan import SHARE, PointPlan, feedback_gains, rounded
from ompl_risk.simulation.loop.rollouts import fly
from ompl_risk.trajectory import Trajectory

FLAT = terrains.Terrain(np.zeros((101, 101)), spacing=(40.0, 40.0), origin=(-2000.0, -2000.0))
GROUND = TerrainClearance(FLAT, radius=5.0)
STILL = Disturbances()
NONE = (0.0, 0.0, 0.0)
QUIET = Drift(NONE, NONE, 1.0)
STRAIGHT = Trajectory.at_constant_speed([[-600, -300, 60], [600, 300, 45]], 20.0, "straight")
CORNER = Trajectory.at_constant_speed([[0, 0, 60], [400, 0, 60], [400, 400, 70]], 20.0, "corner")


def flown(plan: PointPlan, disturbances: Disturbances, count: int, seed: int = 0) -> Outcomes:
    draws = Draws.make(count, seed, disturbances)
    return fly(plan, GROUND, disturbances, draws, threads=1, traced=1)


def deviations(plan: PointPlan, disturbances: Disturbances, count: int, seed: int = 0):
    return flown(plan, disturbances, count, seed).traces - plan.positions


def accelerations(positions: np.ndarray, dt: float) -> np.ndarray:
    return np.linalg.norm(np.diff(positions, n=2, axis=-2), axis=-1) / dt**2


@pytest.mark.parametrize("limit", [math.inf, 8.0, 0.01])
def test_undisturbed_it_follows_a_straight_line_exactly(limit: float) -> None:
    plan = PointPlan(STRAIGHT, acceleration=limit)
    share = np.linspace(0.0, 1.0, len(plan.times))[:, None]
    line = (1.0 - share) * STRAIGHT.positions[0] + share * STRAIGHT.positions[-1]
    np.testing.assert_allclose(plan.positions, line, atol=1e-9)
    np.testing.assert_allclose(deviations(plan, STILL, 2), 0.0, atol=1e-9)


def test_without_a_limit_it_keeps_corners() -> None:
    plan = PointPlan(CORNER, acceleration=math.inf)
    np.testing.assert_allclose(plan.positions, CORNER.resample(plan.times).positions, atol=1e-9)
    np.testing.assert_allclose(deviations(plan, STILL, 1), 0.0, atol=1e-9)


def test_a_limit_rounds_corners_and_undisturbed_it_flies_what_is_planned() -> None:
    plan = PointPlan(CORNER, acceleration=6.0)
    np.testing.assert_allclose(deviations(plan, STILL, 1), 0.0, atol=1e-6)
    steepest = accelerations(plan.positions, plan.dt).max()
    assert 0.95 * SHARE * 6.0 < steepest <= SHARE * 6.0
    np.testing.assert_allclose(plan.positions[[0, -1]], CORNER.positions[[0, -1]], atol=1e-12)
    inside = plan.positions[np.abs(plan.times - 20.0).argmin()] - [400.0, 0.0, 60.0]
    assert inside[0] < -3.0  # passes the corner on the inside
    assert inside[1] > 3.0


def test_a_tighter_limit_strays_farther_from_the_corner() -> None:
    strays = []
    for limit in (20.0, 10.0, 5.0):
        plan = PointPlan(CORNER, acceleration=limit)
        samples = CORNER.resample(plan.times).positions
        strays.append(np.linalg.norm(plan.positions - samples, axis=1).max())
    assert strays[0] < strays[1] < strays[2]


def test_rounding_is_the_least_that_the_limit_asks_for() -> None:
    samples, dt = CORNER.resample(step=0.1).positions, 0.1
    smooth = rounded(samples, dt, 4.0)
    bends = np.diff(smooth, n=2, axis=0)
    second = np.diff(np.eye(len(samples)), n=2, axis=0)
    # normal equations of an inner sample: x - sample + weight D^T D x = 0 with one weight for all
    away, pull = (smooth - samples)[2:-2], (second.T @ bends)[2:-2]
    weight = -(away * pull).sum() / (pull * pull).sum()
    np.testing.assert_allclose(away, -weight * pull, atol=1e-6)
    assert accelerations(smooth, dt).max() == pytest.approx(4.0, rel=1e-3)


def test_gains_approach_those_of_continuous_time() -> None:
    k_p, k_v = feedback_gains(1e-4, 1.5)
    assert k_p == pytest.approx(1.5**2, rel=1e-3)
    assert k_v == pytest.approx(math.sqrt(2.0) * 1.5, rel=1e-3)


def loop(plan: PointPlan, damping: float) -> tuple[np.ndarray, np.ndarray]:
    """State matrix and input column (acceleration) of deviations (x, v) along one axis."""
    dt, (k_p, k_v) = plan.dt, plan.gains
    v = np.array([-dt * k_p, 1.0 - dt * (k_v + damping)])
    return np.array([[1.0, 0.0] + dt * v, v]), np.array([dt * dt, dt])


def test_variance_under_navigation_noise_is_that_of_the_lyapunov_equation() -> None:
    dt, noise, slip = 0.1, 1.5, 0.4
    plan = PointPlan(STRAIGHT, dt=dt, acceleration=math.inf, drag=(3.0, 3.0, 3.0))
    navigation = NavigationError(
        Drift(NONE, (noise,) * 3, 1.0), QUIET, Drift(NONE, (slip,) * 3, 1.0), rate=1.0 / plan.dt
    )
    a, b = loop(plan, 3.0 / plan.mass)
    k_p, k_v = plan.gains
    push = (k_p * noise) ** 2 + (k_v * slip) ** 2
    wanted = solve_discrete_lyapunov(a, push * np.outer(b, b))[0, 0]
    late = deviations(plan, Disturbances(navigation=navigation), 1500)[:, -300::60]
    found = (late**2).mean(axis=(0, 1))
    np.testing.assert_allclose(found, wanted, rtol=5.0 * math.sqrt(2.0 / late[..., 0].size))


def test_variance_under_gusts_is_that_of_the_linear_loop() -> None:
    gusts = DrydenGusts(8.0, (4.0, 4.0, 12.0))
    level = Trajectory.at_constant_speed([[-600, 0, 50], [600, 0, 50]], 20.0)
    plan = PointPlan(level, dt=0.1, acceleration=math.inf)
    n = len(plan.times) - 1
    rows = gusts.filters(np.full(n, 50.0), np.full(n, 20.0), np.zeros(n), plan.dt)
    keep, passed, r11, r21, r22 = rows[0, gust_kernels.UP : gust_kernels.UP + 5]
    shares = rows[0, gust_kernels.UP_SIGMA] * np.array([gust_kernels.FIRST, gust_kernels.SECOND])
    damping = 12.0 / plan.mass
    a, b = loop(plan, damping)
    filters, root = np.array([[keep, 0], [passed, keep]]), np.array([[r11, 0], [r21, r22]])
    whole = np.block([[a, damping * np.outer(b, shares @ filters)], [np.zeros((2, 2)), filters]])
    drive = np.vstack([damping * np.outer(b, shares @ root), root])
    wanted = solve_discrete_lyapunov(whole, drive @ drive.T)[0, 0]
    late = deviations(plan, Disturbances(gusts=gusts), 3000)[:, -1, 2]
    assert (late**2).mean() == pytest.approx(wanted, rel=5.0 * math.sqrt(2.0 / 3000))


def test_gusts_push_along_the_axes_of_the_flight() -> None:
    c, s = math.cos(0.6), math.sin(0.6)
    plan = PointPlan(Trajectory.at_constant_speed([[0, 0, 50], [800 * c, 800 * s, 50]], 20.0))
    axes = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])  # forward, left, up
    for axis, drag in enumerate(5.0 * np.eye(3)):
        gusts = Disturbances(gusts=DrydenGusts(8.0, drag))
        moved = np.abs(deviations(plan, gusts, 4) @ axes.T)
        assert moved[..., axis].max() > 0.1
        np.testing.assert_allclose(np.delete(moved, axis, axis=-1), 0.0, atol=1e-9)


def test_the_plans_own_drag_serves_where_the_gusts_have_none() -> None:
    own = PointPlan(STRAIGHT, drag=(1.0, 2.0, 3.0))
    other = PointPlan(STRAIGHT, drag=NONE)
    one = deviations(own, Disturbances(gusts=DrydenGusts(8.0, None)), 3)
    two = deviations(other, Disturbances(gusts=DrydenGusts(8.0, (1.0, 2.0, 3.0))), 3)
    np.testing.assert_array_equal(one, two)


def test_a_steady_error_of_position_moves_the_flight_by_as_much() -> None:
    bias = NavigationError(Drift((2.0, 3.0, 4.0), NONE, 1e12), QUIET, QUIET)
    late = deviations(PointPlan(STRAIGHT, dt=0.2), Disturbances(navigation=bias), 3000)[:, -1]
    np.testing.assert_allclose(late.std(axis=0), [2.0, 3.0, 4.0], rtol=5.0 / math.sqrt(2.0 * 3000))
    assert np.abs(np.corrcoef(late.T) - np.eye(3)).max() < 4.5 / math.sqrt(3000)


def test_errors_of_velocity_are_in_the_frame_of_the_flight() -> None:
    north = Trajectory.at_constant_speed([[0, -600, 50], [0, 600, 50]], 20.0)
    forward = NavigationError(QUIET, QUIET, Drift((0.5, 0.0, 0.0), NONE, 1e12))
    plan = PointPlan(north, dt=0.2)
    late = deviations(plan, Disturbances(navigation=forward), 2000)[:, -1]
    k_p, k_v = plan.gains
    np.testing.assert_allclose(late[:, [0, 2]], 0.0, atol=1e-9)
    assert late[:, 1].std() == pytest.approx(0.5 * k_v / k_p, rel=5.0 / math.sqrt(4000))


def test_commands_stay_within_the_limit() -> None:
    far = NavigationError(Drift((40.0, 40.0, 10.0), NONE, 1e12), QUIET, QUIET)
    plan = PointPlan(STRAIGHT, acceleration=1.5, drag=NONE)
    traces = flown(plan, Disturbances(navigation=far), 20).traces
    size = accelerations(traces, plan.dt)
    assert size.max() == pytest.approx(1.5, abs=1e-6)
    assert (size > 1.4).mean() > 0.01


def test_collisions_with_ground_of_unknown_height_are_as_often_as_the_normal_tail_says() -> None:
    level = Trajectory.at_constant_speed([[-10, 0, 20], [10, 0, 20]], 20.0)
    terrain = TerrainError(9.0, math.inf, 8)
    outcomes = flown(PointPlan(level, dt=0.5), Disturbances(terrain=terrain), 10_000)
    expected = norm.sf((20.0 - 5.0 - CONTACT) / 9.0)
    assert binomtest(int(outcomes.hits.sum()), 10_000, expected).pvalue > 0.01
    np.testing.assert_array_equal(outcomes.collided[outcomes.hits], 0.0)  # at once
    e = 9.0 / math.sqrt(8) * Draws.make(10_000, 0, Disturbances(terrain=terrain)).amplitudes
    clear = 15.0 - e[:, :8].sum(axis=1)
    free = ~outcomes.hits
    np.testing.assert_allclose(outcomes.least[free], clear[free], atol=1e-6)


def test_a_vehicle_far_from_its_plan_is_lost() -> None:
    away = NavigationError(Drift((1e5, 0, 0), NONE, 1e12), QUIET, QUIET)
    plan = PointPlan(STRAIGHT, acceleration=1e4)
    outcomes = flown(plan, Disturbances(navigation=away), 20)
    assert outcomes.hits.all()
    assert (outcomes.left | outcomes.lost).all()
    assert outcomes.lost.any()


def test_rollouts_do_not_depend_on_how_they_are_divided() -> None:
    severe, plan = Disturbances.level("severe"), PointPlan(CORNER)
    draws = Draws.make(24, 3, severe)
    one = fly(plan, GROUND, severe, draws, threads=1)
    two = fly(plan, GROUND, severe, draws, threads=2)
    few = fly(plan, GROUND, severe, Draws.make(10, 3, severe), threads=1)
    np.testing.assert_array_equal(one.least, two.least)
    np.testing.assert_array_equal(one.least[:10], few.least)


def test_steps_divide_the_duration() -> None:
    plan = PointPlan(Trajectory([5.0, 6.05], [[0, 0, 50], [20, 0, 50]], "late"), dt=0.1)
    assert len(plan.times) == 12
    assert plan.times[0] == 0.0
    assert plan.times[-1] == pytest.approx(1.05)
    assert plan.name == "late"
    np.testing.assert_allclose(plan.positions[-1], [20, 0, 50])
    np.testing.assert_allclose(
        plan.positions[1:], plan.positions[:-1] + plan.dt * plan.velocities[1:], atol=1e-12
    )
    assert not plan.positions.flags.writeable


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"dt": 0.0}, "dt"),
        ({"acceleration": 0.0}, "acceleration"),
        ({"acceleration": math.nan}, "acceleration"),
        ({"acceleration": 1e-12}, "acceleration"),
        ({"bandwidth": -1.0}, "bandwidth"),
        ({"mass": math.inf}, "mass"),
        ({"drag": (1.0, 1.0)}, "drag"),
        ({"drag": (1.0, 1.0, -1.0)}, "drag"),
    ],
)
def test_plans_that_are_none(arguments: dict, name: str) -> None:
    with pytest.raises(ArgumentError, match=name):
        PointPlan(CORNER, **arguments)
