"""Rollouts of the helicopter beside a planned flight, in gusts, by an estimate of its state."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ompl_risk._kernels.gusts import GUST, advance_gust, begin_gust
from ompl_risk._kernels.jit import entry, kernel
from ompl_risk._kernels.lanes import LANES, answer, blow, see, step_all
from ompl_risk._kernels.navigation import NAVIGATION, advance_navigation, begin_navigation
from ompl_risk._kernels.rigid_body import STATE
from ompl_risk._kernels.watch import (
    MARKS,
    SEGMENT,
    begin_watch,
    lose,
    opened_watch,
    shared_watch,
    watched,
)

ASIDE = np.uint64(0xD6E8FEB86659FD93)
"""Sets the navigation's random numbers apart from those of the gusts."""

LOST = 1000.0
"""Distance from the plan [m] at which the vehicle counts as out of control."""


class Loop(NamedTuple):
    """A planned flight and the law that keeps a helicopter beside it.

    Attributes:
        states: planned, shape (n + 1, 13).
        velocities: planned, in the world [m/s], shape (n + 1, 3).
        controls: planned, shape (n, 4).
        gains: in the units of the controls, shape (n, 4, 12).
        most: bounds for what place and velocity ask of the controls, shape (n, 4).
        low: least controls, shape (4,).
        high: greatest controls, shape (4,).
        change: greatest change from one control to the next, shape (4,).
        given: parameters of the helicopter.
        dt: the step [s].
    """

    states: NDArray[np.float64]
    velocities: NDArray[np.float64]
    controls: NDArray[np.float64]
    gains: NDArray[np.float64]
    most: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    change: NDArray[np.float64]
    given: NDArray[np.float64]
    dt: float


class Crew(NamedTuple):
    """LANES vehicles in lockstep; see ``lanes`` for the order of the numbers.

    Attributes:
        states: shape (13 LANES,).
        controls: shape (4 LANES,).
        seen: deviations, shape (12 LANES,).
        winds: [m/s], shape (3 LANES,).
        pushes: [N], shape (3 LANES,).
        errors: of the navigation, shape (9 LANES,).
        ways: positions of each of the last steps, shape (SEGMENT, 3 LANES).
        gusts: states of the filters, shape (LANES, GUST).
        biases: of the navigation, shape (LANES, 9).
        seeds: shape (LANES, 1).
        asides: those of the navigation, shape (LANES, 1).
        places, marks: of the watches, shapes (LANES, SEGMENT + 1, 4) and (LANES, MARKS).
        going: which have not ended, shape (LANES,).
    """

    states: NDArray[np.float64]
    controls: NDArray[np.float64]
    seen: NDArray[np.float64]
    winds: NDArray[np.float64]
    pushes: NDArray[np.float64]
    errors: NDArray[np.float64]
    ways: NDArray[np.float64]
    gusts: NDArray[np.float64]
    biases: NDArray[np.float64]
    seeds: NDArray[np.uint64]
    asides: NDArray[np.uint64]
    places: NDArray[np.float64]
    marks: NDArray[np.float64]
    going: NDArray[np.bool_]


@entry
def roll_out(loop, air, first, last, record):
    """Fly rollouts ``first`` to ``last - 1``.

    Each has its own random numbers, and draws as many of them at every step whatever the plan:
    rollouts of the same seed along two plans meet the same gusts and errors at the same times.
    """
    n, watch, crew, room = len(loop.controls), opened_watch(air.handle), new_crew(), np.empty(9)
    for k in range(first, last, LANES):
        count = min(LANES, last - k)
        going = _begin(loop, air, watch, crew, k, count, room, record)
        for i in range(0, n, SEGMENT):
            if not going:
                break
            steps = min(SEGMENT, n - i)
            for j in range(steps):
                _step(loop, air, crew, i + j, room)
                crew.ways[j] = crew.states[: 3 * LANES]
            going = _check_all(loop, air, watch, crew, k, count, i, steps, room, record)


@entry
def new_crew():
    """Room for LANES vehicles."""
    return Crew(
        np.empty(STATE * LANES),
        np.empty(4 * LANES),
        np.empty(12 * LANES),
        np.zeros(3 * LANES),
        np.zeros(3 * LANES),
        np.zeros(NAVIGATION * LANES),
        np.empty((SEGMENT, 3 * LANES)),
        np.empty((LANES, GUST)),
        np.empty((LANES, NAVIGATION)),
        np.empty((LANES, 1), np.uint64),
        np.empty((LANES, 1), np.uint64),
        np.empty((LANES, SEGMENT + 1, 4)),
        np.empty((LANES, MARKS)),
        np.empty(LANES, np.bool_),
    )


@kernel
def _begin(loop, air, watch, crew, k, count, room, record):
    """Put rollouts k to k + count - 1 to their start; whether any may go on.

    Lanes that are left over fly along as copies of the last one, and are not recorded.
    """
    any_going = False
    for lane in range(LANES):
        rollout = k + min(lane, count - 1)
        for j in range(STATE):
            crew.states[j * LANES + lane] = loop.states[0, j]
        for j in range(4):
            crew.controls[j * LANES + lane] = loop.controls[0, j]
        crew.seeds[lane, 0], crew.asides[lane, 0] = air.seeds[rollout], air.seeds[rollout] ^ ASIDE
        if len(air.filters):
            begin_gust(crew.gusts[lane], air.filters[0], crew.seeds[lane])
        if len(air.navigation):
            begin_navigation(crew.biases[lane], air.navigation, crew.asides[lane])
        crew.going[lane] = False
        if lane < count:
            own = shared_watch(watch, crew.places[lane], crew.marks[lane])
            _put(loop.states[0], room)
            crew.going[lane] = begin_watch(own, air, rollout, room, loop.dt, record)
            any_going |= crew.going[lane]
    return any_going


@kernel
def _step(loop, air, crew, i, room):
    """Step i of every lane; ``room`` (9,) to work in."""
    if len(air.filters):
        for lane in range(LANES):
            advance_gust(crew.gusts[lane], air.filters[i], crew.seeds[lane], room)
            for j in range(3):
                crew.winds[j * LANES + lane] = room[j]
        blow(crew.states, crew.winds, air.drag, loop.velocities[i], loop.given, crew.pushes)
    if len(air.navigation) and i % air.update == 0:
        for lane in range(LANES):
            advance_navigation(crew.biases[lane], air.navigation, crew.asides[lane], room)
            for j in range(NAVIGATION):
                crew.errors[j * LANES + lane] = room[j]
    see(crew.states, crew.errors, loop.states[i], crew.seen)
    for j in range(4):
        answer(
            crew.seen, loop.gains[i, j], loop.controls[i, j], loop.most[i, j],
            loop.low[j], loop.high[j], loop.change[j], j, crew.controls,
        )  # fmt: skip
    step_all(crew.states, crew.controls, crew.pushes, loop.dt, loop.given)


@kernel
def _check_all(loop, air, watch, crew, k, count, before, steps, room, record):
    """Check the last steps of rollouts k to k + count - 1; whether any may go on."""
    any_going = False
    for lane in range(count):
        if crew.going[lane]:
            own = shared_watch(watch, crew.places[lane], crew.marks[lane])
            way = crew.ways[:steps, lane::LANES]
            crew.going[lane] = _check(loop, air, own, way, k + lane, before, room, record)
            any_going |= crew.going[lane]
    return any_going


@kernel
def _check(loop, air, watch, way, k, before, room, record):
    """Check the way (n, 3) of rollout k after so many steps; whether it may go on."""
    end = len(loop.controls)
    _put(loop.states[before], room)
    for j in range(len(way)):
        plan = loop.states[before + j + 1]
        dx, dy, dz = way[j, 0] - plan[0], way[j, 1] - plan[1], way[j, 2] - plan[2]
        away = dx * dx + dy * dy + dz * dz
        lost = not away < LOST * LOST  # nor if it is NaN
        if away < np.inf:
            _put(way[j], room)
        if not watched(watch, air, k, room, lost or before + j + 1 == end, record):
            return False
        if lost:
            lose(watch, air, k, room, record)
            return False
    return True


@kernel
def _put(position, room):
    """Copy x, y and z: kernels are compiled once for every kind of array that they are given."""
    room[0], room[1], room[2] = position[0], position[1], position[2]
