"""Roadmaps of trajectory primitives: time to build one, and to find alternatives in it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.metric import Metric, Target, Tolerance, error, figure
from ompl_risk import TerrainClearance, terrains
from ompl_risk.cli.settings import PLACES
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.steering import HelicopterSteering
from ompl_risk.motion import Risk
from ompl_risk.planners import Problem, low_level_flight
from ompl_risk.planners.roadmap.exploring import alternative_routes
from ompl_risk.planners.roadmap.flights import flight_roadmap

SLOWER = Tolerance(4.0, of="yardstick")


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        terrain: name or file.
        start, goal: (x, y) [m], where flights hover 60 m above the ground.
        places: of the roadmap, as many as are free, each with a vertex for every cruise speed.
        alternatives: how many are asked for.
        excess: of their duration over the fastest.
        apart: least Frechet distance between two of them [m].
        connections: pairs of vertices to connect, for the time of one.
        repeats: of everything.
    """

    terrain: str = "jacksboro"
    start: tuple[float, float] = PLACES["jacksboro"]["start"]
    goal: tuple[float, float] = PLACES["jacksboro"]["goal"]
    places: int = 3000
    alternatives: int = 50
    excess: float = 0.05
    apart: float = 300.0
    connections: int = 200_000
    repeats: int = 5


QUICK = Config(connections=50_000, repeats=3)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Times of roadmap, alternatives, flights and connections; see ``Config``."""
    clearance = TerrainClearance(terrains.load(config.terrain), 5.0)
    problem = low_level_flight(clearance, config.start, config.goal)
    steering = HelicopterSteering()
    say(f"{config.repeats} roadmaps of {config.places} places, {config.alternatives} alternatives")
    yield from _roadmaps(config, problem, steering, seed)
    say(f"{config.connections} connections")
    yield from _connections(config, problem, steering, seed)


def _roadmaps(
    config: Config, problem: Problem, steering: HelicopterSteering, seed: int
) -> Iterator[Metric]:
    built, found, flown = [], [], []
    roadmap, routes, flights = None, (), []
    sampled = _sampled(config.places, problem, steering, seed)  # compiles
    for _ in range(config.repeats + 1):
        begin = time.perf_counter()
        roadmap = flight_roadmap(problem, steering, places=sampled, seed=seed + 1)
        middle = time.perf_counter()
        routes = alternative_routes(
            roadmap, config.alternatives, excess=config.excess, min_distance=config.apart
        )
        end = time.perf_counter()
        flights = [steering.flight(roadmap.states[route.vertices]) for route in routes]
        built.append(middle - begin)
        found.append(end - middle)
        flown.append((time.perf_counter() - end) / max(len(routes), 1))
    if roadmap is None:
        return
    name = f"{config.places} places, {config.alternatives} alternatives"
    note = (
        f"{roadmap.n} vertices, {roadmap.edges.m} edges, the H1 risk of {roadmap.evaluated} of "
        "them; on the wall, all threads"
    )
    both = [a + b for a, b in zip(built[1:], found[1:], strict=True)]
    yield figure(name, both, "s", target=Target(10.0), note=note, tolerance=SLOWER)
    yield figure(f"{name}: the roadmap alone", built[1:], "s", tolerance=SLOWER)
    yield figure(
        "alternatives found", len(routes), "", better="higher",
        target=Target(float(config.alternatives)),
    )  # fmt: skip
    yield figure(
        "flight along a route", flown[1:], "s", tolerance=SLOWER,
        note="inputs and states at 50 Hz, corrections included",
    )  # fmt: skip
    yield from _exactness(flights)


def _exactness(flights: list[Flight]) -> Iterator[Metric]:
    """How far flights are from what their inputs lead to, and from what was planned."""
    nothing = [math.nan]  # which is wrong: without a flight nothing was shown
    length = max((one.length for one in flights), default=0.0)
    note = f"{len(flights)} flights of up to {length / 1000:.1f} km"
    replayed = [float(np.abs(one.replay() - one.states).max()) for one in flights]
    name = "replay of the inputs, from the flight"
    yield error(name, replayed or nothing, "", 0.0, f"{note}; any of the 13 numbers of a state")
    apart = [one.deviation for one in flights]
    distances, angles = [one.distance for one in apart], [one.degrees for one in apart]
    yield error("flight, from the plan", distances or nothing, "m", 0.5, note)
    yield error("attitude of the flight, from the plan", angles or nothing, "deg", 1.0, note)


def _sampled(places: int, problem: Problem, steering: HelicopterSteering, seed: int) -> int:
    """How many places to sample so that so many are free."""
    sampled = places
    while True:
        roadmap = flight_roadmap(problem, steering, places=sampled, seed=seed + 1)
        free = (roadmap.n - len(roadmap.starts) - len(roadmap.goals)) // roadmap.region.copies
        if free >= places:
            return sampled
        sampled = int(1.01 * sampled * places / max(free, 1)) + 1


def _connections(
    config: Config, problem: Problem, steering: HelicopterSteering, seed: int
) -> Iterator[Metric]:
    """Time of a connection between vertices 300 to 700 m apart with any headings."""
    a, b = _neighbours(config.connections, problem, steering, seed)
    motions: Any = steering.batch(
        problem.clearance, Risk(problem.avoidance, speed=steering.speed), threads=1
    )
    exist = np.isfinite(motions.durations(a, b))
    few = slice(0, len(a) // 10)
    for name, work, n in (
        ("a connection: its duration", lambda: motions.durations(a, b), len(a)),
        ("a connection: its H1 risk", lambda: motions.costs(a[few], b[few]), len(a[few])),
    ):
        seconds = []
        for _ in range(config.repeats + 1):
            begin = time.thread_time()
            work()
            seconds.append(1e6 * (time.thread_time() - begin) / n)
        note = f"one thread; {exist.mean():.0%} of the pairs have a connection"
        yield figure(name, seconds[1:], "us", note=note, tolerance=SLOWER)


def _neighbours(n: int, problem: Problem, steering: HelicopterSteering, seed: int) -> Any:
    random = np.random.default_rng(seed)
    margin = np.array([800.0, 800.0, 0.0])
    low, high = problem.low + margin, problem.high - margin
    copies = len(steering.cruise)
    places = steering.vertices(random.random((-(-n // copies), 4)), low, high)[:n]
    others = steering.vertices(random.random((-(-n // copies), 4)), low, high)[:n]
    bearing, distance = random.uniform(-np.pi, np.pi, n), random.uniform(300.0, 700.0, n)
    others[:, 0] = places[:, 0] + distance * np.cos(bearing)
    others[:, 1] = places[:, 1] + distance * np.sin(bearing)
    others[:, 2] = places[:, 2] + random.uniform(-30.0, 30.0, n)
    return places, others
