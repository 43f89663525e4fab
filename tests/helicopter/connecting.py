"""Connections of the kernel, and whether their pieces lead where they should."""

import math

import numpy as np
import pytest

from ompl_risk._kernels import pieces as piece
from ompl_risk._kernels.connect import connection, connection_durations


def connected(tables, a, b):
    """Pieces and duration of the way."""
    pieces = np.full((piece.MOST_PIECES, piece.COLUMNS), np.nan)
    count, duration = connection(tables, np.array(a, dtype=float), np.array(b, dtype=float), pieces)
    return pieces[:count], duration


def durations(tables, a, b):
    out = np.empty(len(a))
    connection_durations(tables, a, b, out)
    return out


def moved(pose, displacement):
    turned = np.exp(1j * pose[3]) * complex(displacement[0], displacement[1])
    return pose + np.array([turned.real, turned.imag, displacement[2], displacement[3]])


def flown(library, row):
    """Displacement of a piece: of a trim the integral of its velocity, of a manoeuvre its own."""
    if row[piece.KIND] == piece.MANOEUVRE:
        return library.manoeuvres[int(row[piece.NUMBER])].displacement
    t, turn = row[piece.DURATION], row[piece.TURN]
    arc = row[piece.SPEED] * ((np.exp(1j * turn * t) - 1.0) / (1j * turn) if turn else t)
    return np.array([np.real(arc), np.imag(arc), row[piece.CLIMB] * t, turn * t])


def assert_flies(library, a, b, pieces, duration):
    """Pieces follow each other from a to b, in trims that fit, and take that time."""
    pose, trim = np.array(a[:4], dtype=float), (library.speeds[int(a[4])], 0.0, 0.0)
    for row in pieces:
        np.testing.assert_allclose(row[piece.X : piece.HEADING + 1], pose, rtol=0.0, atol=1e-10)
        if row[piece.KIND] == piece.TRIM:
            assert tuple(row[[piece.SPEED, piece.CLIMB, piece.TURN]]) == trim
            assert row[piece.NUMBER] == -1
        else:
            manoeuvre = library.manoeuvres[int(row[piece.NUMBER])]
            assert manoeuvre.first == trim
            assert row[piece.DURATION] == manoeuvre.duration
            trim = manoeuvre.last
        assert row[piece.DURATION] >= 0.0
        pose = moved(pose, flown(library, row))
    assert trim == (library.speeds[int(b[4])], 0.0, 0.0)
    np.testing.assert_allclose(pose[:3], b[:3], rtol=0.0, atol=1e-9)
    assert abs(math.remainder(pose[3] - b[3], 2.0 * math.pi)) < 1e-9
    assert pieces[:, piece.DURATION].sum() == pytest.approx(duration, rel=0.0, abs=1e-9)


def random_vertices(n, rng, *, span=700.0, speeds=4, rise=60.0):
    """Vertices near each other, far from the origin."""
    low, high = np.array([5000.0, -9000.0, 100.0]), np.array([span, span, rise])
    places = low + rng.random((n, 3)) * high
    rest = [rng.uniform(-7.0, 7.0, n), rng.integers(0, speeds, n)]
    return np.column_stack([places, *rest])
