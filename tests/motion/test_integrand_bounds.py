"""Lower bounds of what any way costs, from the clearances at its ends."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from integrand_pieces import (
    SPEED,
    batches,
    functions,
    new_functions,
    norms,
    risk_of,
    some_motions,
)

from ompl_risk._kernels import motions
from ompl_risk.motion.terrain import kernel_parameters
from ompl_risk.norms import Lp, Sobolev


def bounds(length, d_a, d_b, risk):
    """Lower bounds from the lengths of ways and the clearances at their ends alone."""
    d_a, d_b, length = (np.array(x, dtype=float) for x in np.broadcast_arrays(d_a, d_b, length))
    a, out = np.zeros((len(length), 3)), np.empty(len(length))
    b = a.copy()
    b[:, 0] = length
    motions.heuristics(a, b, d_a, d_b, kernel_parameters(0.0, risk), out)
    return out


@functions
@given(
    d_a=st.floats(0.01, 60.0),
    d_b=st.floats(0.01, 60.0),
    length=st.just(0.0) | st.floats(1e-9, 100.0),
    p=st.sampled_from([1.0, 2.0, 3.5, math.inf]),
)
@settings(max_examples=60, deadline=None)
def test_bounds_are_below_the_least_integral_and_close_to_it(f, d_a, d_b, length, p):
    """No way is safer than one on which d grows at the speed until it has to fall to d_b."""
    risk = risk_of(f, Lp(p))
    bound = bounds([length], d_a, d_b, risk)[0]
    s = np.linspace(0.0, length, 4001)
    values = f(np.minimum(d_a + s, d_b + length - s))
    if math.isinf(p):
        assert bound == pytest.approx(max(float(f(d_a)), float(f(d_b))), rel=1e-12, abs=1e-16)
        return
    exact = np.trapezoid(values**p, s / SPEED)
    scale = risk.negligible * length / SPEED
    assert bound <= exact * (1 + 1e-3) + 1e-9 * scale
    if f.steady is not None and 1e-3 < length <= 2 * f.steady:
        assert bound >= 0.9 * exact - scale


@functions
@given(
    seed=st.integers(0, 10_000),
    tau=st.sampled_from([0.0, 0.1, 1.0, 10.0]),
    weight=st.sampled_from([0.0, 1e-4]),
)
@settings(max_examples=60, deadline=None)
def test_no_way_of_a_thousand_costs_less_than_its_bound(f, seed, tau, weight):
    """Clearances that change as they like, but no faster than the vehicle moves."""
    rng = np.random.default_rng(seed)
    n, step = 400, rng.uniform(0.01, 0.3)
    moves = step * np.repeat(rng.uniform(-1, 1, n // 10), 10) * rng.choice([0.2, 1.0])
    d = np.maximum(rng.uniform(0.05, 40.0) + np.concatenate([[0.0], np.cumsum(moves)]), 0.05)
    t = np.arange(n + 1) * step / SPEED
    length = step * n * rng.uniform(0.3, 1.0)  # the straight way is shorter
    for norm in (Lp(1), Lp(1.7), Lp(2), Sobolev(1, time_scale=tau or 1.0)):
        risk = risk_of(f, norm, duration_weight=weight)
        cost = norm.power(t, f(d)) + weight * t[-1]
        ends = np.maximum([d[0], d[-1]], 0.0)
        assert bounds([length], *ends, risk)[0] <= cost * (1 + 1e-3)


@new_functions
@norms
@batches
def test_heuristics_stay_below_the_costs_of_straight_and_of_bent_ways(kind, f, norm, hills_for_one):
    risk = risk_of(f, norm, tolerance=1e-3)
    batch = kind(hills_for_one, risk)
    (a, b), (c, _) = (some_motions(hills_for_one, 60, *k) for k in ((2, 3, 30), (3, 20, 60)))
    lower = batch.heuristics(a, b, batch.clearances(a), batch.clearances(b))
    straight, legs = batch.costs(a, b), (batch.costs(a, c), batch.costs(c, b))
    bent = np.maximum(*legs) if math.isinf(norm.exponent) else legs[0] + legs[1]
    for costs in (straight, bent):
        assert (lower <= costs * 1.001).all()
        assert np.isfinite(costs).sum() > 5
    assert (lower > 0.0).mean() > 0.3
