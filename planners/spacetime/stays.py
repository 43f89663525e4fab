"""Whether a vehicle may stay where it is, and which arrivals at a place need to be told apart."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

from ompl_risk.planners.spacetime.departures import Departures

Key = tuple[int, int]
"""A place, and the number of a span of time there."""


class Stays(ABC):
    """What arrivals at a place come to.

    Duties of an implementer:

    1. Of two arrivals with the same key the earlier one is followed, the later one forgotten.
    2. ``aim`` never passes over a time at which the vehicle may be there with a key that is new.
    3. ``is_late`` only of an arrival that would be forgotten, whatever else is found.

    Attributes:
        reached: keys of the arrivals that are followed.
    """

    def __init__(self) -> None:
        self.reached: set[Key] = set()

    def prepare(self, departures: Departures, places: Sequence[int]) -> None:  # noqa: B027
        """Find out in one go what is needed to know of several places."""

    def land(self, key: Key, time: float) -> None:  # noqa: B027
        """Take note that there is a flight that arrives with a key at a time [s]."""

    def is_late(self, place: int, time: float) -> bool:  # noqa: ARG002
        """Whether an arrival at a time [s] need not be looked at."""
        return False

    @abstractmethod
    def aim(self, departures: Departures, place: int, time: float) -> tuple[Key, float]:
        """The first arrival at a place, at a time or later, that is new; inf if there is none."""

    @abstractmethod
    def latest(self, departures: Departures, key: Key, time: float) -> float:
        """Until when the vehicle may stay at a place where it arrived at a time [s]."""


class Hovering(Stays):
    """The vehicle may stay wherever it is free: safe-interval path planning.

    Who arrives first in a free span of a place can be there at any later time of the span, so one
    arrival a span is enough, and nothing is lost.

    Reference: Phillips & Likhachev, SIPP: safe interval path planning for dynamic environments,
    ICRA 2011.
    """

    def prepare(self, departures: Departures, places: Sequence[int]) -> None:
        """Find their free spans."""
        departures.prepare(places)

    def aim(self, departures: Departures, place: int, time: float) -> tuple[Key, float]:
        """The first time in a free span that has not been reached."""
        for k, (since, until) in enumerate(departures.spans(place).tolist()):
            if until >= time and (place, k) not in self.reached:
                return (place, k), max(time, since)
        return (place, -1), math.inf

    def latest(self, departures: Departures, key: Key, time: float) -> float:  # noqa: ARG002
        """The end of the free span."""
        return float(departures.spans(key[0])[key[1], 1])


class Passing(Stays):
    """The vehicle must fly on at once.

    Two arrivals at a place at different times lead to different flights, and neither is as good as
    the other. They are told apart only if they are not in the same bin of time: of those that are
    the first is followed. A way that only a later arrival in the bin could have taken is lost, so
    that arrivals are the earliest up to what a finer bin would find, and with a coarse bin a way
    may be missed altogether. Whatever is found is free.

    Where waiting would help, all places that could still be passed in time are arrived at again and
    again, until the way is open: up to ::

        places * (delay / bin + 1)

    arrivals are followed, against one for each free span of a place if the vehicle can wait. None
    of them can be left out: an earlier arrival is no better than a later one, and as the crow flies
    all are equally promising. Flights that cannot be the first in their bin are not certified.

    Args:
        bin: length of a bin [s].
    """

    def __init__(self, bin: float) -> None:  # noqa: A002
        super().__init__()
        self._bin = bin
        self._landed: dict[Key, float] = {}

    def land(self, key: Key, time: float) -> None:
        """Later arrivals in the bin are then late."""
        self._landed[key] = min(time, self._landed.get(key, math.inf))

    def is_late(self, place: int, time: float) -> bool:
        """Whether the bin has been reached, or there is a flight that arrives in it before."""
        key = self._key(place, time)
        return key in self.reached or time >= self._landed.get(key, math.inf)

    def aim(self, departures: Departures, place: int, time: float) -> tuple[Key, float]:  # noqa: ARG002
        """The time itself, unless that is late."""
        return self._key(place, time), math.inf if self.is_late(place, time) else time

    def latest(self, departures: Departures, key: Key, time: float) -> float:  # noqa: ARG002
        """At once."""
        return time

    def _key(self, place: int, time: float) -> Key:
        return place, math.floor(time / self._bin)
