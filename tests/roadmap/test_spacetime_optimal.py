"""The earliest arrival against brute force: every instant of a fine clock, every edge."""

import numpy as np
import pytest
from moving_balls import Balls

from ompl_risk.planners.spacetime.earliest import RESOLUTION, earliest_arrival
from ompl_risk.planners.spacetime.network import Network

STEPS = 20
"""Steps of the clock in a flight along an edge, which takes a second."""

HORIZON = 14


def lattice(nx=4, ny=3):
    places = np.array([(x, y, 0.0) for y in range(ny) for x in range(nx)], dtype=float)
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    return places, np.argwhere(
        np.isclose(apart, 1.0) & (np.arange(nx * ny)[:, None] < range(nx * ny))
    )


def balls_of(seed, count=4):
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(count):
        toward, angle, v = rng.uniform([0, 0, 0], [3, 2, 0]), rng.uniform(0, 7), rng.uniform(0.1, 2)
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        made.append((toward - rng.uniform(1, 6) * v * way, v * way, rng.uniform(0.2, 0.8)))
    return Balls(*made)


def brute_force(places, edges, balls, *, can_wait):
    """The earliest arrival at the last place on a clock of ``1 / STEPS`` s; None if there is none.

    All motions that begin at an instant of the clock are tried, and checked in closed form.
    """
    n, last = len(places), HORIZON * STEPS
    both = np.vstack([edges, edges[:, ::-1]])
    clock = np.arange(last + 1) / STEPS
    reached = np.zeros((n, last + 1), bool)
    reached[0, 0] = balls(places[:1], np.zeros(1))[0] > 0.0
    stays = [
        balls.are_free(np.tile(p, (last, 1)), clock[:-1], np.tile(p, (last, 1)), clock[1:])
        for p in places
    ]
    begin = clock[: last + 1 - STEPS]
    flights = [
        balls.are_free(
            np.tile(places[u], (len(begin), 1)), begin,
            np.tile(places[v], (len(begin), 1)), begin + 1.0,
        )
        for u, v in both
    ]  # fmt: skip
    for k in range(last + 1):
        if can_wait and k:
            reached[:, k] |= reached[:, k - 1] & [stay[k - 1] for stay in stays]
        if k >= STEPS:
            for (u, v), free in zip(both, flights, strict=True):
                reached[v, k] |= reached[u, k - STEPS] & free[k - STEPS]
        if reached[-1, k]:
            return k / STEPS
    return None


PLACES, EDGES = lattice()
LATTICE = Network(PLACES, EDGES)


@pytest.mark.parametrize("seed", range(25))
def test_no_instant_of_a_clock_leads_to_an_earlier_arrival(seed):
    balls = balls_of(seed)
    brute = brute_force(PLACES, EDGES, balls, can_wait=True)
    found = earliest_arrival(
        LATTICE, balls, 0, len(PLACES) - 1, speed=1.0, horizon=float(HORIZON)
    ).route
    if brute is None:
        assert found is None or found.arrival > HORIZON - 1.0
        return
    assert found is not None
    assert found.arrival <= brute + 10 * RESOLUTION
    # It may be earlier, since it leaves at any time: by no more than a step of the clock for each
    # departure, unless a way is open for less than that.
    assert found.arrival >= brute - (1 + len(found.waits)) / STEPS
    assert balls.approach(
        found.positions[:-1], found.times[:-1], found.positions[1:], found.times[1:]
    )[0].min() > 0.0  # fmt: skip


@pytest.mark.parametrize("seed", range(25))
def test_without_waiting_it_is_the_same_where_all_flights_take_as_long(seed):
    # All arrivals are at whole seconds: bins of half a second keep every one of them.
    balls = balls_of(seed)
    brute = brute_force(PLACES, EDGES, balls, can_wait=False)
    found = earliest_arrival(
        LATTICE, balls, 0, len(PLACES) - 1, speed=1.0, horizon=float(HORIZON), can_wait=False
    ).route
    assert (None if found is None else found.arrival) == brute


def test_the_scenes_are_worth_trying():
    both = [
        (
            brute_force(PLACES, EDGES, balls_of(seed), can_wait=True),
            brute_force(PLACES, EDGES, balls_of(seed), can_wait=False),
        )
        for seed in range(25)
    ]
    shortest = 5.0
    delayed = [a for a, _ in both if a is not None and a > shortest]
    assert len(delayed) >= 8
    assert sum(a is None for a, _ in both) >= 1
    assert sum(a is not None and a != b for a, b in both) >= 4  # where waiting makes a difference
