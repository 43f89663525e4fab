"""Roadmaps with H^1 edges: time, growth, memory, and alternatives from them.

Two kinds of the same roadmap: with the exact risk of the edges that a search for the best path
needs, as ``RiskRoadmap`` makes it, and with that of every edge, its worst case.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import geometric as og

from benchmarks.metric import LIMIT_ONLY, Metric, Target, Tolerance, figure
from benchmarks.planning import Problem
from benchmarks.timing import interleaved
from ompl_risk import InverseDistance, RiskObjective, Sobolev, TerrainClearance, terrains
from ompl_risk.planners.roadmap.alternatives import alternatives
from ompl_risk.planners.roadmap.exploring import alternative_routes
from ompl_risk.planners.roadmap.roadmap import Roadmap
from ompl_risk.planners.roadmap.setting import read_setting
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]

FIRST, GROWTH = 1000, 0.5
"""Batches as ``RiskRoadmap`` grows them: so many states, then half as many as there are."""


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        problem: what is planned.
        vertices: of the roadmap that is timed.
        sizes: vertices of the roadmaps whose times are compared, the first with all others.
        complete_sizes: the same with every edge evaluated.
        alternatives: how many are asked for.
        excess: of their duration over the fastest.
        apart: least Frechet distance between two of them [m].
        repeats: of the timing of the first roadmap and of the alternatives.
    """

    problem: Problem = field(
        default_factory=lambda: Problem(start=(2500.0, 3500.0), goal=(27500.0, 28500.0))
    )
    vertices: int = 10_000
    sizes: tuple[int, ...] = (10_000, 50_000, 200_000)
    complete_sizes: tuple[int, ...] = (10_000, 200_000)
    alternatives: int = 50
    excess: float = 0.05
    apart: float = 700.0
    repeats: int = 5


QUICK = Config(sizes=(10_000, 40_000), complete_sizes=(), repeats=3)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Times of building and of alternatives, growth and memory; see ``Config``."""
    terrain = terrains.load(config.problem.terrain)
    maker = Maker(config.problem, terrain, seed)
    for kind, complete in (("edges as a search needs them", False), ("every edge", True)):
        say(f"{config.repeats} roadmaps of {config.vertices} vertices, {kind}")
        yield from _building(maker, config, kind, complete)
    yield from _alternatives(maker, config, say)
    yield from _growth(maker, config.sizes, False, say)
    yield from _growth(maker, config.complete_sizes, True, say)


def _building(maker: Maker, config: Config, kind: str, complete: bool) -> Iterator[Metric]:
    made: list[Roadmap] = []

    def build(_: int) -> None:
        made[:] = [maker.of(config.vertices, complete=complete)]

    wall = interleaved(config.repeats, build, clock=time.perf_counter)
    roadmap, name = made[0], f"{config.vertices} vertices, {kind}"
    yield figure(
        f"{name}, on the wall", wall[0], "s", target=Target(1.0),
        note=f"{roadmap.n} vertices, {roadmap.edges.m} edges, of {roadmap.evaluated} the H1 risk; "
        "all threads",
        tolerance=Tolerance(4.0, of="yardstick"),
    )  # fmt: skip
    yield figure(f"{name}: evaluated", roadmap.evaluated, "edges")


class Maker:
    """Makes roadmaps of a problem.

    Args:
        problem: the problem.
        terrain: its terrain.
        seed: of the samples.
    """

    def __init__(self, problem: Problem, terrain: Terrain, seed: int) -> None:
        self._setup = og.SimpleSetup(problem.space(terrain))
        self._si: Any = self._setup.getSpaceInformation()
        clearance = TerrainClearance(terrain, problem.radius)
        self._objective: Any = RiskObjective(
            self._si, clearance, InverseDistance(problem.d0), Sobolev(1), speed=problem.speed
        )
        self._ends, self._seed = problem.ends(terrain), seed

    def empty(self) -> Roadmap:
        """A roadmap without vertices."""
        setting = read_setting(self._si, self._objective, seed=self._seed)
        return Roadmap(setting.region, setting.motions, setting.risk, gate=setting.gate)

    def of(self, n: int, *, complete: bool) -> Roadmap:
        """One with the ends and some n vertices, as not all samples are free.

        Args:
            n: number of vertices.
            complete: find the risk of every edge, not only of those that the best path needs.
        """
        roadmap = self.empty()
        roadmap.add_starts(self._ends[:1])
        roadmap.add_goals(self._ends[1:])
        share = 1.0
        while roadmap.n < 0.99 * n:
            batch = min(max(FIRST, GROWTH * roadmap.n), n - roadmap.n)
            tried = math.ceil(batch / share)
            share = max(roadmap.grow(tried) / tried, 0.1)
        if complete:
            roadmap.evaluate(np.arange(roadmap.edges.m, dtype=np.int32), *roadmap.edges.ends())
        else:
            roadmap.search()
        return roadmap


def _alternatives(maker: Maker, config: Config, say: Callable[[str], None]) -> Iterator[Metric]:
    """Asked of a roadmap as ``RiskRoadmap`` leaves it, and of a graph whose edges are all known."""
    count, excess, apart = config.alternatives, config.excess, config.apart
    say(f"{count} alternatives")
    seconds, found = [], 0
    for _ in range(config.repeats + 1):  # the first compiles
        roadmap = maker.of(config.vertices, complete=False)
        begin = time.perf_counter()
        found = len(alternative_routes(roadmap, count, excess=excess, min_distance=apart))
        seconds.append(time.perf_counter() - begin)
    tolerance = Tolerance(4.0, of="yardstick")
    name = f"{count} alternatives, on the wall"
    yield figure(
        name, seconds[1:], "s", target=Target(1.0), tolerance=tolerance,
        note=f"within {excess:.0%} of the least time, {apart:g} m apart, from "
        f"{config.vertices} vertices; includes the risk of the edges that come into question",
    )  # fmt: skip
    yield figure("alternatives found", found, "", better="higher", target=Target(float(count)))
    roadmap = maker.of(config.vertices, complete=True)
    graph = roadmap.graph()
    ends = roadmap.states, roadmap.starts[0], roadmap.goals
    wall = interleaved(
        config.repeats,
        lambda _: alternatives(graph, *ends, count=count, excess=excess, min_distance=apart),
        clock=time.perf_counter,
    )
    yield figure(
        f"{name}, every edge known before", wall[0], "s", target=Target(1.0), tolerance=tolerance
    )


def _growth(
    maker: Maker, sizes: tuple[int, ...], complete: bool, say: Callable[[str], None]
) -> Iterator[Metric]:
    """Processor time of larger roadmaps over that of the smallest, and memory of each."""
    kind = ", every edge" if complete else ""
    unit = math.nan  # seconds for each n log n in the first
    for n in sizes:
        say(f"a roadmap of {n} vertices{kind}")
        before, begin = resident(), time.process_time()
        roadmap = maker.of(n, complete=complete)
        work = roadmap.n * math.log(roadmap.n)
        spent = (time.process_time() - begin) / work
        if math.isnan(unit):
            unit = spent
            continue
        yield figure(
            f"time for {n} vertices{kind}, over n log n", spent / unit, "", target=Target(1.3),
            note=f"1 for {sizes[0]} vertices; processor time, each built once",
            tolerance=Tolerance(0.5),
        )  # fmt: skip
        yield figure(
            f"memory of {n} vertices{kind}", roadmap.nbytes / roadmap.n, "B/vertex",
            target=Target(1000.0), note="all arrays of the roadmap, edges included",
        )  # fmt: skip
        grown = (resident() - before) / roadmap.n
        if math.isfinite(grown):
            yield figure(
                f"memory of {n} vertices{kind}, as the process grew", grown, "B/vertex",
                note="resident memory after building, less before", tolerance=LIMIT_ONLY,
            )  # fmt: skip


def resident() -> float:
    """Resident memory of this process [B]; NaN where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    except OSError:
        return math.nan
    import resource

    return float(pages * resource.getpagesize())
