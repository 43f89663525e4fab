"""Random routes, and how far states are apart by scipy's rotations."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

from ompl_risk._kernels.pieces import COLUMNS, MANOEUVRE, TRIM


def random_route(steering, rng, metres, speeds=(2, 3), spread=0.6):
    """A chain of vertices a few hundred metres apart, none turned by much: start, pieces."""
    here = np.array([0.0, 0.0, 100.0, rng.uniform(-3.0, 3.0), rng.choice(speeds)])
    start, pieces, flown = here, [], 0.0
    while flown < metres:
        away, bearing = rng.uniform(150.0, 900.0), here[3] + rng.uniform(-spread, spread)
        there = np.array(
            [
                here[0] + away * math.cos(bearing),
                here[1] + away * math.sin(bearing),
                100.0 + rng.uniform(-60.0, 60.0),
                bearing + rng.uniform(-spread, spread),
                rng.choice(speeds),
            ]
        )
        way = steering.connect(here, there)
        if way.exists:
            pieces.append(way.pieces)
            here, flown = there, flown + away
    return start, np.concatenate(pieces)


class Writer:
    """Pieces one after the other, by displacements as complex numbers."""

    def __init__(self, library, start):
        self.library, self.start, self.rows = library, np.array(start, dtype=float), []
        self._place, self._z, self._heading = complex(*start[:2]), start[2], start[3]

    def hold(self, duration, speed, climb=0.0, turn=0.0):
        trim = self.library.trim(speed, climb, turn)
        self._put(TRIM, duration, trim.displacement(duration), (*trim.key, -1.0))
        return self

    def change(self, first, last):
        one = self.library.manoeuvre(self.library.trim(*first), self.library.trim(*last))
        self._put(MANOEUVRE, one.duration, one.displacement, (0.0, 0.0, 0.0, one.number))
        return self

    @property
    def pieces(self):
        return np.array(self.rows).reshape(-1, COLUMNS)

    def _put(self, kind, duration, displacement, rest):
        row = (kind, duration, self._place.real, self._place.imag, self._z, self._heading, *rest)
        self.rows.append(row)
        x, y, z, turn = displacement
        self._place += complex(x, y) * np.exp(1j * self._heading)
        self._z, self._heading = self._z + z, self._heading + turn


def apart(states, others):
    """Distance [m] and angle [rad] between states, shape (n, 2)."""
    states, others = np.atleast_2d(states), np.atleast_2d(others)
    distance = np.linalg.norm(states[:, :3] - others[:, :3], axis=1)
    turn = Rotation.from_quat(others[:, 3:7]).inv() * Rotation.from_quat(states[:, 3:7])
    return np.column_stack([distance, turn.magnitude()])
