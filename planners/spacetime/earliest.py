"""The earliest arrival on a network of places, among obstacles that move."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from ompl_risk._arrays import positive, real_number
from ompl_risk.errors import ArgumentError
from ompl_risk.motion.moving import MovingObstacles, moves
from ompl_risk.planners.spacetime.departures import Departures
from ompl_risk.planners.spacetime.network import Network
from ompl_risk.planners.spacetime.route import Arrival, TimedRoute
from ompl_risk.planners.spacetime.search import Label, Search, Stop
from ompl_risk.planners.spacetime.stays import Hovering, Passing, Stays

RESOLUTION = 1e-3
"""Least step between departures that are looked at [s]."""

BIN = 0.5
"""Length of the bins of time [s]: where the vehicle cannot wait, arrivals in one count as one."""


def never() -> bool:
    """Never stop."""
    return False


def earliest_arrival(
    network: Network,
    clearance: MovingObstacles,
    start: int,
    goal: int | Sequence[int],
    *,
    speed: float,
    horizon: float,
    depart: float = 0.0,
    can_wait: bool = True,
    resolution: float = RESOLUTION,
    bin: float = BIN,  # noqa: A002
    stop: Stop = never,
) -> Arrival:
    """The way through a network that arrives first, among obstacles that move.

    The vehicle flies edges at constant speed. If it can wait, it may stay at any place for as long
    as that is free (safe-interval path planning): the arrival is then the earliest on the network,
    up to ``resolution`` for every departure that an obstacle puts off. If it cannot, it leaves
    every place when it arrives there, and the arrival is the earliest up to ``bin``, see
    ``Passing``: where it would rather wait, that takes longer in proportion to the wait and to
    1 / bin. Every stay and every flight is certified free by the clearance, so that nothing slips
    through between two samples. Stopping and turning take no time; what happens after the arrival
    is not looked at.

    Args:
        network: places and the edges between them.
        clearance: d(q, t), as a ``MovingClearance``; with static obstacles, if it has any.
        start: number of the place to start from.
        goal: number of the place to go to, or several.
        speed: along edges [m/s].
        horizon: time at which it must have arrived [s].
        depart: time at the start [s].
        can_wait: whether the vehicle can hover.
        resolution: free spans shorter than this may be overlooked [s].
        bin: for a vehicle that cannot wait, arrivals at a place in the same bin count as one [s].
        stop: whether to give up, asked every few milliseconds.

    Returns:
        The route, or why there is none.

    Raises:
        ArgumentError: a clearance that does not move, a place that does not exist, or a number out
            of range.

    Example:
        >>> from ompl_risk.clearance.moving.clearance import MovingClearance
        >>> from ompl_risk.clearance.moving.obstacles import MovingSphere
        >>> ball = MovingSphere(1.0, [0.0, 9.0], [[5.0, -4.0, 0.0], [5.0, 5.0, 0.0]])
        >>> line = Network([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]], [[0, 1]])
        >>> found = earliest_arrival(line, MovingClearance(ball), 0, 1, speed=1.0, horizon=60.0)
        >>> round(found.route.arrival, 2)
        10.42

    Reference: Phillips & Likhachev, SIPP: safe interval path planning for dynamic environments,
    ICRA 2011.
    """
    if not moves(clearance):
        allowed = "one that moves, as MovingClearance"
        raise ArgumentError("clearance", type(clearance).__name__, allowed)
    goals = list(goal) if isinstance(goal, Sequence | np.ndarray) else [goal]
    if not goals:
        raise ArgumentError("goal", goal, "at least one place")
    ends = [_place("start", start, network.n), *(_place("goal", one, network.n) for one in goals)]
    depart = _finite("depart", depart)
    horizon = _finite("horizon", horizon)
    if not horizon > depart:
        raise ArgumentError("horizon", horizon, f"later than depart = {depart}")
    positive("speed", speed)
    positive("resolution", resolution)
    stays = Hovering() if can_wait else Passing(positive("bin", bin))
    return arrive_first(
        network,
        clearance,
        [(ends[0], depart)],
        ends[1:],
        speed=speed,
        latest=horizon,
        stays=stays,
        resolution=resolution,
        stop=stop,
    )


def arrive_first(
    network: Network,
    clearance: MovingObstacles,
    starts: Sequence[tuple[int, float]],
    goals: Sequence[int],
    *,
    speed: float,
    latest: float,
    stays: Stays,
    resolution: float = RESOLUTION,
    stop: Stop = never,
) -> Arrival:
    """The same from several starts, each with its own time; arguments are not checked.

    To a vehicle that can wait every way is open that never waits, and its search is far shorter. So
    that comes first: if it finds no way there is none, and a way without waits is the answer.

    Args:
        network: places and edges.
        clearance: d(q, t).
        starts: places, and when the vehicle is there [s].
        goals: places.
        speed: along edges [m/s].
        latest: time at which it must have arrived [s].
        stays: whether the vehicle may wait; a new one for every call.
        resolution: see ``earliest_arrival`` [s].
        stop: whether to give up.
    """
    t0 = min(time for _, time in starts)
    departures = Departures(
        network, clearance, speed=speed, t0=t0, t1=latest, resolution=resolution
    )

    def arrival(stays: Stays) -> Arrival:
        search = Search(network, departures, stays, speed=speed, latest=latest)
        found = search.run(starts, goals, stop)
        counts = len(search.labels), departures.evaluated
        if found is not None:
            return Arrival(route_of(search.chain(found), network), "", False, *counts)
        stopped = stop()
        reason = "stopped" if stopped else _reason(search, departures, starts, goals, latest)
        return Arrival(None, reason, stopped, *counts)

    waiting = arrival(Hovering())
    if isinstance(stays, Hovering) or waiting.route is None or not waiting.route.waits:
        return waiting
    found = arrival(stays)
    return replace(found, labels=waiting.labels + found.labels)


def route_of(chain: Sequence[Label], network: Network) -> TimedRoute:
    """The corners of a chain of labels and their times, stays included."""
    places, times = [chain[0].place], [chain[0].time]
    for before, label in pairwise(chain):
        if label.left > before.time:
            places.append(before.place)
            times.append(label.left)
        if label.time > times[-1]:  # else they are one place under two numbers
            places.append(label.place)
            times.append(label.time)
    return TimedRoute(network.places[places], np.array(times))


def _reason(
    search: Search,
    departures: Departures,
    starts: Sequence[tuple[int, float]],
    goals: Sequence[int],
    latest: float,
) -> str:
    if not search.labels:
        free = any(departures.is_free(*one) for one in starts)
        if not free:
            return "the start is not free at the time of departure"
        return f"the network has no way to the goal that could arrive by t = {latest:g} s"
    if not any(len(departures.spans(goal)) for goal in goals):
        return f"the goal is never free until t = {latest:g} s"
    return (
        f"no way among the obstacles arrives by t = {latest:g} s; {len(search.labels)} stays at "
        "places were reached: more places or a later horizon may help"
    )


def _place(argument: str, value: int, n: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or not 0 <= value < n:
        raise ArgumentError(argument, value, f"the number of a place, from 0 to {n - 1}")
    return int(value)


def _finite(argument: str, value: float) -> float:
    number = real_number(argument, value, "a finite time [s]")
    if not math.isfinite(number):
        raise ArgumentError(argument, value, "a finite time [s]")
    return number
