"""Libraries of made-up primitives: what the steering needs of a library, and nothing flown."""

import math
from dataclasses import dataclass

import numpy as np

from ompl_risk.errors import ArgumentError

SPEEDS = np.array([0.0, 10.0, 20.0, 30.0])


@dataclass(frozen=True)
class ToyManoeuvre:
    number: int
    first: tuple
    last: tuple
    duration: float
    displacement: np.ndarray
    fastest: float

    @property
    def track(self):
        return np.linspace(0.0, 1.0, 11)[:, None] * self.displacement


class ToyLibrary:
    """Manoeuvres of which ``make(first, last)`` gives the duration and the displacement.

    With ``make=None`` the vehicle changes its trim at once: a Dubins car with wings.
    """

    dt = 0.02

    def __init__(self, make=None, speeds=SPEEDS):
        self.speeds = np.asarray(speeds, dtype=float)
        rates = [
            9.81 * np.tan(np.radians([-40, -15, 15, 40])) / v
            if v
            else np.array([-0.8, -0.3, 0.3, 0.8])
            for v in self.speeds
        ]
        self.turns = np.array(rates)
        self.climbs = tuple(
            np.array([-6.0, -2.0, 2.0, 6.0]) if v else np.array([-2.0, 2.0]) for v in self.speeds
        )
        self.manoeuvres = ()
        self._found = {}
        for first, last in self._pairs():
            duration, displacement = (0.0, np.zeros(4)) if make is None else make(first, last)
            number = len(self._found)
            fastest = max(first[0], last[0]) + 1.0
            self._found[first, last] = ToyManoeuvre(
                number, first, last, duration, np.array(displacement, dtype=float), fastest
            )
        self.manoeuvres = tuple(self._found.values())

    def _pairs(self):
        for i, v in enumerate(self.speeds.tolist()):
            level = (v, 0.0, 0.0)
            others = [(v, 0.0, w) for w in self.turns[i].tolist()]
            others += [(v, c, 0.0) for c in self.climbs[i].tolist()]
            for other in others:
                yield level, other
                yield other, level
            for u in self.speeds.tolist():
                if u != v:
                    yield level, (u, 0.0, 0.0)

    def trim(self, speed, climb=0.0, turn=0.0):
        for pair in self._found:
            if (speed, climb, turn) in pair:
                return speed, climb, turn
        raise ArgumentError("speed", speed, "one of a toy's")

    def manoeuvre(self, first, last):
        if (first, last) not in self._found:
            raise ArgumentError("last", last, "one of a toy's")
        return self._found[first, last]


def likely(first, last):
    """About what a helicopter does: a second to bank, to climb or to change speed by 10 m/s."""
    (v, c, w), (u, d, q) = first, last
    if w != q:
        turn = 0.5 * (w + q) * (time := 0.9 + 0.4 * abs(w + q))
        chord = v * time * 0.97 * np.exp(0.45j * turn)
        side = 0.05j * math.copysign(1.0, w + q)
        # a hovering helicopter leans aside to turn, and comes back
        chord = chord + side if v else 0.0
        return time, [np.real(chord), np.imag(chord), 0.0, turn]
    if c != d:
        time = 0.6 + 0.1 * abs(c + d)
        return time, [0.985 * v * time, 0.0, 0.5 * time * (c + d) * (1.1 if c else 0.9), 0.0]
    time = 0.7 + 0.15 * abs(u - v)
    return time, [0.5 * (u + v) * time + 0.3, 0.0, 0.0, 0.0]


def bent(change):
    """A library whose displacements are changed by ``change(first, last)``."""

    def make(first, last):
        time, displacement = likely(first, last)
        return time, np.add(displacement, change(first, last))

    return ToyLibrary(make)
