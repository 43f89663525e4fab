"""Helicopter connections with other avoidance functions than the paper's."""

import math

import numpy as np
import pytest
from primitive_scene import D0, FASTEST, TABLES, TRACKS, bumpy_terrain, flown, kinds, pairs

from ompl_risk.avoidance import FlatCap, GaussianTail
from ompl_risk.clearance import TerrainClearance
from ompl_risk.helicopter.batch import PrimitiveBatch
from ompl_risk.motion import Risk
from ompl_risk.norms import Lp, Sobolev

FUNCTIONS = [FlatCap(D0), GaussianTail(D0 / 4)]
NORMS = [Lp(1), Lp(3.5), Lp(math.inf), Sobolev(1)]
functions = pytest.mark.parametrize("f", FUNCTIONS, ids=repr)
norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


@pytest.fixture(scope="module")
def terrain():
    return bumpy_terrain()


def batch_of(clearance, f, norm, **options):
    risk = Risk(f, norm, speed=FASTEST, duration_weight=0.0, **options)
    return PrimitiveBatch(TABLES, TRACKS, clearance, risk, threads=1)


@functions
@norms
@kinds
def test_costs_agree_with_the_norm_along_what_is_flown(kind, norm, f, terrain):
    clearance = kind(terrain, radius=2.0)
    a, b = pairs(terrain, 12, seed=1, low=20.0)
    batch = batch_of(clearance, f, norm, tolerance=1e-3)
    costs, free = batch.costs(a, b), batch.are_free(a, b)
    assert batch.compiled == (kind is TerrainClearance)
    assert (np.isfinite(costs) == free).all()
    for k in np.flatnonzero(free):
        t, places = flown(a[k], b[k])
        expected = norm.power(t, f(clearance(places)))
        assert costs[k] == pytest.approx(expected, rel=5e-3, abs=1e-3 * f.typical**2)
    assert 3 < free.sum() < len(a)


@functions
@norms
def test_bounds_stay_below_the_costs_of_one_and_of_two_connections(norm, f, terrain):
    clearance = TerrainClearance(terrain, radius=2.0)
    batch = batch_of(clearance, f, norm, tolerance=1e-3)
    (a, b), (c, _) = pairs(terrain, 60, seed=2, low=8.0, high=40.0), pairs(terrain, 60, seed=3)
    d = [batch.clearances(vertices) for vertices in (a, b)]
    lower, (edge, _) = batch.heuristics(a, b, *d), batch.edge_bounds(a, b, *d)
    legs = batch.costs(a, c), batch.costs(c, b)
    bent = np.maximum(*legs) if math.isinf(norm.exponent) else legs[0] + legs[1]
    straight = batch.costs(a, b)
    assert (edge <= straight * 1.001 + 1e-15).all()
    assert (lower <= bent * 1.001 + 1e-15).all()
    assert np.isfinite(straight).sum() > 10
    assert np.isfinite(bent).sum() > 3
    assert (edge[np.isfinite(straight)] > 0.0).mean() > 0.5
