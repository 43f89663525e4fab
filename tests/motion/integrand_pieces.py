"""Avoidance functions that compiled code knows, and motions over hills for them."""

import math

import numpy as np
import pytest

from ompl_risk.avoidance import (
    FlatCap,
    GaussianTail,
    InverseDistance,
)
from ompl_risk.avoidance.compiled import compiled_form
from ompl_risk.motion import Risk, SampledBatch, TerrainBatch
from ompl_risk.norms import Lp, Sobolev

SPEED = 20.0
FUNCTIONS = [
    InverseDistance(30.0),
    FlatCap(30.0),
    GaussianTail(7.5),
    GaussianTail(3.0, d0=20.0),
    GaussianTail(30.0, d0=30.0),
]
NEW = FUNCTIONS[1:]
NORMS = [Lp(1), Lp(2), Lp(3.5), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]
functions = pytest.mark.parametrize("f", FUNCTIONS, ids=repr)
new_functions = pytest.mark.parametrize("f", NEW, ids=repr)
norms = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)
batches = pytest.mark.parametrize("kind", [TerrainBatch, SampledBatch], ids=["terrain", "sampled"])


def some_motions(clearance, n, seed=0, low=3.0, high=50.0, length=150.0):
    rng = np.random.default_rng(seed)
    xmin, xmax, ymin, ymax = clearance.terrain.extent
    a, b = np.empty((2, n, 3))
    a[:, :2] = rng.uniform((xmin, ymin), (xmax, ymax), (n, 2))
    b[:, :2] = np.clip(a[:, :2] + rng.normal(0, length, (n, 2)), (xmin, ymin), (xmax, ymax))
    for ends in (a, b):
        ends[:, 2] = clearance.terrain.height(*ends[:, :2].T) + rng.uniform(low, high, n)
    return a, b


def risk_of(f, norm=None, **options):
    return Risk(f, norm or Sobolev(1), **{"speed": SPEED, "duration_weight": 0.0, **options})


def numbers(f):
    form = compiled_form(f)
    assert form is not None
    return form
