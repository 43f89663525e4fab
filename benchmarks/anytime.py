"""``RiskRoadmap`` against RRT* and BIT* with our objective: time to a cost, and the paths."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from benchmarks import convergence
from benchmarks.convergence import Name, Run
from benchmarks.metric import LIMIT_ONLY, Metric, Target, comparison, error, figure
from benchmarks.objective import judge
from benchmarks.peers.fcl_ground import FclGround
from benchmarks.planning import Problem
from ompl_risk import terrains
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]
PEERS: tuple[Name, ...] = tuple(name for name in get_args(Name) if name != "RiskRoadmap")


def _diagonal() -> Problem:
    return Problem(start=(2500.0, 3500.0), goal=(27500.0, 28500.0))


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        problem: what is planned.
        seconds: for each of OMPL's planners, of processor time.
        ours: for ``RiskRoadmap``, on the wall.
        short: for ``RiskRoadmap`` in runs of their own, on the wall: what the target is about.
        seeds: runs of each planner.
        in_processes: each run in a process of its own.
    """

    problem: Problem = field(default_factory=_diagonal)
    seconds: float = 30.0
    ours: float = 10.0
    short: float = 1.0
    seeds: int = 5
    in_processes: bool = True


QUICK = Config(seconds=5.0, ours=3.0, seeds=1)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Time to the cost that each peer ends with, and the costs of the paths; see ``Config``."""
    terrain = terrains.load(config.problem.terrain)
    lengths = {"RiskRoadmap": config.ours, **dict.fromkeys(PEERS, config.seconds)}
    runs: dict[str, list[Run]] = {name: [] for name in lengths}
    brief: list[Run] = []
    go = convergence.in_process if config.in_processes else convergence.run
    for k in range(config.seeds):
        for name in get_args(Name):
            say(f"{name} for {lengths[name]:g} s, seed {seed + k}")
            runs[name].append(go(name, config.problem, lengths[name], seed + k))
        say(f"RiskRoadmap for {config.short:g} s, seed {seed + k}")
        brief.append(go("RiskRoadmap", config.problem, config.short, seed + k))
    ours = runs.pop("RiskRoadmap")
    for name, peer in runs.items():
        yield _time_to_cost(ours, name, peer, config)
    yield from _judged(ours, brief, runs, terrain, config)


def _time_to_cost(ours: list[Run], name: str, peer: list[Run], config: Config) -> Metric:
    """Seed by seed: when we have what the peer ends with, and when the peer itself had it."""
    costs = ", ".join(f"{run.cost:.3g}" for run in peer)
    pairs = zip(ours, peer, strict=True)
    when = [(run.seconds_to(p.cost), p.seconds_to(p.cost)) for run, p in pairs if p.cost < math.inf]
    found = np.array(when).reshape(-1, 2)
    if not len(found):
        return figure(f"time to the cost of {name}", 0.0, "s", note=f"{name} found no path")
    return comparison(
        f"time to the cost that {name} has after {config.seconds:g} s", found[:, 0], "s", name,
        found[:, 1], target=Target(1.0),
        note=f"costs {costs} s/m^2 by the objective's account; "
        f"ours on the wall, {name}'s in processor time",
    )  # fmt: skip


def _judged(
    ours: list[Run], brief: list[Run], peers: dict[str, list[Run]], terrain: Terrain, config: Config
) -> Iterator[Metric]:
    """Costs of the last paths by python-fcl and numpy, and whether they are free."""
    ground = FclGround(terrain, config.problem.radius)

    def costs(runs: list[Run]) -> tuple[Floats, Floats]:
        judged = [judge(run.corners, terrain, ground, config.problem) for run in runs]
        return np.array([cost for cost, _ in judged]), np.array([d for _, d in judged])

    (early, d_early), (late, d_late) = costs(brief), costs(ours)
    for name, runs in peers.items():
        theirs, _ = costs(runs)
        for seconds, found in ((config.short, early), (config.ours, late)):
            yield comparison(
                f"cost after {seconds:g} s, {name}'s after {config.seconds:g} s", found, "s/m^2",
                name, theirs, target=Target(1.0, of="advantage"),
                note="squared H1 norm; judged by python-fcl every metre",
            )  # fmt: skip
    accounts = np.array([run.cost for run in (*brief, *ours)])
    judged = np.concatenate([early, late])
    known = np.isfinite(accounts)
    if known.any():
        yield error(
            "our costs against the judge's, relative", accounts[known] / judged[known] - 1.0, "",
            2e-2, f"{np.count_nonzero(known)} paths; the judge samples every metre",
        )  # fmt: skip
        yield figure(
            "least clearance of our paths", min(*d_early, *d_late), "m", better="higher",
            target=Target(0.0, correctness=True), note="by python-fcl every metre",
            tolerance=LIMIT_ONLY,
        )  # fmt: skip
