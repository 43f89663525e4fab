"""Ways made of pieces, and where they lead by formulas of their own: complex numbers in numpy."""

import cmath

import numpy as np

from ompl_risk._kernels.pieces import COLUMNS, MANOEUVRE, MOST_PIECES, TRIM, joined_tracks

DT = 0.02


def banked(speed, rate, seconds=1.0):
    """Track of a manoeuvre whose turn rate grows evenly from 0 to ``rate``."""
    t = np.arange(round(seconds / DT) + 1) * DT
    heading = 0.5 * rate * t**2 / seconds
    fine = np.linspace(0.0, t[-1], 100 * (len(t) - 1) + 1)
    velocity = speed * np.exp(0.5j * rate * fine**2 / seconds)
    steps = 0.5 * (velocity[1:] + velocity[:-1]) * np.diff(fine)
    place = np.concatenate([[0.0], np.cumsum(steps)])[::100]
    return np.column_stack([place.real, place.imag, np.zeros(len(t)), heading])


def sped_up(first, last, seconds=2.0):
    """Track of a manoeuvre that changes the speed evenly, and is 0.5 m higher half-way."""
    t = np.arange(round(seconds / DT) + 1) * DT
    x = first * t + 0.5 * (last - first) * t**2 / seconds
    return np.column_stack([x, 0.0 * t, 0.5 * np.sin(np.pi * t / seconds) ** 2, 0.0 * t])


PARTS = [banked(20.0, 0.4), banked(10.0, -0.8, 0.8), sped_up(10.0, 20.0), sped_up(0.0, 10.0)]
TRACKS = joined_tracks(PARTS, DT)


class Way:
    """Pieces one after the other from a pose on, in the layout of the kernels."""

    def __init__(self, x, y, z, heading):
        self.rows, self.pose = [], (complex(x, y), float(z), float(heading))

    def trim(self, speed, climb, turn, seconds):
        return self._add([TRIM, seconds, 0, 0, 0, 0, speed, climb, turn, -1])

    def manoeuvre(self, number):
        return self._add([MANOEUVRE, (len(PARTS[number]) - 1) * DT, 0, 0, 0, 0, 0, 0, 0, number])

    def _add(self, row):
        place, z, heading = self.pose
        row[2:6] = place.real, place.imag, z, heading
        self.rows.append(np.array(row, dtype=float))
        x, y, z = positions_on(self.rows[-1], np.array([row[1]]))[0]
        turned = row[8] * row[1] if row[0] == TRIM else PARTS[int(row[9])][-1, 3]
        self.pose = complex(x, y), z, heading + turned
        return self

    @property
    def duration(self):
        return sum(row[1] for row in self.rows)

    @property
    def pieces(self):
        padded = np.full((MOST_PIECES, COLUMNS), np.nan)
        padded[: len(self.rows)] = self.rows
        return padded


def positions_on(row, t):
    """Positions [m] on a piece, shape (n, 3): the integral of V e^{i (heading + w s)}."""
    start = complex(row[2], row[3])
    if row[0] == TRIM:
        speed, climb, w = row[6:9]
        series = t + 0.5j * w * t**2  # enough where w t is small
        arc = (np.exp(1j * w * t) - 1.0) / (1j * w) if abs(w) > 1e-6 else series
        place, z = start + speed * cmath.exp(1j * row[5]) * arc, row[4] + climb * t
    else:
        track = PARTS[int(row[9])]
        x, y, z = (np.interp(t, np.arange(len(track)) * DT, track[:, k]) for k in range(3))
        place, z = start + cmath.exp(1j * row[5]) * (x + 1j * y), row[4] + z
    return np.column_stack([place.real, place.imag, z])


def dense(rows, n=40_001):
    """Times [s] and positions along a way, at equal steps."""
    ends = np.cumsum([row[1] for row in rows])
    t = np.linspace(0.0, ends[-1], n)
    which = np.minimum(np.searchsorted(ends, t), len(rows) - 1)
    found = np.empty((n, 3))
    for k, row in enumerate(rows):
        found[which == k] = positions_on(row, t[which == k] - (ends[k] - row[1]))
    return t, found
