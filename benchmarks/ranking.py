"""``rank`` and ``collision_probabilities`` for many trajectories, against python-fcl and numpy."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks.metric import Metric, Target, Tolerance, comparison, error, figure
from benchmarks.peers.fcl_ground import FclGround
from benchmarks.peers.fcl_planning import inverse_distance, squared_sobolev
from benchmarks.scenes import weaving
from benchmarks.timing import interleaved
from ompl_risk import (
    ColumnQuadrature,
    InverseDistance,
    Lp,
    Norm,
    Sobolev,
    TerrainClearance,
    Trajectory,
    rank,
    terrains,
)
from ompl_risk.probability import collision_probabilities
from ompl_risk.ranking import Ranking
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]
NORMS: tuple[Norm, ...] = (Lp(1), Lp(2), Lp(math.inf), Sobolev(1))


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        terrain: name of the terrain.
        trajectories: to be ranked together.
        states: of each trajectory.
        start, goal: (x, y) of all trajectories [m].
        radius: of the vehicle [m].
        d0: distance from which the ground poses no danger [m].
        ball: radius of the ball of possible positions [m].
        shared: trajectories that the peer does too.
        repeats: of every timing.
    """

    terrain: str = "jacksboro"
    trajectories: int = 50
    states: int = 1000
    start: tuple[float, float] = (10000.0, 16000.0)
    goal: tuple[float, float] = (22000.0, 25000.0)
    radius: float = 5.0
    d0: float = 100.0
    ball: float = 100.0
    shared: int = 3
    repeats: int = 15


QUICK = Config(repeats=7, shared=2)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Time of the whole ranking, and time and error beside the peer's; see ``Config``."""
    terrain = terrains.load(config.terrain)
    candidates = weaving(
        terrain, config.trajectories, config.states, np.random.default_rng(seed),
        start=config.start, goal=config.goal,
    )  # fmt: skip
    clearance = TerrainClearance(terrain, radius=config.radius)
    say(f"{config.repeats} repeats of ranking {config.trajectories} trajectories")
    yield from _whole(config, candidates, clearance)
    say(f"the same states of {config.shared} trajectories with python-fcl and numpy")
    yield from _beside_peer(config, candidates[: config.shared], terrain)


def ranked(
    candidates: list[Trajectory],
    clearance: TerrainClearance,
    config: Config,
    max_step: Literal["auto"] | None,
) -> Ranking:
    """The ranking by four norms, each of f and of P_c.

    Args:
        candidates: what is ranked.
        clearance: from the ground.
        config: for d0 and the ball.
        max_step: "auto" for the library's own refinement, None for the states as they are.
    """
    profiles = collision_probabilities(candidates, clearance, config.ball, max_step=max_step)
    avoidance = InverseDistance(config.d0)
    return rank(candidates, clearance, avoidance, NORMS, max_step=max_step, probability=profiles)


def _whole(
    config: Config, candidates: list[Trajectory], clearance: TerrainClearance
) -> Iterator[Metric]:
    """As users call it: refined, over all processors."""

    def work(_: int) -> Ranking:
        return ranked(candidates, clearance, config, "auto")

    wall = interleaved(config.repeats, work, clock=time.perf_counter)
    busy = interleaved(config.repeats, work, clock=time.process_time)
    samples = sum(len(assessment.d) for assessment in work(0).assessments)
    name = f"rank {config.trajectories} x {config.states} states, 4 norms and P_c"
    yield figure(
        f"{name}, on the wall", wall[0], "s", target=Target(0.3),
        note=f"{clearance.threads} threads; refined to {samples} samples; other jobs disturb it",
        tolerance=Tolerance(4.0, of="yardstick"),
    )  # fmt: skip
    yield figure(f"{name}, processor time", busy[0], "s", note="of all threads")


def _beside_peer(
    config: Config, candidates: list[Trajectory], terrain: Terrain
) -> Iterator[Metric]:
    """One thread, the states as they are, so that both compute the same."""
    ours = TerrainClearance(terrain, radius=config.radius, threads=1)
    peer = Plain(terrain, config)
    seconds = interleaved(
        config.repeats,
        lambda _: ranked(candidates, ours, config, None),
        lambda _: [peer.norms(each) for each in candidates],
    )
    ours_ms, peer_ms = seconds * 1e3 / len(candidates)
    yield comparison(
        "one trajectory, states as given", ours_ms, "ms", "python-fcl and numpy", peer_ms,
        note="one thread; the peer's P_c by as many columns, vectorised over states",
    )  # fmt: skip
    ranking = ranked(candidates, ours, config, None)
    found = [[*a.norms.values(), *a.pc_norms.values()] for a in ranking.assessments]
    expected = np.array([peer.norms(each) for each in candidates])
    yield error(
        "norms of f and P_c, relative error", np.array(found) / expected - 1.0, "", 1e-9,
        f"{expected.size} norms, against python-fcl and numpy",
    )  # fmt: skip


class Plain:
    """The norms as one would write them with python-fcl and numpy, at the states as given."""

    def __init__(self, terrain: Terrain, config: Config) -> None:
        self._terrain, self._config = terrain, config
        self._ground = FclGround(terrain, config.radius)
        self._columns = ColumnQuadrature().columns()

    def norms(self, trajectory: Trajectory) -> list[float]:
        """L1, L2, L-infinity and H1 of f, then of P_c."""
        f = inverse_distance(self._ground.distances(trajectory.positions), self._config.d0)
        p = self.probability(trajectory.positions)
        return [norm for g in (f, p) for norm in four_norms(trajectory.t, g)]

    def probability(self, positions: Floats) -> Floats:
        """Share of the ball that is ground, by the library's columns; the map has to reach."""
        r = self._config.ball
        x, y, half, weight, _ = self._columns.T
        centre = positions[:, :, None]
        height = self._terrain.height(centre[:, 0] + r * x, centre[:, 1] + r * y)
        filled = np.clip(height - (centre[:, 2] - r * half), 0.0, 2.0 * r * half)
        return filled @ weight / (2.0 * r)


def four_norms(t: Floats, g: Floats) -> list[float]:
    """L1, L2, L-infinity and H1 of what runs straight between samples g >= 0."""
    dt, a, b = np.diff(t), g[:-1], g[1:]
    mean = float((dt * (a + b)).sum() / 2.0)
    square = float((dt * (a * a + a * b + b * b)).sum() / 3.0)
    return [mean, math.sqrt(square), float(g.max()), math.sqrt(squared_sobolev(g, dt))]
