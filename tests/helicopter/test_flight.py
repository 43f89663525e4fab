"""From planned routes to flights that replay."""

import math
import pickle

import numpy as np
import pytest
from flown_routes import Writer, apart, random_route
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from ompl_risk._kernels import rigid_body
from ompl_risk._kernels.pieces import DURATION, HEADING, X
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.flight_limits import broken_in_changes, broken_in_controls
from ompl_risk.helicopter.flying import fly
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.planned_route import planned_route
from ompl_risk.helicopter.steering import HelicopterSteering

LIBRARY = default_library()
START = (500.0, -300.0, 120.0, 0.7, 2.0)  # at 20 m/s
LEVEL, FAST, HOVER = (20.0,), (30.0,), (0.0,)


@pytest.fixture(scope="module")
def steering():
    return HelicopterSteering(LIBRARY)


@pytest.fixture(scope="module")
def long_flights(steering):
    found = []
    for seed, speeds in enumerate([(2, 3), (1, 2, 3), (0, 1, 2, 3)]):
        route = random_route(steering, np.random.default_rng(seed), 15_000.0, speeds)
        found.append((route, fly(LIBRARY, *route)))
    return found


def short_route():
    turn = (20.0, 0.0, float(LIBRARY.turns[2, 2]))
    writer = Writer(LIBRARY, START)
    writer.hold(3.333, 20.0).change(LEVEL, turn).hold(2.345, *turn).change(turn, LEVEL)
    return writer.hold(7.777, 20.0)


def test_fifteen_kilometres_stay_beside_the_plan(long_flights):
    for _, flight in long_flights:
        assert flight.length > 14_000.0
        assert flight.deviation.distance < 0.5
        assert flight.deviation.degrees < 1.0
        assert abs(flight.delay) < 0.1
        beside = apart(flight.states, flight.planned)
        assert_allclose(flight.deviations, beside, atol=2e-8)  # what an arc cosine has of digits
        assert_allclose(flight.deviation.distance, beside[:, 0].max(), rtol=1e-9)


def test_a_flight_replays_to_the_last_bit(long_flights):
    for _, flight in long_flights:
        again = np.empty_like(flight.states)
        rigid_body.rollout(
            flight.states[0], flight.controls, LIBRARY.dt, LIBRARY.helicopter.given, again
        )
        assert (again == flight.states).all()
        assert (flight.replay() == flight.states).all()


def test_flights_are_within_the_limits(long_flights):
    for _, flight in long_flights:
        flight.check_limits(LIBRARY.limits)
        model = (LIBRARY.limits, LIBRARY.helicopter, flight.controls)
        assert broken_in_controls(*model) is None
        assert broken_in_changes(*model, flight.dt) is None


def test_planned_is_the_route_at_the_planned_times(long_flights):
    for (start, pieces), flight in long_flights:
        route = planned_route(LIBRARY, start, pieces)
        assert (route.at(flight.planned_times) == flight.planned).all()
        steps = np.diff(flight.planned_times)
        assert (steps > 0.0).all()
        assert abs(flight.planned_times[-1] - pieces[:, DURATION].sum()) < 6.1
        assert (flight.states[0] == flight.planned[0]).all()


def test_another_helicopter_flies_elsewhere(long_flights):
    _, flight = long_flights[0]
    heavier = flight.replay(Helicopter(8.3))
    assert (heavier[0] == flight.states[0]).all()
    assert np.linalg.norm(heavier[-1, :3] - flight.states[-1, :3]) > 100.0


def test_a_straight_after_a_turn_ends_exactly_where_planned():
    writer = short_route()
    flight = fly(LIBRARY, writer.start, writer.pieces)
    assert 0.01 < flight.deviation.distance < 0.5  # whole steps do not fit the turn
    assert flight.at_goal.distance < 1e-9
    assert flight.at_goal.angle < 1e-9
    last = writer.pieces[-1]
    far = complex(*last[X : X + 2]) + 20.0 * 7.777 * np.exp(1j * last[HEADING])
    assert_allclose(flight.states[-1, :3], [far.real, far.imag, 120.0], atol=1e-9)
    assert abs(flight.duration - writer.pieces[:, DURATION].sum()) < 0.0101


def test_an_hour_of_straight_flight_stays_on_its_line():
    writer = Writer(LIBRARY, START).hold(3600.003, 20.0)
    flight = fly(LIBRARY, writer.start, writer.pieces)
    assert flight.deviation.distance < 0.11
    along = np.exp(1j * START[3])
    place = (flight.states[:, 0] - START[0] + 1j * (flight.states[:, 1] - START[1])) / along
    assert np.abs(place.imag).max() < 1e-3
    assert np.abs(flight.states[:, 2] - START[2]).max() < 1e-3
    assert flight.at_goal.distance < 1e-8


def test_pieces_of_one_trim_are_one():
    whole = Writer(LIBRARY, START).hold(9.009, 20.0)
    parts = Writer(LIBRARY, START).hold(3.003, 20.0).hold(3.003, 20.0).hold(3.003, 20.0)
    flights = [fly(LIBRARY, w.start, w.pieces) for w in (whole, parts)]
    assert_allclose(flights[0].states, flights[1].states, atol=1e-9)
    assert len(planned_route(LIBRARY, parts.start, parts.pieces).legs) == 1


def hover_route():
    turn = (20.0, 0.0, float(LIBRARY.turns[2, 3]))
    writer = Writer(LIBRARY, START).change(LEVEL, turn).hold(0.99, *turn).change(turn, LEVEL)
    return writer.change(LEVEL, HOVER)


def test_a_hover_goal_is_settled_in_a_last_hover():
    writer = hover_route()
    beside = fly(LIBRARY, writer.start, writer.pieces, hover=0.0)
    settled = fly(LIBRARY, writer.start, writer.pieces)
    assert beside.at_goal.distance > 1e-3
    assert settled.at_goal.distance < 1e-9
    assert settled.at_goal.angle < 1e-9
    assert_allclose(settled.duration - beside.duration, 6.0, atol=0.021)
    assert np.abs(settled.states[-1, 7:]).max() < 1e-9
    assert settled.deviation.degrees < 1.0


def test_no_hover_is_added_where_nothing_remains():
    writer = Writer(LIBRARY, START).hold(8.0, 20.0).change(LEVEL, HOVER)
    flight = fly(LIBRARY, writer.start, writer.pieces)
    assert_allclose(flight.duration, writer.pieces[:, DURATION].sum(), atol=1e-9)
    assert flight.at_goal.distance < 1e-6


def test_manoeuvres_without_a_trim_between_them_keep_the_limits():
    one, two = (20.0, 0.0, float(LIBRARY.turns[2, 3])), (20.0, 0.0, float(LIBRARY.turns[2, 0]))
    writer = Writer(LIBRARY, START).hold(2.0, 20.0)
    writer.change(LEVEL, one).change(one, LEVEL).change(LEVEL, two).change(two, LEVEL)
    flight = fly(LIBRARY, writer.start, writer.hold(9.0, 20.0).pieces)
    assert broken_in_changes(LIBRARY.limits, LIBRARY.helicopter, flight.controls, flight.dt) is None
    assert flight.deviation.degrees < 1.0
    assert flight.at_goal.distance < 1e-9


@pytest.fixture(scope="module")
def flight():
    writer = short_route()
    return fly(LIBRARY, writer.start, writer.pieces)


def test_a_trajectory_has_attitudes_velocities_and_held_inputs(flight):
    trajectory = flight.trajectory("A")
    assert trajectory.name == "A"
    assert_allclose(trajectory.t, np.arange(len(flight) + 1) * 0.02)
    assert (trajectory.positions == flight.states[:, :3]).all()
    assert_allclose(trajectory.orientations, flight.states[:, 3:7])
    assert (trajectory.controls == flight.controls).all()
    body = Rotation.from_quat(flight.states[:, 3:7])
    assert_allclose(trajectory.velocities, body.apply(flight.states[:, 7:10].copy()), atol=1e-12)
    middle = 0.5 * (trajectory.velocities[1:] + trajectory.velocities[:-1])
    assert_allclose(np.diff(trajectory.positions, axis=0) / 0.02, middle, atol=0.01)


def test_a_trajectory_of_fewer_samples_keeps_the_ends(flight):
    trajectory = flight.trajectory(step=0.5)
    assert_allclose(np.diff(trajectory.t)[:-1], 0.5)
    assert trajectory.duration == pytest.approx(flight.duration)
    assert (trajectory.positions[3] == flight.states[75, :3]).all()
    assert (trajectory.controls[3] == flight.controls[75]).all()
    assert (trajectory.positions[-1] == flight.states[-1, :3]).all()
    assert len(trajectory.controls) == len(trajectory)


@pytest.mark.parametrize("step", [0.03, 0.01, -0.02, math.nan])
def test_a_step_must_be_whole(flight, step):
    with pytest.raises(ArgumentError, match="step"):
        flight.trajectory(step=step)


def test_a_flight_survives_pickling(flight):
    again = pickle.loads(pickle.dumps(flight))
    for name in ("states", "controls", "planned", "planned_times", "goal"):
        assert (getattr(again, name) == getattr(flight, name)).all()
        assert not getattr(again, name).flags.writeable
    assert again.helicopter == flight.helicopter


def hovering(count=2, **changed):
    """A flight that hovers, and what is changed in its arrays: name=(row, column, value)."""
    machine = Helicopter()
    fields = {
        "controls": np.tile([machine.weight, 0.0, 0.0, 0.0], (count, 1)),
        "states": np.tile(np.eye(13)[6], (count + 1, 1)),
    }
    for name, (row, column, value) in changed.items():
        fields[name][row, column] = value
    return Flight(
        0.02, fields["states"], fields["controls"], np.tile(np.eye(13)[6], (count + 1, 1))
    )


def test_a_flight_within_the_limits_passes():
    hovering().check_limits(Limits())


@pytest.mark.parametrize(
    ("changed", "name"),
    [
        ({"controls": (1, 0, 200.0)}, r"controls\[1\] = 200.*collective"),
        ({"controls": (0, 3, -0.1)}, r"changes of controls\[0\].*rotor roll"),
        ({"states": (2, 8, 40.0)}, r"states\[2\] = 40.*speed"),
        ({"states": (1, 11, -2.5)}, r"states\[1\] = 2.5.*angular velocity"),
        ({"states": (1, 3, 0.8)}, r"states\[1\].*attitude"),
    ],
)
def test_what_breaks_a_limit_is_named(changed, name):
    with pytest.raises(ArgumentError, match=name):
        hovering(**changed).check_limits(Limits())


def test_deviation_is_the_greatest_of_each():
    flight = hovering(3, states=(2, 0, 3.0))
    turned = flight.states.copy()
    turned[1, 3:7] = Rotation.from_euler("z", 0.2).as_quat()
    found = Flight(0.02, turned, flight.controls, flight.planned, goal=np.eye(13)[6]).deviation
    assert found.distance == pytest.approx(3.0)
    assert found.angle == pytest.approx(0.2)
    assert found.degrees == pytest.approx(math.degrees(0.2))


def test_delay_is_the_worst_of_either_sign():
    flight = hovering()
    times = [0.0, 0.07, 0.03]
    late = Flight(0.02, flight.states, flight.controls, flight.planned, planned_times=times)
    assert late.delay == pytest.approx(-0.05)
    assert flight.delay == 0.0


@pytest.mark.parametrize(
    ("place", "value", "name"),
    [
        (0, 0.0, "dt"),
        (1, np.zeros((3, 12)), r"states\.shape"),
        (2, np.zeros((0, 4)), r"controls\.shape"),
        (3, np.zeros((2, 13)), r"planned\.shape"),
        (2, np.full((2, 4), np.inf), r"controls\[0, 0\]"),
    ],
)
def test_arrays_of_a_flight_must_fit(place, value, name):
    fields = [0.02, np.zeros((3, 13)), np.zeros((2, 4)), np.zeros((3, 13))]
    fields[place] = value
    with pytest.raises(ArgumentError, match=name):
        Flight(*fields)


def test_numbers_in_a_flight_cannot_be_changed(flight):
    for name in ("states", "controls", "planned", "t", "deviations"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(flight, name)[0] = 1.0
