"""The earliest arrival among moving obstacles: closed forms, certainty, wrong use."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moving_balls import Balls

from ompl_risk.clearance.moving.clearance import MovingClearance
from ompl_risk.clearance.moving.obstacles import MovingBox, MovingSphere
from ompl_risk.clearance.terrain import TerrainClearance
from ompl_risk.planners.spacetime.earliest import RESOLUTION, earliest_arrival
from ompl_risk.planners.spacetime.network import Network
from ompl_risk.planners.spacetime.route import Wait
from ompl_risk.terrains import Terrain

FAR = Balls(([1e6, 0, 0], [0, 0, 0], 1.0))
LINE = Network([[0, 0, 0], [5, 0, 0], [10, 0, 0]], [[0, 1], [1, 2]])


def moving(*balls, until=200.0, **options):
    """The library's clearance of the same balls."""
    spheres = [
        MovingSphere(r, [0.0, until], [c, np.add(c, np.multiply(v, until))]) for c, v, r in balls
    ]
    return MovingClearance(spheres, **options)


def dense(route, clearance, n=20_001):
    """Least d(q, t) along a route, by brute force."""
    times = np.linspace(route.depart, route.arrival, n)
    points = np.column_stack([np.interp(times, route.times, x) for x in route.positions.T])
    return clearance(points, times).min()


def check_flown(route, speed):
    """Every leg is a wait or flown at the speed."""
    assert (np.diff(route.times) > 0.0).all()
    way = np.linalg.norm(np.diff(route.positions, axis=0), axis=1)
    flown = way > 0.0
    assert np.diff(route.times)[flown] == pytest.approx(way[flown] / speed, rel=1e-9)
    assert not (~flown[1:] & ~flown[:-1]).any()  # two waits in a row would be one


CROSSING = ([5.0, -4.0, 0.0], [0.0, 1.0, 0.0], 1.0)
"""At x = 5, on the line at t = 4."""


@pytest.mark.parametrize("clearance", [Balls(CROSSING), moving(CROSSING)])
def test_waits_for_a_ball_that_crosses_the_way(clearance):
    # Leaving d later, the distance to the ball's centre is at least (1 + d) / sqrt(2).
    late = math.sqrt(2.0) - 1.0
    found = earliest_arrival(LINE, clearance, 0, 2, speed=1.0, horizon=50.0)
    assert late < found.route.arrival - 10.0 < late + 3 * RESOLUTION
    assert found.route.waits == (Wait((0.0, 0.0, 0.0), 0.0, found.route.times[1]),)
    assert found.route.waited == pytest.approx(found.route.arrival - 10.0)
    assert 0.0 < found.route.least_clearance(clearance) < 3e-3
    assert dense(found.route, clearance) > 0.0


def door(rise=5.0, opens=20.0, bottom=-30.0):
    """A wall of x from 45 to 55 that rises from a time on, and stays up."""
    t = [0.0, opens, opens + 20.0, opens + 100.0]
    z = [bottom + 100.0, bottom + 100.0, bottom + 100.0 + 20.0 * rise]
    return MovingBox([10, 500, 200], t, [[50, 0, at] for at in (*z, z[-1])])


CORRIDOR = Network([[0, 0, 0], [40, 0, 0], [80, 0, 0]], [[0, 1], [1, 2]])


def leaves_first(speed=10.0, rise=5.0, opens=20.0, bottom=-30.0, radius=1.0):
    """When a ball may leave x = 40: in the door's frame it passes below the edge at x = 45.

    Its way there has the direction (speed, -rise), the edge is 5 m ahead and z above; the edge is
    ``(5 rise + z speed) / |direction|`` beside the way, which must be the radius.
    """
    z = (radius * math.hypot(speed, rise) - 5.0 * rise) / speed
    return opens + (z - bottom) / rise


def test_waits_for_a_door_until_it_can_just_pass_below_its_edge():
    clearance = MovingClearance(door(), radius=1.0)
    found = earliest_arrival(CORRIDOR, clearance, 0, 2, speed=10.0, horizon=100.0)
    assert leaves_first() < found.route.arrival - 4.0 < leaves_first() + 3 * RESOLUTION
    assert found.route.positions[:, 0].tolist() == [0.0, 40.0, 40.0, 80.0]
    assert dense(found.route, clearance) > 0.0
    assert 0.0 < found.route.least_clearance(clearance) < 0.01


def test_without_waiting_it_flies_to_and_fro_and_arrives_later():
    clearance = MovingClearance(door(), radius=1.0)
    options = {"speed": 10.0, "horizon": 100.0, "can_wait": False}
    found = earliest_arrival(CORRIDOR, clearance, 0, 2, **options)
    # It is at x = 40 at 4, 12, 20, 28, ... s: the first of these after the door lets it pass.
    there = next(4.0 + 8.0 * k for k in itertools.count() if 4.0 + 8.0 * k > leaves_first())
    assert found.route.arrival == pytest.approx(there + 4.0, abs=1e-9)
    assert found.route.waits == ()
    assert dense(found.route, clearance) > 0.0
    check_flown(found.route, 10.0)
    options["horizon"] = there + 3.9
    late = earliest_arrival(CORRIDOR, clearance, 0, 2, **options)
    assert late.route is None
    assert "arrives by t = 31.9" in late.reason


def test_a_ball_that_sweeps_the_corridor_is_let_past_in_a_niche():
    sweeping = ([60.0, 0.0, 0.0], [-2.0, 0.0, 0.0], 3.0)
    places = [[0, 0, 0], [10, 0, 0], [20, 0, 0], [30, 0, 0], [10, 8, 0]]
    corridor = [[0, 1], [1, 2], [2, 3]]
    with_niche = Network(places, [*corridor, [1, 4]])
    options = {"speed": 1.0, "horizon": 200.0}
    for clearance in (Balls(sweeping), moving(sweeping, radius=0.0)):
        found = earliest_arrival(with_niche, clearance, 0, 3, **options)
        assert [wait.place[1] for wait in found.route.waits] == [8.0]
        assert dense(found.route, clearance) > 0.0
        check_flown(found.route, 1.0)
        none = earliest_arrival(Network(places, corridor), clearance, 0, 3, **options)
        assert none.route is None
    # From the niche it goes back as soon as the ball lets it: on its way down to (10, 0) it must
    # keep 3 m from a centre that moves at 2 m/s: |along the normal of the relative motion| = 3.
    # With the ball at x when it leaves: (10 - x) * 1 / sqrt 5 + 8 * 2 / sqrt 5 = 3.
    x = 10.0 + 16.0 - 3.0 * math.sqrt(5.0)
    leaves = (60.0 - x) / 2.0
    assert found.route.arrival == pytest.approx(leaves + 8.0 + 20.0, abs=5 * RESOLUTION)
    assert found.route.arrival > leaves + 28.0


def test_a_tiny_ball_at_a_kilometre_a_second_is_not_jumped_over():
    # It crosses x = 5 at t = 5, just when the vehicle would be there.
    u, r = 1000.0, 0.01
    late = r * math.hypot(1.0, u) / u
    ball = ([5.0, -5.0 * u, 0.0], [0.0, u, 0.0], r)
    for clearance, margin in ((Balls(ball), 0.0), (moving(ball, until=10.0), 1e-3)):
        found = earliest_arrival(LINE, clearance, 0, 2, speed=1.0, horizon=50.0)
        assert late < found.route.arrival - 10.0 < late + margin + 2 * RESOLUTION


@pytest.mark.parametrize("depart", [3.0, -7.0])
def test_a_free_way_is_flown_at_once(depart):
    found = earliest_arrival(LINE, FAR, 0, 2, speed=2.0, horizon=50.0, depart=depart)
    assert found.found
    assert found.route.times.tolist() == [depart, depart + 2.5, depart + 5.0]
    assert found.route.waits == ()
    assert found.route.duration == 5.0
    assert found.route.trajectory("A").name == "A"
    with pytest.raises(ValueError, match="read-only"):
        found.route.times[0] = 0.0


def test_the_nearest_of_several_goals():
    found = earliest_arrival(LINE, FAR, 1, [0, 2], speed=1.0, horizon=50.0)
    assert found.route.arrival == 5.0


def test_what_stands_still_is_flown_round_not_waited_for():
    y, x = np.mgrid[0:21, 0:21] * 5.0
    terrain = Terrain(40.0 * np.exp(-(((x - 50) / 10) ** 2 + ((y - 50) / 25) ** 2)), spacing=(5, 5))
    static = TerrainClearance(terrain, 1.0)
    clearance = MovingClearance(
        MovingSphere(1.0, [0, 1], [[0, 0, 500]] * 2), static=static, radius=1.0
    )
    places = [[10, 50, 10], [90, 50, 10], [50, 95, 25], [50, 50, 20]]
    network = Network(places, [[0, 1], [0, 2], [2, 1], [0, 3], [3, 1]])
    found = earliest_arrival(network, clearance, 0, 1, speed=10.0, horizon=1e4)
    assert found.route.positions.tolist() == [places[0], places[2], places[1]]
    assert found.evaluated <= 3  # no flight through the hill is tried at one time after another
    assert dense(found.route, clearance) > 0.0


def test_places_on_top_of_each_other_take_no_time():
    network = Network([[0, 0, 0], [0, 0, 0], [10, 0, 0], [10, 1e-13, 0]], [[0, 1], [1, 2], [2, 3]])
    for clearance in (FAR, moving(CROSSING)):
        found = earliest_arrival(network, clearance, 0, 3, speed=1.0, horizon=50.0)
        assert found.route.arrival == pytest.approx(10.0, abs=3 * RESOLUTION + 1.0)
        assert (np.diff(found.route.times) > 0.0).all()
    here = earliest_arrival(network, FAR, 0, 1, speed=1.0, horizon=50.0, depart=7.0)
    assert here.route.times.tolist() == [7.0]
    assert here.route.least_clearance(FAR) > 1e5


def test_says_why_there_is_none():
    on_start = Balls(([0, 0, 0], [0, 0, 0], 1.0))
    on_goal = Balls(([10, 0, 0], [0, 0, 0], 1.0))
    between = Balls(([2.5, 0, 0], [0, 0, 0], 1.0))
    options = {"speed": 1.0, "horizon": 50.0}
    for can_wait in (True, False):
        options["can_wait"] = can_wait
        for clearance, reason in [
            (on_start, "start is not free at the time of departure"),
            (on_goal, "goal is never free until t = 50 s"),
            (between, "no way among the obstacles arrives by t = 50 s"),
        ]:
            found = earliest_arrival(LINE, clearance, 0, 2, **options)
            assert not found.found
            assert not found.stopped
            assert reason in found.reason
        apart = Network(LINE.places, [[0, 1]])
        assert "has no way to the goal" in earliest_arrival(apart, FAR, 0, 2, **options).reason
        options["horizon"] = 9.9
        assert "by t = 9.9 s" in earliest_arrival(LINE, FAR, 0, 2, **options).reason
        options["horizon"] = 50.0


def test_stops_when_told_to():
    calls = itertools.count()
    clearance = MovingClearance(door(), radius=1.0)
    found = earliest_arrival(
        CORRIDOR, clearance, 0, 2, speed=10.0, horizon=100.0, stop=lambda: next(calls) >= 3
    )
    assert found.stopped
    assert found.route is None
    assert found.reason == "stopped"
    assert next(calls) <= 6


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    can_wait=st.booleans(),
    depart=st.floats(-50.0, 50.0),
    speed=st.floats(0.5, 3.0),
)
def test_whatever_is_found_is_free_and_no_faster_than_straight_flight(
    seed, can_wait, depart, speed
):
    rng = np.random.default_rng(seed)
    places = rng.uniform(0.0, 10.0, (12, 3))
    network = Network(places, rng.integers(0, 12, (40, 2)))
    balls = Balls(
        *[
            (rng.uniform(0, 10, 3) - depart * v, v, rng.uniform(0.3, 2.5))
            for v in rng.normal(size=(4, 3))
        ]
    )
    found = earliest_arrival(
        network, balls, 0, 1, speed=speed, horizon=depart + 30.0, depart=depart, can_wait=can_wait
    )
    if found.route is None:
        assert found.reason
        return
    route = found.route
    assert route.depart == depart
    straight = float(np.linalg.norm(places[1] - places[0]))
    assert straight / speed * (1 - 1e-12) <= route.duration <= 30.0
    assert route.positions[0].tolist() == places[0].tolist()
    assert route.positions[-1].tolist() == places[1].tolist()
    check_flown(route, speed)
    assert can_wait or not route.waits
    assert dense(route, balls, 4001) > 0.0


def test_waiting_never_makes_it_later():
    both = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        network = Network(rng.uniform(0, 10, (15, 3)), rng.integers(0, 15, (50, 2)))
        balls = Balls(
            *[(rng.uniform(0, 10, 3), v, rng.uniform(1, 3)) for v in rng.normal(size=(6, 3))]
        )
        with_, without = (
            earliest_arrival(network, balls, 0, 1, speed=1.0, horizon=40.0, can_wait=one)
            for one in (True, False)
        )
        if without.found:
            assert with_.found
            assert with_.route.arrival <= without.route.arrival + 10 * RESOLUTION
            both += 1
    assert both >= 3
