import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

casadi = pytest.importorskip("casadi", reason="the extra primitives")

from ompl_risk._kernels import rigid_body  # noqa: E402
from ompl_risk.errors import ArgumentError  # noqa: E402
from ompl_risk.helicopter.library import default_library  # noqa: E402
from ompl_risk.helicopter.optimal_control import dynamics  # noqa: E402
from ompl_risk.helicopter.optimal_control.course import guess, resampled  # noqa: E402
from ompl_risk.helicopter.optimal_control.making import _fault, make  # noqa: E402
from ompl_risk.helicopter.optimal_control.refining import end_error, refined, replayed  # noqa: E402
from ompl_risk.helicopter.optimal_control.shooting import Shooting  # noqa: E402
from ompl_risk.helicopter.optimal_control.task import PLANE, Task  # noqa: E402
from ompl_risk.helicopter.optimal_control.vehicle import Vehicle  # noqa: E402
from ompl_risk.helicopter.parameters import Helicopter, Limits  # noqa: E402
from ompl_risk.helicopter.primitives import replay  # noqa: E402
from ompl_risk.helicopter.trims import solve_trim  # noqa: E402

VEHICLE = Vehicle()
G = 9.81


def task(first, last, helicopter=VEHICLE.helicopter):
    return Task(*(solve_trim(helicopter, *key) for key in (first, last)))


HARD = (10.0, 0.0, G * math.tan(math.radians(40.0)) / 10.0)
LEVEL, FASTER, RISING = (10.0, 0.0, 0.0), (20.0, 0.0, 0.0), (10.0, 2.0, 0.0)


def shipped_manoeuvre(first, last):
    library = default_library()
    return library.manoeuvre(library.trim(*first), library.trim(*last))


# the model


@pytest.mark.parametrize(
    "helicopter",
    [
        Helicopter(),
        Helicopter(5.0, inertia=(0.1, 0.2, 0.25), drag=(0.3, 0.7, 0.2), wind=(4.0, -3.0, 1.0)),
    ],
)
def test_step_is_that_of_the_compiled_model(helicopter):
    x, u, h = casadi.SX.sym("x", 13), casadi.SX.sym("u", 4), casadi.SX.sym("h")
    step = casadi.Function("step", [x, u, h], [dynamics.step(x, u, h, helicopter)])
    rng = np.random.default_rng(1)
    for _ in range(50):
        state = rng.normal(size=13) * ([10.0] * 3 + [1.0] * 4 + [15.0] * 3 + [2.0] * 3)
        state[3:7] /= np.linalg.norm(state[3:7])
        control = rng.uniform([0.0, -6.0, -0.2, -0.2], [160.0, 6.0, 0.2, 0.2])
        dt, out = rng.uniform(0.001, 0.1), np.empty(13)
        rigid_body.propagate(state, control, dt, helicopter.given, out)
        found = np.array(step(state, control, dt)).ravel()
        np.testing.assert_allclose(found, out, rtol=1e-13, atol=1e-13)


def test_a_quaternion_of_another_norm_is_the_same_rotation():
    q = np.array([0.3, -0.2, 0.6, 0.9])
    R = np.array(casadi.DM(dynamics.rotation([0.0, 0.0, 0.0, *q])))
    np.testing.assert_allclose(R, Rotation.from_quat(q).as_matrix(), atol=1e-15)


def test_flight_in_the_plane_is_the_flight_in_space_without_the_rest():
    rng = np.random.default_rng(2)
    x, u = rng.normal(size=7), rng.normal(size=2)
    state, control = np.array(PLANE.whole_state(x)), np.array(PLANE.whole_control(u))
    out = np.empty(13)
    rigid_body.propagate(state, control, 0.02, VEHICLE.helicopter.given, out)
    rest = [i for i in range(13) if i not in PLANE.states]
    assert not out[rest].any()
    np.testing.assert_array_equal(state[list(PLANE.states)], x)
    np.testing.assert_array_equal(control, [u[0], 0.0, u[1], 0.0])


# least time


def least_time(steps, change, share):
    """Time in which the collective alone changes the climb rate in so many steps, solved for h.

    It may add a share of the weight, and four times that share in a second.
    """

    def lacking(h):
        k = np.arange(1, steps + 1)
        lift = share * np.minimum(1.0, 4.0 * h * np.minimum(k, steps + 1 - k))
        return G * h * lift.sum() - change

    return steps * brentq(lacking, 1e-4, 1.0, xtol=1e-14)


@pytest.mark.parametrize(
    ("climb", "steps", "reserve"),
    [(2.0, 10, 0.1), (2.0, 31, 0.1), (6.0, 50, 0.1), (2.0, 31, 0.0), (6.0, 50, 0.3)],
)
def test_least_time_of_a_climb_is_that_of_the_closed_form(climb, steps, reserve):
    job = task(LEVEL, (10.0, climb, 0.0))
    found = Shooting(job, Vehicle(reserve=reserve), steps).solve(guess(job, steps, G))
    assert found.solved
    # 1e-6 of each limit is kept back, and smoothness has a price
    wanted = least_time(steps, climb, 1.0 - reserve)
    assert found.course.duration == pytest.approx(wanted, rel=2e-5)


@pytest.mark.parametrize(("first", "last"), [(LEVEL, FASTER), (LEVEL, HARD)])
def test_one_step_less_than_the_shipped_manoeuvre_is_too_few(first, last):
    shipped = shipped_manoeuvre(first, last)
    job, n = task(first, last), len(shipped.controls) - 1
    free = Shooting(job, VEHICLE, n).solve(resampled_from(shipped, n))
    assert free.solved
    assert free.course.step > VEHICLE.dt


@pytest.mark.parametrize("seed", [3, 4])
def test_least_time_does_not_depend_on_the_first_guess(seed):
    job, rng = task(LEVEL, HARD), np.random.default_rng(seed)
    shooting, start = Shooting(job, VEHICLE, 25), guess(job, 25, G)
    wave = np.sin(np.linspace(0.0, 2.0 * math.pi, 25))[:, None]
    other = start._replace(
        step=start.step * rng.uniform(0.5, 2.0),
        controls=start.controls + 0.3 * wave * rng.normal(size=4) * VEHICLE.ranges,
    )
    durations = [shooting.solve(course).course.duration for course in (start, other)]
    assert durations[0] == pytest.approx(durations[1], rel=1e-5)


def resampled_from(manoeuvre, steps):
    job = Task(manoeuvre.first, manoeuvre.last)
    course = guess(job, len(manoeuvre.controls), G)
    course = course._replace(
        step=manoeuvre.dt, controls=manoeuvre.controls, states=manoeuvre.states
    )
    return resampled(course, steps)


def test_resampling_keeps_the_duration_and_the_ends():
    job = task(LEVEL, FASTER)
    course = guess(job, 40, G)
    finer = resampled(course, 80)
    assert finer.duration == pytest.approx(course.duration, rel=1e-14)
    np.testing.assert_allclose(finer.states[::2], course.states, atol=1e-12)
    np.testing.assert_array_equal(finer.states[-1, 3:], job.last.state()[3:])


# the whole way


@pytest.mark.parametrize(("first", "last"), [(LEVEL, FASTER), (HARD, LEVEL), (RISING, LEVEL)])
def test_what_is_made_is_what_is_shipped(first, last):
    made, shipped = make(task(first, last), VEHICLE), shipped_manoeuvre(first, last)
    assert made.controls.shape == shipped.controls.shape
    change = np.abs(made.controls - shipped.controls) / VEHICLE.ranges
    assert change.max() < 1e-4
    assert shipped.duration - VEHICLE.dt < made.least <= shipped.duration
    assert made.error <= 1e-12


def test_helicopter_with_drag_of_its_own():
    helicopter = Helicopter(10.0, inertia=(0.2, 0.5, 0.4), drag=(0.4, 0.8, 0.8))
    vehicle = Vehicle(helicopter, Limits(speed=20.0, tilt=0.15))
    for first, last in (((0.0, 0.0, 0.0), (8.0, 0.0, 0.0)), ((8.0, 0.0, 0.0), (8.0, 0.0, 0.5))):
        job = task(first, last, helicopter)
        made = make(job, vehicle)
        flown = replay(helicopter, job.first, job.last, made.controls)
        assert flown.miss <= 1e-10
        assert abs(flown.displacement[2]) <= 1e-10
        assert flown.broken_limit(helicopter, vehicle.kept) is None
        assert np.abs(made.controls[:, 2:]).max() <= 0.9 * 0.15


def test_limits_less_the_reserve_bind_in_the_least_time():
    """A hard turn is entered as fast as the body may roll."""
    shipped = shipped_manoeuvre(LEVEL, HARD)
    assert np.abs(shipped.states[:, 10]).max() == pytest.approx(0.9 * 2.0, rel=1e-5)


@pytest.mark.parametrize("reserve", [0.0, 0.3])
def test_reserve_is_what_a_manoeuvre_leaves_of_the_limits(reserve):
    vehicle, job = Vehicle(reserve=reserve), task(LEVEL, RISING)
    made = make(job, vehicle)
    inputs = np.concatenate([[job.first.control], made.controls, [job.last.control]])
    fastest = np.abs(np.diff(inputs[:, 0])).max() / vehicle.dt / vehicle.helicopter.weight
    assert fastest == pytest.approx((1.0 - reserve) * 4.0, rel=1e-3)
    assert fastest <= (1.0 - reserve) * 4.0


def test_corrections_that_use_the_reserve_are_a_fault():
    """The last digits may not cost what is kept for the flight."""
    job, shipped = task(LEVEL, HARD), shipped_manoeuvre(LEVEL, HARD)
    course = replayed(job, shipped.controls, VEHICLE)
    assert _fault(job, VEHICLE, course) == ""
    states = course.states.copy()
    states[5, 10] = 1.9  # of 2.0, with 0.2 in reserve
    assert _fault(job, VEHICLE, course._replace(states=states)) == (
        "angular velocity 1.9, not 0 to 1.8 rad/s"
    )


@pytest.mark.parametrize("reserve", [-0.01, 1.0, math.nan, math.inf, "much", True, None])
def test_reserve_out_of_range(reserve):
    with pytest.raises(ArgumentError, match="0 or more and below 1") as caught:
        Vehicle(reserve=reserve)
    assert caught.value.argument == "reserve"


def test_kept_limits_are_those_without_the_reserve():
    vehicle = Vehicle(limits=Limits(rate=1.0), reserve=0.25)
    assert vehicle.kept == Limits(rate=1.0).scaled(0.75)
    assert vehicle.kept.rate == 0.75
    assert Vehicle().reserve == 0.1


def test_height_of_a_level_manoeuvre_is_kept_to():
    vehicle = Vehicle(height=0.02)
    free, kept = make(task(LEVEL, FASTER), VEHICLE), make(task(LEVEL, FASTER), vehicle)
    heights = [
        np.abs(replay(vehicle.helicopter, *ends(LEVEL, FASTER), made.controls).states[:, 2]).max()
        for made in (free, kept)
    ]
    assert heights[0] > 0.1
    assert heights[1] <= 0.02 + 1e-9
    assert len(kept.controls) >= len(free.controls)


def ends(first, last):
    job = task(first, last)
    return job.first, job.last


def test_trims_that_cannot_be_joined_are_named():
    problem = r"'10 m/s to 20 m/s': .* within the limits less the reserve and 10 s"
    stiff = Vehicle(limits=Limits(tilt=1e-5))  # nothing that could tilt the helicopter
    with pytest.raises(ArgumentError, match=problem):
        make(task(LEVEL, FASTER), stiff)


# the last digits


@pytest.mark.parametrize(("first", "last"), [(LEVEL, FASTER), (LEVEL, HARD), (HARD, LEVEL)])
def test_disturbed_inputs_are_corrected_to_rounding(first, last):
    job, shipped = task(first, last), shipped_manoeuvre(first, last)
    noise = np.zeros_like(shipped.controls)
    places = list(job.motion.controls)
    rng = np.random.default_rng(5)
    noise[:, places] = 1e-6 * rng.normal(size=(len(noise), len(places))) * VEHICLE.ranges[places]
    course = refined(job, shipped.controls + noise, VEHICLE)
    assert np.abs(end_error(job, course.states[-1])).max() < 1e-12
    correction = (course.controls - shipped.controls - noise) / VEHICLE.ranges
    # the least correction is not greater than the noise, which would correct it too
    assert np.linalg.norm(correction) <= np.linalg.norm(noise / VEHICLE.ranges) * (1.0 + 1e-6)


def test_error_of_the_end_is_that_of_attitude_velocity_rates_and_height():
    job = task(LEVEL, HARD)
    end = job.last.state((5.0, 4.0, 0.0), heading=0.7)
    np.testing.assert_allclose(end_error(job, end), 0.0, atol=1e-15)
    for place in (2, *range(7, 13)):
        wrong = end.copy()
        wrong[place] += 1e-3
        assert np.abs(end_error(job, wrong)).max() == pytest.approx(1e-3)
    tilted = end.copy()
    spin = Rotation.from_rotvec([0.002, 0.0, 0.0]) * Rotation.from_quat(end[3:7])
    tilted[3:7] = spin.as_quat()
    assert np.linalg.norm(end_error(job, tilted)[:2]) == pytest.approx(math.sin(0.001))
    straight = task(LEVEL, FASTER)
    turned = straight.last.state(heading=0.02)  # there the heading counts
    assert np.abs(end_error(straight, turned)).max() == pytest.approx(math.sin(0.01))
