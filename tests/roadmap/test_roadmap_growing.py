"""The roadmap as it grows: samples, neighbours, stopping half way, thinning out."""

import math

import numpy as np
import pytest
from scene import counted, hills, pure, roadmap

from ompl_risk.clearance import TerrainClearance
from ompl_risk.errors import ArgumentError
from ompl_risk.norms import Lp, Sobolev
from ompl_risk.planners.roadmap.neighbours import neighbour_count, new_pairs
from ompl_risk.planners.roadmap.region import Region

NORMS = [Lp(1), Lp(2), Lp(4), Lp(math.inf), Sobolev(1), Sobolev(1, time_scale=3.0)]
names = pytest.mark.parametrize("norm", NORMS, ids=lambda norm: norm.label)


def test_stopping_half_way_loses_nothing():
    exact = TerrainClearance(hills(), 2.0)

    def slow(points):
        return exact(points)

    stopped, straight = roadmap(clearance=slow), roadmap(clearance=slow)
    for made in (stopped, straight):
        made.grow(150)
    asked = iter(range(10**6))
    assert stopped.search(lambda: next(asked) > 5) is None
    assert 0 < stopped.evaluated < straight.edges.m
    assert stopped.search().cost == straight.search().cost


def test_samples_fill_the_box_evenly():
    region = Region([0, 0, 0], [2, 3, 4], seed=1)
    points = region.sample(4096) / [2, 3, 4]
    counts, _ = np.histogramdd(points, bins=(8, 8, 8), range=[(0, 1)] * 3)
    assert counts.min() >= 7  # eight each: a low-discrepancy sequence
    assert counts.max() <= 9
    assert len(np.unique(np.vstack([points, region.sample(4096) / [2, 3, 4]]), axis=0)) == 8192


def test_orientations_are_uniform():
    quaternions = Region([0, 0, 0], [1, 1, 1], posed=True, seed=2).sample(8192)[:, 3:]
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(quaternions.T @ quaternions / 8192, np.eye(4) / 4, atol=0.01)


def test_an_empty_box_is_refused():
    with pytest.raises(ArgumentError, match="high"):
        Region([0, 0, 0], [1, 0, 1])


@pytest.mark.parametrize(("n", "dimensions", "k"), [(10_000, 3, 34), (200_000, 3, 45), (2, 3, 1)])
def test_neighbour_count_is_that_of_prm_star(n, dimensions, k):
    assert neighbour_count(n, dimensions) == k


def test_every_new_vertex_has_its_nearest_as_neighbours():
    made = roadmap()
    made.grow(200)
    gaps = np.linalg.norm(made.states[:, None] - made.states[None], axis=2)
    k = neighbour_count(made.n, 3)
    first = made.edges.first
    for v in range(made.n - 50, made.n):
        linked = set(made.edges.target[first[v] : first[v + 1]].tolist())
        assert set(np.argsort(gaps[v])[1 : k + 1].tolist()) <= linked


def test_pure_risk_has_no_weight_of_time():
    assert pure(counted(weight=3.0)).weight == 0.0


@names
def test_thinning_out_leaves_a_roadmap_as_if_sampled_at_once(norm):
    made, whole = roadmap(counted(norm)), roadmap(counted(norm))
    for _ in range(8):
        made.grow(100)
        made.best = None
        before = made.search()
    whole.grow(800)
    np.testing.assert_array_equal(made.states, whole.states)
    many, evaluated = made.edges.m, made.evaluated
    known = {
        (min(pair), max(pair)): value
        for pair, value, exact in zip(
            np.column_stack(made.edges.ends()).tolist(),
            made.edges.risk().tolist(),
            made.edges.known,
            strict=True,
        )
        if exact and math.isfinite(value)
    }
    made.thin_out()
    pairs = {tuple(sorted(pair)) for pair in np.column_stack(made.edges.ends()).tolist()}
    nearest = np.column_stack(new_pairs(made.states, 0, made.region, 1))
    once = {tuple(sorted(pair)) for pair in nearest.tolist()}
    assert len(pairs) == made.edges.m < many
    assert pairs == once | set(known)
    kept = np.flatnonzero(made.edges.known)
    tail, head = made.edges.ends()
    assert len(kept) == len(known)
    for e in kept:
        pair = min(tail[e], head[e]), max(tail[e], head[e])
        assert made.edges.risk(np.array([e]))[0] == pytest.approx(known[pair], rel=1e-12)
    after = made.search()
    assert after.cost <= before.cost * (1 + 1e-9)  # the path it had is still there
    assert after.cost <= whole.search().cost * (1 + 1e-9)
    assert made.evaluated - evaluated < made.edges.m / 4


def test_a_growing_roadmap_is_thinned_out():
    made = roadmap(counted(weight=1.0))
    for _ in range(14):
        made.grow(400)
    assert made.n > 3000
    assert made.edges.m < 0.8 * neighbour_count(made.n, 3) * made.n
    assert made._thinned > 0
