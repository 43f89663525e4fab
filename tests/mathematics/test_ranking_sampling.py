"""Norms that `rank` takes from corners alone, against integrals along the line."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from ompl_risk.avoidance import FlatCap, GaussianTail, InverseDistance
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.ranking import rank
from ompl_risk.trajectory import Trajectory

D0, SPEED = 100.0, 30.0
NORMS = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=0.1))


def to_point(points):
    """Distance to the origin."""
    return np.linalg.norm(points, axis=1)


def past(offset, name="A", half=300.0, points=2):
    """A straight line that passes the origin at a distance."""
    x = np.linspace(-half, half, points)
    return Trajectory.at_constant_speed(
        np.stack([x, np.full(points, offset), 0 * x], axis=1), SPEED, name
    )


def exact(offset):
    """Norms of f along that line, by adaptive quadrature over s = speed * time."""
    reach = math.sqrt(D0**2 - offset**2)

    def f(s):
        return 1 / math.hypot(s, offset) - 1 / D0

    def slope(s):
        return -s / math.hypot(s, offset) ** 3 * SPEED

    def integral(g):
        return 2 * quad(g, 0, reach, epsabs=0, epsrel=1e-11)[0] / SPEED

    l2, dot = integral(lambda s: f(s) ** 2), integral(lambda s: slope(s) ** 2)
    values = [integral(f), l2**0.5, f(0), (l2 + dot) ** 0.5, (l2 + 0.01 * dot) ** 0.5]
    return dict(zip([norm.label for norm in NORMS], values, strict=True))


@pytest.mark.parametrize("offset", [0.5, 3.0, 10.0, 40.0, 90.0])
def test_two_corners_are_enough(offset):
    found = rank([past(offset)], to_point, InverseDistance(D0), NORMS)["A"]
    for label, value in exact(offset).items():
        assert found.norms[label] == pytest.approx(value, rel=1.5e-3), label
    assert found.min_clearance == pytest.approx(offset, rel=2e-3)


BOUNDED = [FlatCap(100.0), FlatCap(30.0), GaussianTail(25.0), GaussianTail(3.0)]


def integrals(avoidance, offset):
    """Norms of a function along that line, by adaptive quadrature over s = speed * time."""
    reach = math.sqrt(avoidance.d0**2 - offset**2)

    def f(s):
        return float(avoidance(math.hypot(s, offset)))

    def slope(s):
        d = math.hypot(s, offset)
        return float(avoidance.derivative(d)) * s / d * SPEED

    def integral(g):
        ends = [0.0, min(10.0 * offset, 0.5 * reach), reach]
        parts = [quad(g, *ends[k : k + 2], epsabs=0, epsrel=1e-10)[0] for k in range(2)]
        return 2 * sum(parts) / SPEED

    l2, dot = integral(lambda s: f(s) ** 2), integral(lambda s: slope(s) ** 2)
    values = [integral(f), l2**0.5, f(0.0), (l2 + dot) ** 0.5, (l2 + 0.01 * dot) ** 0.5]
    return dict(zip([norm.label for norm in NORMS], values, strict=True))


@pytest.mark.parametrize("avoidance", BOUNDED, ids=str)
@pytest.mark.parametrize("share", [1e-3, 0.01, 0.03, 0.07, 0.12, 0.3, 0.6])
def test_norms_of_bounded_functions_are_as_exact_as_promised(avoidance, share):
    offset = share * avoidance.d0
    expected = integrals(avoidance, offset)
    for phase in (0.0, 0.31, 0.77):
        x = [[-2.0 * avoidance.d0 - phase, offset, 0.0], [2.0 * avoidance.d0, offset, 0.0]]
        found = rank([Trajectory.at_constant_speed(x, SPEED, "A")], to_point, avoidance, NORMS)["A"]
        for label, value in expected.items():
            assert found.norms[label] == pytest.approx(value, rel=1e-3), label
        assert 1.0 - 1e-9 <= found.min_clearance / offset <= 1.01


class Suspect(FlatCap):
    """The same function, without its word that it is bounded."""

    steady = None


@pytest.mark.parametrize("height", [0.3, 1.1, 4.1, 30.0])
def test_near_the_ground_a_bounded_function_takes_fewer_samples(height):
    level = Trajectory.at_constant_speed([[0, 0, height], [300, 0, height]], SPEED, "A")

    def samples(avoidance):
        return len(rank([level], lambda x: x[:, 2], avoidance)["A"].d) - 1

    bounded, pole = samples(FlatCap(100.0)), samples(Suspect(100.0))
    assert samples(InverseDistance(100.0)) == pole
    step = min(2.0, max(0.1 * max(height, 0.1), min(0.25 * height, 2.5)))
    assert bounded == 150 * math.ceil(2.0 / step * (1 - 1e-9))
    assert pole == 150 * math.ceil(2.0 / min(2.0, 0.1 * max(height, 0.1)) * (1 - 1e-9))


@pytest.mark.parametrize("avoidance", [FlatCap(100.0), GaussianTail(1.0, d0=100.0)], ids=str)
@pytest.mark.parametrize("end", [-0.001, -0.03, -1.0, -20.0])
def test_steps_towards_an_obstacle_stay_below_a_quarter_of_the_distance(avoidance, end):
    head_on = Trajectory.at_constant_speed([[-300, 0, 0], [end, 0, 0]], SPEED, "A")
    found = rank([head_on], to_point, avoidance)["A"]
    dense = rank([head_on], to_point, InverseDistance(100.0))["A"]
    steps, near = found.trajectory.steps, np.minimum(found.d[:-1], found.d[1:])
    allowed = np.maximum(
        0.1 * np.maximum(near, D0 / 1000), np.minimum(0.25 * near, 0.05 * avoidance.steady)
    )
    within = (near < D0) & ((found.d[:-1] < D0) == (found.d[1:] < D0))
    assert (steps <= np.minimum(np.where(within, allowed, D0), D0 / 50) * (1 + 1e-6)).all()
    assert len(found.d) <= len(dense.d)  # never more than for a pole


def test_norms_converge_with_the_square_of_the_step():
    def errors(step):
        found = rank([past(60.0)], to_point, InverseDistance(D0), NORMS, max_step=step)["A"]
        return np.array([abs(found.norms[k] / v - 1) for k, v in exact(60.0).items()])

    coarse, middle, fine = errors(4.0), errors(1.0), errors(0.25)
    smooth = [label != "L∞" for label in exact(60.0)]  # a sample may hit the peak by luck
    assert (coarse < 2e-3).all()
    assert (middle < 2e-4).all()
    assert (coarse[smooth] > 8 * middle[smooth]).all()
    assert (middle[smooth] > 8 * fine[smooth]).all()


def test_given_samples_do_not_matter():
    """The same line as two corners, and as 500 samples that do not lie at the refinement's."""
    few, many = past(7.0, "few"), past(7.0, "many", points=500)
    ranking = rank([few, many], to_point, InverseDistance(D0), NORMS)
    for label in ranking.labels:
        assert ranking["few"].norms[label] == pytest.approx(
            ranking["many"].norms[label], rel=1.5e-3
        )


def test_norms_that_need_equal_steps_get_them():
    norms = (Sobolev(1), Sobolev(1, form="fourier"), Sobolev(2))
    found = rank([past(20.0)], to_point, InverseDistance(D0), norms)["A"]
    assert found.norms["H1(Fourier)"] == pytest.approx(found.norms["H1"], rel=2e-3)
    assert found.norms["H2"] > found.norms["H1"]
    part = found.attribution["H2"]
    np.testing.assert_allclose(np.diff(part.t), part.t[1] - part.t[0], rtol=1e-9)


@pytest.mark.parametrize("phase", np.linspace(0.013, 1.987, 9))
def test_an_obstacle_thinner_than_the_step_is_not_jumped_over(phase):
    """A ball of 2 cm in the way of steps of 2 m."""
    trajectory = Trajectory.at_constant_speed([[-50 - phase, 0, 0], [50, 0, 0]], SPEED, "A")
    ranking = rank([trajectory], lambda p: to_point(p) - 0.01, InverseDistance(D0))
    found = ranking["A"]
    assert found.collides
    assert set(found.norms.values()) == {math.inf}
    assert found.attribution == dict.fromkeys(found.norms)
    assert found.collision_time == pytest.approx((50 + phase) / SPEED, abs=0.02 / SPEED)
    assert np.linalg.norm(found.collision_position) <= 0.01


def test_a_near_miss_is_finite():
    ranking = rank([past(0.1)], lambda p: to_point(p) - 0.05, InverseDistance(D0))
    assert not ranking["A"].collides
    assert ranking["A"].collision_time is None
    assert ranking["A"].collision_position is None
    assert ranking["A"].norms["L∞"] == pytest.approx(1 / 0.05 - 1 / D0, rel=0.02)


@pytest.mark.parametrize("end", [-0.001, -0.03, -1.0, -20.0])
def test_steps_are_as_short_as_promised(end):
    """Head on towards the obstacle, where the distance falls as fast as it can."""
    head_on = Trajectory.at_constant_speed([[-300, 0, 0], [end, 0, 0]], SPEED, "A")
    found = rank([head_on], to_point, InverseDistance(D0))["A"]
    steps, near = found.trajectory.steps, np.minimum(found.d[:-1], found.d[1:])
    allowed = np.where(near < D0, 0.1 * np.maximum(near, D0 / 1000), D0 / 50)
    crosses = (found.d[:-1] < D0) != (found.d[1:] < D0)
    allowed[crosses] = D0 / 1000
    assert (steps <= np.minimum(allowed, D0 / 50) * (1 + 1e-6)).all()
    assert crosses.sum() == 1
    assert steps.min() > D0 / 1000 / 50  # and not much shorter


def test_far_from_obstacles_steps_stay_long():
    far = rank([past(250.0, half=5000.0)], to_point, InverseDistance(D0))["A"]
    assert len(far.d) == 10_000 / 2 + 1
    assert set(far.norms.values()) == {0.0}


def test_no_step_takes_the_samples_as_they_are():
    trajectory = past(20.0, points=7)
    found = rank([trajectory], to_point, InverseDistance(D0), max_step=None)["A"]
    assert found.trajectory is trajectory
    d = to_point(trajectory.positions)
    np.testing.assert_array_equal(found.d, d)
    assert found.norms["H1"] == Sobolev(1)(trajectory.t, InverseDistance(D0)(d))


def test_arrays_are_read_only_and_the_clearance_keeps_its_own():
    kept = np.full(2, 50.0)
    found = rank([past(1.0)], lambda p: kept, InverseDistance(D0), max_step=None)["A"]
    kept[0] = 1.0
    np.testing.assert_array_equal(found.d, 50.0)
    for array in (found.d, found.f, found.attribution["L1"].shares):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_poses_are_passed_where_orientation_matters():
    class Rod:
        uses_orientation = True

        def __call__(self, poses):
            assert poses.shape[1] == 7
            assert poses.flags.c_contiguous
            return np.linalg.norm(poses[:, :3], axis=1) - np.abs(poses[:, 5])

    q = np.array([[0, 0, 0, 1], [0, 0, 1, 0]])
    trajectory = Trajectory([0, 1], [[-50, 9, 0], [50, 9, 0]], "A", orientations=q)
    found = rank([trajectory], Rod(), InverseDistance(D0))["A"]
    assert found.min_clearance == pytest.approx(9 - math.sqrt(0.5), rel=1e-2)


def test_a_clearance_that_returns_nonsense_is_refused():
    with pytest.raises(ArgumentError, match=r"clearance\(points\).shape = \(301, 1\).*\(301,\)"):
        rank([past(1.0)], lambda p: to_point(p)[:, None], InverseDistance(D0))
    with pytest.raises(ArgumentError, match=r"clearance\(points\).shape = \(\)"):
        rank([past(1.0)], lambda p: 3.0, InverseDistance(D0))
    with pytest.raises(ArgumentError, match=r"clearance at \(0, 1, 0\) m on 'A' = nan"):
        rank([past(1.0)], lambda p: np.where(p[:, 0] == 0, np.nan, 9), InverseDistance(D0))
    with pytest.raises(ArgumentError, match="array of real numbers"):
        rank([past(1.0)], lambda p: ["x"] * len(p), InverseDistance(D0))
