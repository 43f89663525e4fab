"""``TerrainClearance`` on terrains of millions of posts, against a plain min/max quadtree."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks import oracle
from benchmarks.metric import Metric, Target, comparison, error
from benchmarks.peers.quadtree import QuadtreeGround
from benchmarks.scenes import above_ground
from benchmarks.timing import interleaved
from ompl_risk import TerrainClearance, terrains
from ompl_risk.terrains import Terrain

PEER = "quadtree"


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        posts: along each edge of the terrain, 1 m apart.
        roughness: pairs of Hurst exponent and rms slope, a terrain each.
        high, low: heights above the ground of the queries [m]; targets are for the first.
        bound: of the bounded queries [m].
        points: queries of ours in a repeat.
        peer_points: of these, how many the peer answers too.
        oracle_points: of these, how many are answered by trying every triangle that can matter.
        repeats: of every timing of queries.
        builds: repeats of building.
    """

    posts: int = 4000
    roughness: tuple[tuple[float, float], ...] = ((0.8, 0.3), (0.8, 1.3), (1.0, 0.3), (1.0, 1.3))
    high: float = 200.0
    low: float = 20.0
    bound: float = 100.0
    points: int = 5_000
    peer_points: int = 2_000
    oracle_points: int = 10
    repeats: int = 11
    builds: int = 5


QUICK = Config(roughness=((1.0, 1.3),), oracle_points=5, repeats=7, builds=3)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Time, error and memory over fractal terrains, one thread; see ``Config``."""
    for hurst, slope in config.roughness:
        label = f"H {hurst:g}, slope {slope:g}"
        say(f"{label}: making {config.posts} x {config.posts} posts")
        terrain = terrains.load(
            "fractal", shape=(config.posts, config.posts), spacing=(1.0, 1.0), seed=seed,
            hurst=hurst, rms_slope=slope,
        )  # fmt: skip
        say(f"{label}: building")
        yield from _building(terrain, config, label)
        ours, peer = TerrainClearance(terrain, threads=1), QuadtreeGround(terrain)
        rng = np.random.default_rng(seed)
        for height in (config.high, config.low):
            say(f"{label}: queries {height:g} m above ground")
            yield from _queries(ours, peer, config, f"{label}, {height:g} m up", height, rng)


def _building(terrain: Terrain, config: Config, label: str) -> Iterator[Metric]:
    seconds, peer_seconds = interleaved(
        config.builds,
        lambda _: TerrainClearance(terrain, threads=1),
        lambda _: QuadtreeGround(terrain),
    )
    yield comparison(
        f"{label}: build, one thread",
        seconds,
        "s",
        PEER,
        peer_seconds,
        target=Target(3.0),
        note="the peer is a plain quadtree of least and greatest heights, one thread as well",
    )
    heights = terrain.heights
    extra = [
        array.nbytes
        for array in TerrainClearance(terrain, threads=1).field
        if not np.shares_memory(array, heights)
    ]
    yield comparison(
        f"{label}: extra memory", np.array([sum(extra) / heights.nbytes]), "heights", PEER,
        np.array([QuadtreeGround(terrain).nbytes / heights.nbytes]),
        target=Target(1.5), note=f"heights take {heights.nbytes / 2**20:.0f} MiB",
    )  # fmt: skip


def _queries(
    ours: TerrainClearance,
    peer: QuadtreeGround,
    config: Config,
    label: str,
    height: float,
    rng: np.random.Generator,
) -> Iterator[Metric]:
    """Every repeat has points of its own, all over the map: nothing waits in a cache for them."""
    n, m, timed = config.points, config.peer_points, height == config.high
    points = above_ground(ours.terrain, (config.repeats + 1) * n, rng, low=height, high=height)
    points = points.reshape(config.repeats + 1, n, 3)
    for bound, limit in ((math.inf, 10.0), (config.bound, 1.0)):
        us, peer_us = _timed(ours, peer, config, points, bound)
        yield comparison(
            f"{label}: {'exact' if math.isinf(bound) else f'bounded at {bound:g} m'}",
            us, "us/query", PEER, peer_us, target=Target(limit) if timed else None,
        )  # fmt: skip
    shared = points[1, :m]
    d, bounded = ours(shared), ours(shared, bound=config.bound)
    cut = np.minimum(d, config.bound)
    worst = np.maximum(np.abs(d - peer.distances(shared)), np.abs(bounded - cut))
    yield error(f"{label}: error against {PEER}", worst, "m", 1e-9, f"{m} points, bounded too")
    tried = [oracle.distance_in_window(ours.terrain, x) for x in shared[: config.oracle_points]]
    yield error(
        f"{label}: error against all triangles", d[: len(tried)] - tried, "m", 1e-9,
        f"{len(tried)} points",
    )  # fmt: skip


def _timed(
    ours: TerrainClearance,
    peer: QuadtreeGround,
    config: Config,
    points: NDArray[np.float64],
    bound: float,
) -> NDArray[np.float64]:
    """Microseconds a query, shape (2, repeats)."""
    n, m = config.points, config.peer_points
    seconds = interleaved(
        config.repeats,
        lambda k: ours(points[k], bound=bound),
        lambda k: peer.distances(points[k, :m], bound),
    )
    return seconds * 1e6 / [[n], [m]]
