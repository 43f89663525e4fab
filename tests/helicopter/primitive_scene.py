"""A bumpy terrain, vertices above it, and the library's connections between them."""

import numpy as np
import pytest

from ompl_risk._kernels.pieces import DURATION, KIND, TRIM
from ompl_risk.avoidance import InverseDistance
from ompl_risk.clearance import TerrainClearance
from ompl_risk.helicopter.batch import PrimitiveBatch, fastest
from ompl_risk.helicopter.flight_risk import Connections
from ompl_risk.helicopter.library import default_library
from ompl_risk.helicopter.tables import connect_tables, tracks
from ompl_risk.motion import Risk
from ompl_risk.norms import Sobolev
from ompl_risk.terrains import Terrain

LIBRARY = default_library()
TABLES, TRACKS = connect_tables(LIBRARY), tracks(LIBRARY)
FASTEST = fastest(TABLES, TRACKS)
D0 = 40.0


class Elsewhere(TerrainClearance):
    """The same distances, but not known to be: compiled code must not answer for it."""

    def __call__(self, points, **options):
        return super().__call__(points, **options)


kinds = pytest.mark.parametrize("kind", [TerrainClearance, Elsewhere], ids=["terrain", "sampled"])


def bumpy_terrain():
    y, x = np.mgrid[0:80, 0:80] / 80
    heights = 25 * np.sin(9 * x) * np.cos(11 * y) + 8 * np.sin(31 * x + 25 * y)
    return Terrain(heights, spacing=(15.0, 15.0))


def risk_of(norm=None, **options):
    return Risk(InverseDistance(D0), norm or Sobolev(1), **{"speed": FASTEST, **options})


def batch_of(clearance, norm=None, **options):
    return PrimitiveBatch(TABLES, TRACKS, clearance, risk_of(norm, **options), threads=1)


def pairs(terrain, n, seed=0, low=10.0, high=60.0, far=450.0):
    """Vertices of all speeds and headings, the second within reach of the first."""
    rng = np.random.default_rng(seed)
    a, b = np.empty((2, n, 5))
    a[:, :2] = rng.uniform(300.0, 850.0, (n, 2))
    b[:, :2] = np.clip(a[:, :2] + rng.uniform(-far, far, (n, 2)), 60.0, 1100.0)
    for vertices in (a, b):
        ground = terrain.height(vertices[:, 0], vertices[:, 1])
        vertices[:, 2] = ground + rng.uniform(low, high, n)
        vertices[:, 3] = rng.uniform(-4.0, 4.0, n)
        vertices[:, 4] = rng.integers(0, 4, n)
    return a, b


def flown(a, b, step=0.002):
    """Times and positions of the way from a to b, by trims and states of the library alone."""
    made = Connections.joining(TABLES, a[None], b[None])
    t, places = [0.0], [a[:3]]
    for row in made.pieces[0, : made.counts[0]]:
        if row[KIND] == TRIM:
            since = np.linspace(0.0, row[DURATION], max(int(row[DURATION] / step), 2))
            angle = row[5] + row[8] * 0.5 * (since[1:] + since[:-1])
            moved = row[6] * np.exp(1j * angle) * np.diff(since)
            x = np.concatenate([[0.0], np.cumsum(moved)])
            z = row[7] * since
        else:
            states = LIBRARY.manoeuvres[int(row[9])].states
            since = np.arange(len(states)) * LIBRARY.dt
            x, z = (states[:, 0] + 1j * states[:, 1]) * np.exp(1j * row[5]), states[:, 2]
        path = np.column_stack([row[2] + x.real, row[3] + x.imag, row[4] + z])
        t.extend((t[-1] + since[1:]).tolist())
        places.extend(path[1:])
    return np.array(t), np.array(places)
