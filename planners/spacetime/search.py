"""The search for the earliest arrival among moving obstacles."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Sequence
from itertools import count
from typing import NamedTuple

import numpy as np

from ompl_risk._arrays import FloatArray
from ompl_risk.planners.spacetime.departures import Departures
from ompl_risk.planners.spacetime.network import Network
from ompl_risk.planners.spacetime.stays import Key, Stays

BATCH = 64
"""Flights that are looked at in one go."""

Stop = Callable[[], bool]


class Label(NamedTuple):
    """An arrival that is followed.

    Attributes:
        place: where.
        time: when [s].
        latest: until when the vehicle may stay [s].
        parent: label that it came from, -1 at a start.
        left: when it left there [s].
    """

    place: int
    time: float
    latest: float
    parent: int
    left: float


class Flight(NamedTuple):
    """A flight that might be free.

    Attributes:
        bound: no way through it arrives before [s].
        order: tells flights of the same bound apart.
        label: that it leaves from.
        edge: of the network.
        leave: departure [s].
        arrive: arrival [s].
    """

    bound: float
    order: int
    label: int
    edge: int
    leave: float
    arrive: float


class Landing(NamedTuple):
    """A flight that is free.

    Attributes:
        bound: no way through it arrives before [s].
        order: tells landings of the same bound apart.
        key: place and span of time.
        label: that it left from.
        left: departure [s].
        time: arrival [s].
    """

    bound: float
    order: int
    key: Key
    label: int
    left: float
    time: float


class Search:
    """A* in space-time: the earliest arrival first, flights looked at only when it comes to them.

    ::

        bound = arrival + length of the shortest way to go / speed

    A flight is looked at, several in one go, once no other way has a lower bound. If it is free,
    it lands; if not, it is put off to the next departure that may be. So whatever is settled first
    is the earliest, and hardly more flights are certified than matter.

    Args:
        network: places and edges.
        departures: when they are free.
        stays: whether the vehicle may wait.
        speed: along edges [m/s].
        latest: arrivals later than this are of no interest [s].
    """

    def __init__(
        self,
        network: Network,
        departures: Departures,
        stays: Stays,
        *,
        speed: float,
        latest: float,
    ) -> None:
        self._network, self._departures, self._stays = network, departures, stays
        self._speed, self._latest = speed, latest
        self._flights: list[Flight] = []
        self._landings: list[Landing] = []
        self._order = count()
        self._to_go: FloatArray = np.empty(0)
        self._goals: frozenset[int] = frozenset()
        self.labels: list[Label] = []

    def run(
        self, starts: Sequence[tuple[int, float]], goals: Sequence[int], stop: Stop
    ) -> int | None:
        """The label of the earliest arrival at a goal; None if there is none, or ``stop`` says so.

        Args:
            starts: places, and when the vehicle is there [s].
            goals: places.
            stop: whether to give up, asked between two portions of work.
        """
        self._goals = frozenset(goals)
        self._to_go = self._network.lengths_to_go(list(goals)) / self._speed
        for place, time in starts:
            self._begin(place, time)
        while (self._flights or self._landings) and not stop():
            if self._lands_next():
                found = self._settle(heapq.heappop(self._landings))
                if found is not None:
                    return found
            else:
                self._look(self._take())
        return None

    def chain(self, label: int) -> list[Label]:
        """The labels that lead to one, from a start."""
        found = [self.labels[label]]
        while found[-1].parent >= 0:
            found.append(self.labels[found[-1].parent])
        return found[::-1]

    def _begin(self, place: int, time: float) -> None:
        key, _ = self._stays.aim(self._departures, place, time)
        bound = time + float(self._to_go[place])
        if self._departures.is_free(place, time) and bound <= self._latest:
            landing = Landing(bound, next(self._order), key, -1, time, time)
            heapq.heappush(self._landings, landing)

    def _lands_next(self) -> bool:
        if not (self._landings and self._flights):
            return bool(self._landings)
        return self._landings[0].bound <= self._flights[0].bound

    def _take(self) -> list[Flight]:
        return [heapq.heappop(self._flights) for _ in range(min(BATCH, len(self._flights)))]

    def _settle(self, landing: Landing) -> int | None:
        """Follow an arrival if it is the first of its key; its label if it is at a goal."""
        place = landing.key[0]
        if landing.key in self._stays.reached:
            return None
        self._stays.reached.add(landing.key)
        latest = self._stays.latest(self._departures, landing.key, landing.time)
        number = len(self.labels)
        self.labels.append(Label(place, landing.time, latest, landing.label, landing.left))
        if place in self._goals:
            return number
        self._leave(number)
        return None

    def _leave(self, number: int) -> None:
        """Put in the flights from a label, at once."""
        here = self.labels[number]
        row = slice(*self._network.first[here.place : here.place + 2])
        heads = self._network.target[row]
        arrive = here.time + self._departures.duration[row]
        for k in np.flatnonzero(arrive + self._to_go[heads] <= self._latest).tolist():
            if not self._stays.is_late(int(heads[k]), float(arrive[k])):
                self._push(number, row.start + k, here.time, float(arrive[k]))

    def _push(self, label: int, edge: int, leave: float, arrive: float) -> None:
        """Put a flight in, unless it leaves or arrives too late."""
        bound = arrive + float(self._to_go[self._network.target[edge]])
        here = self.labels[label]
        if leave <= here.latest and bound <= self._latest:
            leave = max(leave, here.time)  # arrive - duration may round below
            flight = Flight(bound, next(self._order), label, int(edge), leave, arrive)
            heapq.heappush(self._flights, flight)

    def _look(self, flights: list[Flight]) -> None:
        """Certify flights: those that are free land, the others are put off."""
        edges = np.array([one.edge for one in flights])
        may = self._departures.may_be_flown(edges)
        flights = [one for one, flown in zip(flights, may, strict=True) if flown]
        heads = [int(self._network.target[one.edge]) for one in flights]
        self._stays.prepare(self._departures, heads)
        due: list[tuple[Flight, Key]] = []
        for flight, head in zip(flights, heads, strict=True):
            key, arrive = self._stays.aim(self._departures, head, flight.arrive)
            if arrive == flight.arrive:
                due.append((flight, key))
            else:
                self._put_off(flight, arrive)
        if due:
            self._certify(due)

    def _put_off(self, flight: Flight, arrive: float) -> None:
        duration = float(self._departures.duration[flight.edge])
        self._push(flight.label, flight.edge, arrive - duration, arrive)

    def _certify(self, due: list[tuple[Flight, Key]]) -> None:
        edges = np.array([one.edge for one, _ in due])
        leave = np.array([one.leave for one, _ in due])
        arrive = np.array([one.arrive for one, _ in due])
        free = self._departures.are_free(edges, leave, arrive)
        for k in np.flatnonzero(free).tolist():
            flight, key = due[k]
            landing = flight.bound, next(self._order), key, flight.label, flight.leave
            heapq.heappush(self._landings, Landing(*landing, flight.arrive))
            self._stays.land(key, flight.arrive)
            self._go_on(flight, key)
        blocked = np.flatnonzero(~free)
        waiting = [k for k in blocked.tolist() if self._may_wait(due[k][0])]
        if waiting:
            self._delay([due[k][0] for k in waiting])

    def _may_wait(self, flight: Flight) -> bool:
        return self.labels[flight.label].latest > flight.leave

    def _go_on(self, flight: Flight, key: Key) -> None:
        """A later departure of the same flight may land in a later span of the place."""
        if self._may_wait(flight):
            spans = self._departures.spans(key[0])[key[1] + 1 :, 0]
            if len(spans):
                self._put_off(flight, max(float(spans[0]), flight.arrive))

    def _delay(self, flights: list[Flight]) -> None:
        edges = np.array([one.edge for one in flights])
        leave = np.array([one.leave for one in flights])
        put_off = leave - np.array([self.labels[one.label].time for one in flights])
        for flight, later in zip(
            flights, self._departures.later(edges, leave, put_off).tolist(), strict=True
        ):
            arrive = later + float(self._departures.duration[flight.edge])
            self._push(flight.label, flight.edge, later, arrive)
