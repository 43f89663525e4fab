"""What a batch of helicopter connections refuses, and what it says."""

import math

import numpy as np
import pytest
from primitive_scene import FASTEST, TABLES, TRACKS, batch_of, bumpy_terrain, kinds, pairs, risk_of

from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.helicopter.batch import PrimitiveBatch


@pytest.fixture(scope="module")
def terrain():
    return bumpy_terrain()


class Posed:
    """A clearance of a body that has an attitude."""

    uses_orientation = True

    def __call__(self, poses):
        return np.asarray(poses)[:, 2]


@pytest.mark.parametrize(
    ("clearance", "speed", "named", "allowed"),
    [
        (Posed(), FASTEST, "clearance", "does not use the orientation"),
        (3.0, FASTEST, "clearance", "callable"),
        (lambda x: x[:, 2], 0.99 * FASTEST, "risk.speed", f"at least {FASTEST:.9g} m/s"),
    ],
)
def test_what_the_batch_cannot_serve_is_refused(clearance, speed, named, allowed):
    with pytest.raises(ArgumentError, match=named) as error:
        PrimitiveBatch(TABLES, TRACKS, clearance, risk_of(speed=speed))
    assert allowed in str(error.value)


@pytest.mark.parametrize(
    ("row", "said"),
    [
        ([0.0, 0.0, 50.0, 0.0, 4.0], "from 0 to 3"),
        ([0.0, 0.0, 50.0, 0.0, -1.0], "from 0 to 3"),
        ([0.0, 0.0, 50.0, 0.0, 0.5], "from 0 to 3"),
        ([0.0, math.nan, 50.0, 0.0, 1.0], "finite"),
        ([0.0, 0.0, 50.0, math.inf, 1.0], "finite"),
        ([0.0, 0.0, 50.0], r"(n, 5)"),
    ],
)
@kinds
def test_bad_vertices_are_refused_by_every_question(kind, terrain, row, said):
    batch = batch_of(kind(terrain))
    good = np.array([[500.0, 500.0, 50.0, 0.0, 1.0]] * 2)
    bad = np.array([row, row]) if len(row) < 5 else np.array([good[0], row])
    d = np.ones(2)
    questions = [
        lambda: batch.clearances(bad),
        lambda: batch.costs(good, bad),
        lambda: batch.are_free(bad, good),
        lambda: batch.durations(good, bad),
        lambda: batch.heuristics(good, bad, d, d),
        lambda: batch.edge_bounds(bad, good, d, d),
        lambda: batch.least_durations(good, bad),
        lambda: batch.extents(good, bad),
        lambda: batch.samples(bad, good),
    ]
    for ask in questions:
        with pytest.raises(ArgumentError) as error:
            ask()
        assert said in str(error.value)


def test_as_many_ends_as_beginnings(terrain):
    a, b = pairs(terrain, 4)
    with pytest.raises(ArgumentError, match=r"b\.shape"):
        batch_of(TerrainClearance(terrain)).costs(a, b[:3])
