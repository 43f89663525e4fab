"""``TerrainClearance`` against python-fcl on the real terrain."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks import oracle
from benchmarks.metric import Metric, Target, Tolerance, comparison, error, figure
from benchmarks.peers.fcl_ground import FclGround
from benchmarks.scenes import above_ground
from benchmarks.timing import interleaved
from ompl_risk import TerrainClearance, terrains
from ompl_risk.motion import Risk, TerrainMotion


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        terrain: name of the terrain.
        low, high: range of heights above the ground [m].
        points: queries of ours in a repeat.
        fcl_points: of these, how many python-fcl answers too.
        oracle_points: of these, how many are answered by trying every triangle.
        single_points: queries one at a time.
        repeats: of every timing.
    """

    terrain: str = "jacksboro"
    low: float = 20.0
    high: float = 100.0
    points: int = 100_000
    fcl_points: int = 8_000
    oracle_points: int = 20
    single_points: int = 2_000
    repeats: int = 31


QUICK = Config(points=50_000, fcl_points=4_000, oracle_points=5, repeats=15)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Time and error of exact, unbounded distances; see ``Config``."""
    say("building both search structures")
    terrain = terrains.load(config.terrain)
    ours, peer = TerrainClearance(terrain, threads=1), FclGround(terrain)
    rng = np.random.default_rng(seed)
    n, m = config.points, config.fcl_points
    shape = (config.repeats + 1, n, 3)
    points = above_ground(terrain, shape[0] * n, rng, low=config.low, high=config.high)
    points = points.reshape(shape)
    say(f"{config.repeats} repeats of {n} and {m} queries")
    seconds = interleaved(
        config.repeats, lambda k: ours(points[k]), lambda k: peer.distances(points[k, :m])
    )
    ours_us, peer_us = seconds * 1e6 / [[n], [m]]
    yield comparison(
        "exact distance, one thread", ours_us, "us/query", "python-fcl", peer_us,
        target=Target(50.0, of="advantage"),
        note=f"{peer.triangles} triangles; python-fcl: one search a call, called in a loop",
    )  # fmt: skip
    say("comparing the answers")
    shared = points[1, :m]
    d = ours(shared)
    yield error("error against python-fcl", d - peer.distances(shared), "m", 1e-6, f"{m} points")
    tried = [oracle.distance(terrain, point) for point in shared[: config.oracle_points]]
    yield error(
        "error against all triangles", d[: len(tried)] - tried, "m", 1e-9, f"{len(tried)} points"
    )
    say("batches over threads, single queries")
    yield _batch(ours, TerrainClearance(terrain), config, points)
    yield from _single(ours, peer, config, points[0])


def _batch(
    one: TerrainClearance, every: TerrainClearance, config: Config, points: np.ndarray
) -> Metric:
    """The same batch over all processors."""
    seconds = interleaved(
        config.repeats, lambda k: every(points[k]), lambda k: one(points[k]),
        clock=time.perf_counter,
    )  # fmt: skip
    every_us, one_us = seconds * 1e6 / config.points
    return comparison(
        "exact distance, all threads", every_us, "us/query", "ours, 1 thread", one_us,
        note=f"{every.threads} threads, batches of {config.points}; time on the wall, so other "
        "jobs disturb it",
        tolerance=Tolerance(2.0, of="advantage"),
    )  # fmt: skip


def _single(
    ours: TerrainClearance, peer: FclGround, config: Config, points: np.ndarray
) -> Iterator[Metric]:
    """One query a call: through the public call, and through the buffer that planners use."""
    points, count = points[: config.single_points], config.single_points
    model = TerrainMotion(ours, Risk(speed=1.0))

    def from_buffer(_: int) -> None:
        for point in points:
            model.a[:] = point
            model.clearance()

    def from_call(_: int) -> None:
        for point in points:
            ours(point[None])

    seconds = interleaved(config.repeats, from_buffer, from_call, lambda _: peer.distances(points))
    buffer_us, call_us, peer_us = seconds * 1e6 / count
    yield comparison(
        "one query a call, as planners ask", buffer_us, "us/query", "python-fcl", peer_us,
        note="copies the point into a buffer, then one compiled call",
    )  # fmt: skip
    yield figure("one query a call, public", call_us, "us/query", note="checks its arguments")
