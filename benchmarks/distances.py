"""``TerrainClearance`` against every library of distances that is installed, on the same mesh."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks import oracle
from benchmarks.metric import Absent, Metric, Target, comparison, error, figure
from benchmarks.peers.ground import Ground
from benchmarks.peers.menu import PEERS, NotThereError, Offer
from benchmarks.scenes import above_ground
from benchmarks.timing import interleaved
from ompl_risk import TerrainClearance, terrains
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        terrain: name of the terrain.
        low, high: range of heights above the ground [m].
        points: queries in a repeat, of ours and of peers that take batches.
        single_points: of these, how many peers answer that take one query a call.
        oracle_points: of these, how many are answered by trying every triangle that can matter.
        repeats: of every timing.
    """

    terrain: str = "jacksboro"
    low: float = 20.0
    high: float = 100.0
    points: int = 100_000
    single_points: int = 8_000
    oracle_points: int = 20
    repeats: int = 15


QUICK = Config(points=30_000, single_points=2_000, oracle_points=5, repeats=5)


def measure(
    config: Config, seed: int, say: Callable[[str], None], offers: Sequence[Offer] = PEERS
) -> Iterator[Metric | Absent]:
    """Agreement first, then time in one thread and in all; see ``Config``."""
    terrain = terrains.load(config.terrain)
    rng = np.random.default_rng(seed)
    shape = (config.repeats + 1, config.points, 3)
    points = above_ground(terrain, shape[0] * shape[1], rng, low=config.low, high=config.high)
    points = points.reshape(shape)
    ours = TerrainClearance(terrain, threads=1)
    say("our answers against all triangles that can matter")
    d = ours(points[0])
    tried = [oracle.distance_in_window(terrain, each) for each in points[0, : config.oracle_points]]
    off = d[: len(tried)] - tried
    yield error("our error against all triangles", off, "m", 1e-9, f"{len(off)} points")
    peers: list[_Peer] = []
    for offer in offers:
        say(f"{offer.name}: loading, building, comparing the answers")
        found, metric = _prepared(offer, config, terrain, points[0], d)
        yield metric
        if found is not None:
            peers.append(found)
    if peers:
        say(f"{config.repeats} repeats of {len(peers) + 1} libraries, one thread")
        yield from _one_thread(ours, peers, config, points)
        say("the same, all threads")
        yield from _all_threads(TerrainClearance(terrain), peers, config, points)


@dataclass(frozen=True)
class _Peer:
    """A library that agrees with ours, and how many points it is asked for in a repeat."""

    name: str
    ground: Ground
    points: int


def _prepared(
    offer: Offer, config: Config, terrain: Terrain, points: Floats, d: Floats
) -> tuple[_Peer | None, Metric | Absent]:
    """A peer that computes the same as we do, and by how much it differs; or why there is none."""
    try:
        ground = offer.load()(terrain)
        count = config.points if ground.batched else config.single_points
        differences = np.abs(ground.distances(points[:count]) - d[:count])
    except NotThereError as absence:
        return None, Absent(offer.name, absence.reason, absence.remedy)
    except Exception as failure:  # whatever another version of somebody else's library raises
        return None, Absent(f"{offer.name} {offer.version}", "does not work", repr(failure))
    largest, tolerance = float(differences.max()), ground.tolerance
    agrees = largest <= tolerance
    differing = int(np.count_nonzero(~(differences <= tolerance)))
    verdict = (
        "agrees" if agrees else f"differs at {differing} of {count} points, so it is not timed"
    )
    metric = figure(
        f"{offer.name} {offer.version}: largest difference", largest, "m",
        target=Target(tolerance), note=verdict,
    )  # fmt: skip
    return (_Peer(offer.name, ground, count) if agrees else None), metric


def _one_thread(
    ours: TerrainClearance, peers: Sequence[_Peer], config: Config, points: Floats
) -> Iterator[Metric]:
    """By the processor time of the whole process: threads that a peer starts all the same count."""

    def ask(peer: _Peer) -> Callable[[int], object]:
        return lambda k: peer.ground.distances(points[k, : peer.points])

    seconds = interleaved(
        config.repeats, lambda k: ours(points[k]), *map(ask, peers), clock=time.process_time
    )
    yield from _rows("one thread", peers, config, seconds, lambda ground: ground.interface)


def _all_threads(
    ours: TerrainClearance, peers: Sequence[_Peer], config: Config, points: Floats
) -> Iterator[Metric]:
    """By the clock on the wall."""

    def ask(peer: _Peer) -> Callable[[int], object]:
        return lambda k: peer.ground.distances_threaded(points[k, : peer.points])

    seconds = interleaved(
        config.repeats, lambda k: ours(points[k]), *map(ask, peers), clock=time.perf_counter
    )

    def how(ground: Ground) -> str:
        return f"{ground.threading}; ours {ours.threads} threads"

    yield from _rows("all threads, on the wall", peers, config, seconds, how)


def _rows(
    name: str,
    peers: Sequence[_Peer],
    config: Config,
    seconds: Floats,
    how: Callable[[Ground], str],
) -> Iterator[Metric]:
    ours = seconds[0] * 1e6 / config.points
    for peer, theirs in zip(peers, seconds[1:], strict=True):
        yield comparison(
            f"{name}, {peer.name}", ours, "us/query", peer.name, theirs * 1e6 / peer.points,
            note=f"{peer.name}: {how(peer.ground)}; {peer.points} points a repeat",
        )  # fmt: skip
