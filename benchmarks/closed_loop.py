"""Rollouts of the helicopter in closed loop: how many a second, and what takes the time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.metric import Metric, Target, Tolerance, error, figure
from benchmarks.timing import interleaved
from ompl_risk import TerrainClearance, terrains
from ompl_risk.clearance.threads import thread_count
from ompl_risk.helicopter.flight import Flight
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.primitives import DT
from ompl_risk.helicopter.trims import solve_trim
from ompl_risk.simulation.disturbances.draws import Draws
from ompl_risk.simulation.disturbances.together import Disturbances
from ompl_risk.simulation.loop.helicopter_plan import HelicopterPlan
from ompl_risk.simulation.loop.rollouts import fly

SLOWER = Tolerance(4.0, of="yardstick")


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        terrain: name or file.
        height: of the plan above the highest ground on its way [m].
        seconds: duration of a flight.
        rollouts: of the flight.
        level: of the disturbances.
        repeats: of everything.
    """

    terrain: str = "jacksboro"
    height: float = 60.0
    seconds: float = 60.0
    rollouts: int = 2000
    level: str = "moderate"
    repeats: int = 5


QUICK = Config(rollouts=400, repeats=3)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Rollouts a second on all processors and on one, and how exact they are; see ``Config``."""
    clearance = TerrainClearance(terrains.load(config.terrain), 5.0)
    say(f"{config.rollouts} rollouts of {config.seconds:g} s")
    begin = time.perf_counter()
    flight = _circling(config, clearance)
    plan = HelicopterPlan(flight)
    level = Disturbances.level(config.level)
    everything = fly(plan, clearance, level, Draws.make(32, seed, level))  # compiles
    say(f"compiled, or read from the cache, in {time.perf_counter() - begin:.1f} s")
    note = f"{config.seconds:g} s at 50 Hz with gusts, navigation and terrain errors"
    yield _rate(config, plan, clearance, level, seed, note)
    parts = {
        "all": level,
        "no terrain error": Disturbances(level.gusts, level.navigation),
        "gusts": Disturbances(gusts=level.gusts),
        "navigation errors": Disturbances(navigation=level.navigation),
        "terrain error": Disturbances(terrain=level.terrain),
        "none": Disturbances(),
    }
    yield from _steps(config, plan, clearance, parts, seed)
    yield figure("rollouts that went out of control", int(everything.lost.sum()), "")
    still = fly(plan, clearance, Disturbances(), Draws.make(1, seed, Disturbances()), traced=1)
    apart = float(np.abs(still.traces[0] - plan.positions).max())
    yield error("undisturbed rollout, from the plan", [apart], "m", 1e-6, "any coordinate")


def _rate(
    config: Config,
    plan: HelicopterPlan,
    clearance: TerrainClearance,
    level: Disturbances,
    seed: int,
    note: str,
) -> Metric:
    draws, threads = Draws.make(config.rollouts, seed, level), thread_count(None)
    rates = []
    for _ in range(config.repeats):
        begin = time.process_time()
        fly(plan, clearance, level, draws)
        rates.append(threads * config.rollouts / (time.process_time() - begin))
    return figure(
        f"rollouts a second, {threads} threads", rates, "1/s", better="higher",
        target=Target(1000.0), tolerance=SLOWER,
        note=f"{note}; by processor time, as on a machine that does nothing else",
    )  # fmt: skip


def _steps(
    config: Config,
    plan: HelicopterPlan,
    clearance: TerrainClearance,
    parts: dict[str, Disturbances],
    seed: int,
) -> Iterator[Metric]:
    """Time of one step of one rollout on one thread, under every set of disturbances."""
    count = max(32, config.rollouts // 10)
    draws = {name: Draws.make(count, seed, part) for name, part in parts.items()}
    tasks = [
        lambda _, name=name, part=part: fly(plan, clearance, part, draws[name], threads=1)
        for name, part in parts.items()
    ]
    seconds = interleaved(config.repeats, *tasks)
    for name, row in zip(parts, seconds, strict=True):
        each = 1e9 * row / (count * (len(plan.times) - 1))
        yield figure(f"a step: {name}", each.tolist(), "ns", tolerance=SLOWER)


def _circling(config: Config, clearance: TerrainClearance) -> Flight:
    """A wide turn at 30 m/s over the middle of the map."""
    trim = solve_trim(Helicopter(), 30.0, turn=2.0 * np.pi / config.seconds)
    steps = round(config.seconds / DT)
    xmin, xmax, ymin, ymax = clearance.terrain.extent
    ways = np.array([trim.displacement(k * DT) for k in range(steps + 1)])
    centre = np.array([0.5 * (xmin + xmax), 0.5 * (ymin + ymax)]) - ways[:, :2].mean(axis=0)
    places = ways[:, :2] + centre
    top = float(clearance.terrain.height(places[:, 0], places[:, 1]).max()) + config.height
    states = np.array([trim.state((*p, top), w[3]) for p, w in zip(places, ways, strict=True)])
    controls = np.tile(trim.control, (steps, 1))
    flown = Flight(DT, states, controls, states).replay()
    return Flight(DT, flown, controls, states)
