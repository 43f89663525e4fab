"""``RiskObjective.norm`` of control paths: their own times, states at the propagation step."""

import math

import numpy as np
import pytest
from controlled_paths import (
    AVOIDANCE,
    D0,
    FLAT,
    NORMS,
    drifted,
    drifting,
    hills,
    objective,
    path_of,
    pushed,
    setup,
    write_place,
)
from ompl import base as ob
from ompl import control as oc

from ompl_risk import (
    FlatCap,
    Lp,
    RiskObjective,
    Sobolev,
    TerrainClearance,
    Trajectory,
    helicopter,
    rank,
)
from ompl_risk.bridge.controls import to_path_control
from ompl_risk.errors import ArgumentError
from ompl_risk.terrains import Terrain


def climbed(low, high, seconds, norm):
    """The norm over flat ground, climbing steadily: integrals of f = 1/z - 1/d0 and f' = v/z^2."""
    v = (high - low) / seconds
    first = {
        1: lambda z: math.log(z) - z / D0,
        2: lambda z: z / D0**2 - 2 * math.log(z) / D0 - 1 / z,
    }
    integral = first[int(norm.exponent)]
    power = (integral(high) - integral(low)) / v
    if isinstance(norm, Sobolev):
        power += norm.time_scale**2 * v * (low**-3 - high**-3) / 3.0
    return power ** (1.0 / norm.exponent)


@pytest.mark.parametrize("norm", [Lp(1), Lp(2), Sobolev(1), Sobolev(1, time_scale=3.0)])
@pytest.mark.parametrize("seconds", [2.0, 20.0])
def test_a_steady_climb_has_the_norm_in_closed_form_at_its_own_speed(norm, seconds):
    path = drifted([50.0, 50.0, 10.0], [[0.0, 0.0, 30.0 / seconds]], [seconds])
    expected = climbed(10.0, 40.0, seconds, norm)
    assert objective(norm=norm).norm(path) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("norm", NORMS)
def test_hovering_takes_its_time(norm):
    path = drifted([50.0, 50.0, 20.0], [[0.0, 0.0, 0.0]], [8.0])
    f = 1.0 / 20.0 - 1.0 / D0
    expected = f if math.isinf(norm.exponent) else f * 8.0 ** (1.0 / norm.exponent)
    assert objective(norm=norm).norm(path) == pytest.approx(expected, rel=1e-9)


def accelerated(step, seed=5):
    """Pushed about over hills for 9.6 s: the path, and places every ``step`` by our own sums."""
    rng = np.random.default_rng(seed)
    place, velocity = np.array([30.0, 60.0, 62.0]), np.array([8.0, 2.0, -1.0])
    inputs, durations = rng.uniform(-3.0, 3.0, (5, 3)) * [1, 1, 0.4], [1.6, 2.4, 0.8, 3.2, 1.6]
    rows, fine = [np.append(place, velocity)], [place]
    for a, duration in zip(inputs, durations, strict=True):
        for t in np.arange(1, round(duration / step) + 1) * step:
            fine.append(place + t * (velocity + 0.5 * t * a))
        place = fine[-1]
        velocity = velocity + duration * a
        rows.append(np.append(place, velocity))

    def write(state, row):
        state[0][0:3], state[1][0:3] = row[:3].tolist(), row[3:].tolist()

    return path_of(pushed(step), rows, inputs, durations, write), np.array(fine)


def dense(fine, step, clearance, norm, parts=400):
    """The norm of straight pieces of equal duration, each sampled at so many places."""
    t = np.arange(len(fine)) * step
    times = np.linspace(0.0, t[-1], parts * (len(fine) - 1) + 1)
    places = np.column_stack([np.interp(times, t, column) for column in fine.T])
    return norm(times, AVOIDANCE(clearance(places)))


@pytest.mark.parametrize("norm", NORMS)
@pytest.mark.parametrize("step", [0.1, 0.8])
def test_the_norm_is_that_of_dense_samples(norm, step):
    clearance = hills()
    path, fine = accelerated(step)
    expected = dense(fine, step, clearance, norm)
    found = objective(clearance, norm, pushed(step)).norm(path)
    assert 0.0 < expected < math.inf
    assert found == pytest.approx(expected, rel=1e-3)


def test_compiled_and_sampled_clearances_agree():
    clearance = hills()
    path, _ = accelerated(0.1)

    def plain(points):
        return clearance(points)

    compiled = objective(clearance, si=pushed(0.1)).norm(path)
    assert 0.0 < compiled < math.inf
    assert objective(plain, si=pushed(0.1)).norm(path) == compiled


def test_neither_speed_nor_the_weight_of_time_counts():
    path = drifted([50.0, 50.0, 10.0], [[0.0, 0.0, 3.0]], [5.0])
    plain = objective().norm(path)
    assert objective(speed=30.0).norm(path) == plain
    assert objective(duration_weight=10.0).norm(path) == plain


def test_a_thin_obstacle_between_two_steps_is_hit():
    def wall(points):
        return np.abs(points[:, 0] - 50.01)

    path = drifted([20.0, 50.0, 30.0], [[25.0, 0.0, 0.0]], [2.0])
    assert objective(wall).norm(path) == math.inf
    short = drifted([20.0, 50.0, 30.0], [[14.0, 0.0, 0.0]], [2.0])
    assert objective(wall).norm(short) < math.inf


@pytest.mark.parametrize("duration", [1.3, 1.2, 0.2, 1.5])
def test_a_control_keeps_its_duration_where_steps_do_not_divide_it(duration):
    """OMPL alone would count three steps of 0.5 s for 1.3 s, and two for 1.2 s."""
    path = drifted([50.0, 50.0, 10.0], [[0.0, 0.0, 9.0], [0.0, 0.0, 9.0]], [duration, 1.0])
    top = 10.0 + 9.0 * (duration + 1.0)
    expected = climbed(10.0, top, duration + 1.0, Sobolev(1))
    assert objective().norm(path) == pytest.approx(expected, rel=1e-3)
    flown = Trajectory.from_path(path)
    assert flown.duration == pytest.approx(path.length(), rel=1e-12)
    assert flown.positions[:, 2] == pytest.approx(10.0 + 9.0 * flown.t)


def test_a_control_of_no_duration_adds_nothing():
    inputs = [[0.0, 0.0, 3.0], [9.0, 9.0, 9.0], [0.0, 0.0, 3.0]]
    path = drifted([50.0, 50.0, 10.0], inputs, [2.0, 0.0, 3.0])
    expected = climbed(10.0, 25.0, 5.0, Lp(2))
    assert objective(norm=Lp(2)).norm(path) == pytest.approx(expected, rel=1e-3)


def test_a_jump_in_no_time_must_be_free():
    rows = [[50.0, 50.0, 20.0], [50.0, 50.0, 20.0], [50.0, 50.0, -5.0], [50.0, 50.0, 20.0]]
    for below, expected in ((-5.0, math.inf), (15.0, (1 / 20 - 1 / D0) * math.sqrt(2.0))):
        rows[2][2] = below
        path = path_of(drifting(), rows, np.zeros((3, 3)), [2.0, 0.0, 0.0], write_place)
        assert objective(norm=Lp(2)).norm(path) == pytest.approx(expected)


def test_a_helicopter_path_has_the_norms_of_its_flight():
    terrain = Terrain(np.zeros((31, 61)), spacing=(10.0, 10.0))
    steering = helicopter.HelicopterSteering()
    ends = [((50.0, 150.0, 30.0), 0.0, 0.0), ((450.0, 200.0, 22.0), 0.5, 20.0)]
    flight = steering.flight(np.array([steering.vertex_at(*a, speed=v) for *a, v in ends]))
    si = helicopter.simple_setup(
        terrain, start=(50, 150, 30), goal=(450, 200, 30), step=flight.dt
    ).getSpaceInformation()
    si.setup()
    clearance = TerrainClearance(terrain, 5.0)
    ranking = rank([flight.trajectory("A")], clearance, AVOIDANCE, NORMS)
    path = to_path_control(si, flight)
    assert path.getStateCount() < len(flight.states)
    for norm in NORMS:
        found = RiskObjective(si, clearance, AVOIDANCE, norm, speed=30.0).norm(path)
        assert found == pytest.approx(ranking.assessments[0].norms[norm.label], rel=1e-3)


def test_a_single_state_takes_no_time():
    path = drifted([50.0, 50.0, 20.0], [], [])
    assert objective(norm=Lp(2)).norm(path) == 0.0
    assert objective(norm=Lp(math.inf)).norm(path) == pytest.approx(1.0 / 20.0 - 1.0 / D0)
    assert objective(norm=Lp(2)).norm(drifted([50.0, 50.0, -1.0], [], [])) == math.inf


def test_long_paths_are_taken_in_parts():
    """Steps of 1 s, more than are taken at a time, then many of 0.4 s that climb faster."""
    inputs = [[0.0, 0.0, 20.0 / 4200.0], *[[0.0, 0.0, 0.1]] * 250]
    path = drifted([50.0, 50.0, 10.0], inputs, [4200.0, *[0.4] * 250], step=1.0)
    parts = climbed(10.0, 30.0, 4200.0, Lp(2)), climbed(30.0, 40.0, 100.0, Lp(2))
    assert objective(norm=Lp(2)).norm(path) == pytest.approx(math.hypot(*parts), rel=1e-3)
    steeper = [climbed(10.0, 30.0, 4200.0, Sobolev(1)), climbed(30.0, 40.0, 100.0, Sobolev(1))]
    assert objective().norm(path) == pytest.approx(math.hypot(*steeper), rel=1e-3)
    assert objective(norm=Lp(math.inf)).norm(path) == pytest.approx(1.0 / 10.0 - 1.0 / D0)


def test_another_avoidance_function_counts():
    path = drifted([50.0, 50.0, 20.0], [[0.0, 0.0, 0.0]], [4.0])
    cap = FlatCap(80.0)
    made = RiskObjective(drifting(), FLAT, cap, Lp(1), speed=7.0)
    assert made.norm(path) == pytest.approx(4.0 * float(cap([20.0])[0]), rel=1e-9)


class Stick:
    """A stick along the body's x axis, one metre either way, beside a wall at x = 0."""

    uses_orientation, reach = True, 1.0

    def __call__(self, poses):
        _, y, z, _ = poses[:, 3:7].T
        along = 1.0 - 2.0 * (y * y + z * z)
        return poses[:, 0] - np.abs(along)


def test_attitude_counts_for_a_clearance_that_uses_it():
    """Turning about the vertical beside a wall: d = 10 - |cos(angle)|."""
    space = ob.SE3StateSpace()
    bounds = ob.RealVectorBounds(3)
    bounds.setLow(-100.0)
    bounds.setHigh(100.0)
    space.setBounds(bounds)

    def propagate(state, control, duration, result):
        angle = 2.0 * math.atan2(state.rotation().z, state.rotation().w) + control[0] * duration
        result.setXYZ(state.getX(), state.getY(), state.getZ())
        result.rotation().setAxisAngle(0.0, 0.0, 1.0, angle)

    def write(state, angle):
        state.setXYZ(10.0, 0.0, 0.0)
        state.rotation().setAxisAngle(0.0, 0.0, 1.0, angle)

    si = setup(space, 0.25, propagate)
    path = path_of(si, [0.2, 2.2], [[0.5, 0.0, 0.0]], [4.0], write)
    times = np.linspace(0.0, 4.0, 40_001)
    f = AVOIDANCE(10.0 - np.abs(np.cos(0.2 + 0.5 * times)))
    for norm in (Lp(1), Sobolev(1)):
        made = RiskObjective(si, Stick(), AVOIDANCE, norm, speed=7.0)
        assert made.norm(path) == pytest.approx(norm(times, f), rel=1e-3)
    straight = drifted([10.0, 0.0, 0.0], [[0.0, 1.0, 0.0]], [2.0])
    with pytest.raises(ArgumentError, match="states have none"):
        made.norm(straight)


def test_paths_that_cannot_be_read_are_named():
    made = objective()
    with pytest.raises(ArgumentError, match=r"path = 'str'.*og.PathGeometric or oc.PathControl"):
        made.norm("path")
    with pytest.raises(ArgumentError, match=r"'no states'.*at least one"):
        made.norm(oc.PathControl(drifting()))
    for dimension in (2, 4):
        si = drifting(dimension=dimension)
        rows, inputs = np.zeros((2, dimension)), [[0.0, 0.0, 0.0]]

        def write(state, row):
            state[0 : len(row)] = row.tolist()

        path = path_of(si, rows, inputs, [1.0], write)
        with pytest.raises(ArgumentError, match=rf"R\^{dimension}.*R\^3, SE\(3\), or a compound"):
            made.norm(path)
    plane = ob.SE2StateSpace()
    bounds = ob.RealVectorBounds(2)
    bounds.setLow(-1.0)
    bounds.setHigh(1.0)
    plane.setBounds(bounds)
    si = setup(plane, 0.5, lambda state, control, duration, result: None)
    path = oc.PathControl(si)
    path.append(si.allocState())
    with pytest.raises(ArgumentError, match=r"SE2State.*R\^3, SE\(3\), or a compound"):
        made.norm(path)


def test_controls_that_do_not_fit_are_named():
    si = drifting()
    path = oc.PathControl(si)
    for _ in range(2):
        state = si.allocState()
        state[0:3] = [50.0, 50.0, 20.0]
        path.append(state)
    with pytest.raises(ArgumentError, match=r"2 states and 0 controls.*one state more"):
        objective().norm(path)
    for seconds in (-1.0, math.inf, math.nan):
        wrong = drifted([50.0, 50.0, 10.0], [[1.0, 1.0, 3.0]], [seconds])
        with pytest.raises(ArgumentError, match=rf"held for {seconds:g} s.*0 s or more"):
            objective().norm(wrong)
