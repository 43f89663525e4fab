"""RRT* with ``RiskObjective`` against RRT* with the same objective on python-fcl."""

from __future__ import annotations

import math
import multiprocessing
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from ompl import geometric as og

from benchmarks import planning
from benchmarks.metric import LIMIT_ONLY, Metric, Target, Tolerance, comparison, figure
from benchmarks.peers.fcl_ground import FclGround
from benchmarks.peers.fcl_planning import inverse_distance, squared_sobolev
from benchmarks.planning import Method, Plan, Problem
from benchmarks.scenes import above_ground
from benchmarks.timing import interleaved
from ompl_risk import TerrainClearance, Trajectory, terrains
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]
PEER = "on python-fcl"

LITTLE = 1e-6
"""A cost [s/m^2] that does not matter: a second at 91 m from the ground, for d0 = 100 m."""


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        problem: what is planned.
        seconds: processor time for each planner.
        seeds: runs of each planner.
        motions: free motions on which single costs are compared.
        longest: length of these [m], at most.
        repeats: of the timing of single costs.
        fine: step of the reference [m].
        in_processes: each planner in a process of its own, as fresh as can be.
    """

    problem: Problem = field(default_factory=Problem)
    seconds: float = 10.0
    seeds: int = 5
    motions: int = 200
    longest: float = 3000.0
    repeats: int = 7
    fine: float = 0.25
    in_processes: bool = True


QUICK = Config(seconds=5.0, seeds=1, motions=40, repeats=5)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Motion costs a second, their error, and the cost of what RRT* finds; see ``Config``."""
    terrain = terrains.load(config.problem.terrain)
    ground = FclGround(terrain, config.problem.radius)
    say(f"{config.motions} free motions")
    yield from _single_costs(config, terrain, np.random.default_rng(seed))
    ours: list[Plan] = []
    peer: list[Plan] = []
    for k in range(config.seeds):
        runs: tuple[tuple[Method, list[Plan]], ...] = ("ours", ours), ("python-fcl", peer)
        for method, plans in runs:
            say(f"RRT* for {config.seconds:g} s, seed {seed + k}: {method}")
            plans.append(_run(method, config, seed + k))
    yield comparison(
        "motion costs in RRT*", _rates(ours), "1/s", PEER, _rates(peer), better="higher",
        target=Target(20.0, of="advantage"), note="per second of the whole planner",
    )  # fmt: skip
    judged = [
        [judge(plan.corners, terrain, ground, config.problem) for plan in plans]
        for plans in (ours, peer)
    ]
    costs, peer_costs = (np.array([cost for cost, _ in each]) for each in judged)
    found = [sum(len(plan.corners) > 0 for plan in plans) for plans in (ours, peer)]
    yield comparison(
        f"squared H1 norm after {config.seconds:g} s", costs, "s/m^2", PEER, peer_costs,
        target=Target(1.0, of="advantage"),
        note=f"paths found: ours {found[0]}, {PEER} {found[1]} of {config.seeds}; seconds of "
        "processor time; judged by python-fcl every metre",
        tolerance=Tolerance(3.0),  # the peer often finds nothing, and then there is no ratio
    )  # fmt: skip
    clearances = [d for _, d in judged[0] if math.isfinite(d)]
    if clearances:
        yield figure(
            "least clearance of our paths", min(clearances), "m", better="higher",
            target=Target(0.0, correctness=True), note="by python-fcl every metre",
            tolerance=LIMIT_ONLY,
        )  # fmt: skip


def judge(
    corners: Floats, terrain: Terrain, ground: FclGround, problem: Problem, step: float = 1.0
) -> tuple[float, float]:
    """Squared H^1 norm of a path and its least clearance [m], by python-fcl and numpy alone.

    Returns:
        (inf, inf) for no path, (inf, d) for a path in collision.
    """
    if len(corners) == 0:
        return math.inf, math.inf
    path = Trajectory.at_constant_speed(corners, problem.speed).densify(step)
    d = ground.distances(path.positions)
    x, y, z = path.positions.T
    d = np.where(z > terrain.height(x, y), d, -np.inf)
    if d.min() <= 0.0:
        return math.inf, float(d.min())
    f = inverse_distance(d, problem.d0)
    return squared_sobolev(f, np.diff(path.t)), float(d.min())


def _run(method: Method, config: Config, seed: int) -> Plan:
    arguments = method, config.problem, config.seconds, seed
    if not config.in_processes:
        return planning.plan(*arguments)
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        return pool.submit(planning.plan, *arguments).result()


def _rates(plans: list[Plan]) -> Floats:
    return np.array([plan.motion_costs / plan.seconds for plan in plans])


def _single_costs(config: Config, terrain: Terrain, rng: np.random.Generator) -> Iterator[Metric]:
    """Time and error of the cost of single motions, the same for both objectives."""
    problem = config.problem
    setups = [og.SimpleSetup(problem.space(terrain)) for _ in range(2)]
    ours = planning.install_ours(setups[0], terrain, problem)
    peer = planning.install_peer(setups[1], terrain, problem)
    clearance = TerrainClearance(terrain, problem.radius)
    motions, exact = _free_motions(config, terrain, clearance, rng)
    si = setups[0].getSpaceInformation()
    states = [[planning.as_state(si, end) for end in ends] for ends in motions]
    found = np.empty((2, len(states)))

    def evaluate(row: int, objective: planning.CountedObjective | planning.FclObjective) -> None:
        for k, (a, b) in enumerate(states):
            found[row, k] = objective.motionCost(a, b).value()

    seconds = interleaved(config.repeats, lambda _: evaluate(0, ours), lambda _: evaluate(1, peer))
    us, peer_us = seconds * 1e6 / len(states)
    lengths = np.linalg.norm(motions[:, 1] - motions[:, 0], axis=1)
    yield comparison(
        "cost of one free motion", us, "us", PEER, peer_us,
        note=f"mean length {lengths.mean():.0f} m, {lengths.mean() / problem.step:.0f} "
        f"distances at the peer's step of {problem.step:g} m",
    )  # fmt: skip
    errors = _rms_relative(found, exact)
    yield comparison(
        "rms relative error of a cost", errors[:1], "", PEER, errors[1:],
        target=Target(1e-2, correctness=True),
        note=f"{len(exact)} motions, against samples {config.fine:g} m apart",
    )  # fmt: skip


def _rms_relative(found: Floats, exact: Floats) -> Floats:
    """Root mean square of errors over the cost, or over LITTLE where the cost is less."""
    return np.sqrt(np.mean(((found - exact) / np.maximum(exact, LITTLE)) ** 2, axis=1))


def _free_motions(
    config: Config, terrain: Terrain, clearance: TerrainClearance, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Random free motions under the ceiling, (n, 2, 3), and their cost by dense sampling."""
    low, high = config.problem.box(terrain).T
    motions: list[Floats] = []
    costs: list[float] = []
    while len(motions) < config.motions:
        start = above_ground(terrain, 1, rng, low=10.0, high=100.0, margin=config.longest)[0]
        ray = rng.standard_normal(3) * (1.0, 1.0, 0.02)
        end = start + rng.uniform(0.1, 1.0) * config.longest * ray / np.linalg.norm(ray)
        if end[2] > high[2] or end[2] < low[2] or start[2] > high[2]:
            continue
        path = Trajectory.at_constant_speed([start, end], config.problem.speed).densify(config.fine)
        d = clearance(path.positions)
        if d.min() > 1.0:
            motions.append(np.array([start, end]))
            f = inverse_distance(d, config.problem.d0)
            costs.append(squared_sobolev(f, path.duration / (len(path) - 1)))
    return np.array(motions), np.array(costs)
