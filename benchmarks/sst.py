"""``SST``: how soon the helicopter has a path, and how much better it becomes with time.

Hover to hover over a ridge across the whole box, once for the least duration and once for the least
risk. What the planner says is checked against the inputs of its paths, flown again, and against
distances by python-fcl.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base as ob
from ompl import control as oc
from ompl import util as ou

from benchmarks.metric import LIMIT_ONLY, Metric, Target, Tolerance, error, figure
from benchmarks.peers.fcl_ground import FclGround
from ompl_risk._kernels import sst_tree
from ompl_risk.avoidance import InverseDistance
from ompl_risk.helicopter.model import simulate
from ompl_risk.helicopter.parameters import Helicopter, Limits
from ompl_risk.helicopter.primitives import DT
from ompl_risk.helicopter.setup import simple_setup
from ompl_risk.norms import Sobolev
from ompl_risk.planners.sst.planner import SST
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]

GRID, HEADROOM, BODY, D0 = 10.0, 60.0, 1.0, 100.0
"""Distance of the posts, of the ceiling over the crest, radius of the body, and d0 [m]."""


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        length: from start to goal [m].
        crest: height of the ridge between them [m].
        above: of start and goal over the plain [m].
        seconds: on the wall, after which costs are compared.
        seeds: runs for duration, and for risk.
    """

    length: float = 340.0
    crest: float = 60.0
    above: float = 20.0
    seconds: tuple[float, ...] = (1.0, 3.0, 10.0, 30.0)
    seeds: int = 3


QUICK = Config(seconds=(0.3, 1.0, 3.0), seeds=2)


@dataclass(frozen=True)
class Run:
    """What a run has found.

    Attributes:
        history: seconds and cost of each better path, shape (n, 2).
        iterations, steps: of the search.
        checked: whether OMPL finds the last path valid.
        cost: of the last path from its inputs, flown again.
        room: least distance of the last path by python-fcl [m].
    """

    history: Floats
    iterations: int
    steps: int
    checked: bool
    cost: float
    room: float

    def after(self, seconds: float) -> float:
        """Cost that it had after so many seconds; inf without a path."""
        known = self.history[self.history[:, 0] <= seconds, 1]
        return float(known.min()) if len(known) else math.inf


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Costs after some times, throughput, and whether the paths are what they should be."""
    ou.setLogLevel(ou.LOG_NONE)
    every: list[Run] = []
    for kind, unit in (("duration", "s"), ("risk", "s/m^2")):
        runs = []
        for k in range(seed, seed + config.seeds):
            say(f"least {kind} for {config.seconds[-1]:g} s, seed {k}")
            runs.append(run(config, kind, k))
        yield from _costs(config, kind, unit, runs)
        every += runs
    yield from _speed(config, every)
    yield from _judged(every)


def ridge(config: Config) -> Terrain:
    """A plain of 200 m across with a ridge in the middle."""
    x = np.arange(0.0, config.length + 60.0 + GRID, GRID)
    across = config.crest * np.exp(-(((x - 0.5 * config.length - 30.0) / 30.0) ** 2))
    return Terrain(np.tile(across, (21, 1)), spacing=(GRID, GRID))


def problem(config: Config, kind: str) -> tuple[oc.SimpleSetup, Terrain]:
    """From hover to hover, with all inputs that the helicopter has, anew at each step."""
    terrain = ridge(config)
    xmax, ymax = terrain.extent[1], terrain.extent[3]
    setup = simple_setup(
        terrain,
        start=(30.0, 100.0, config.above),
        goal=(30.0 + config.length, 100.0, config.above),
        high=(xmax, ymax, config.crest + HEADROOM),
        body=BODY,
        authority=1.0,
        holds=(1, 25),
        avoidance=InverseDistance(D0),
        norm=Sobolev(1),
    )
    if kind == "duration":
        si = setup.getSpaceInformation()
        setup.setOptimizationObjective(ob.PathLengthOptimizationObjective(si))
    return setup, terrain


def run(config: Config, kind: str, seed: int) -> Run:
    """Plan once, and judge the last path."""
    setup, terrain = problem(config, kind)
    planner = SST(setup.getSpaceInformation(), seed=seed)
    setup.setPlanner(planner)
    setup.setup()  # compiles
    setup.solve(config.seconds[-1])
    tree: Any = planner.tree
    counts = tree.count(sst_tree.ITERATIONS), tree.count(sst_tree.STEPS)
    history = np.array([row[:2] for row in planner.history]).reshape(-1, 2)
    if not len(history):
        return Run(history, *counts, True, math.inf, math.inf)
    path: Any = setup.getSolutionPath()
    states = flown(path, (30.0, 100.0, config.above))
    d = FclGround(terrain, BODY).distances(states[:, :3])
    f = np.where(d < D0, 1.0 / d - 1.0 / D0, 0.0)
    t = DT * np.arange(len(f))
    power = Sobolev(1).power(t, f) + 1e-9 * D0**-2 * t[-1]
    cost = t[-1] if kind == "duration" else power
    return Run(history, *counts, path.check(), float(cost), float(d.min()))


def flown(path: Any, start: tuple[float, float, float]) -> Floats:
    """States at every step of a path's inputs, shape (n, 13)."""
    steps = [round(duration / DT) for duration in path.getControlDurations()]
    inputs = [[control[k] for k in range(4)] for control in path.getControls()]
    return simulate(Helicopter(), start, np.repeat(inputs, steps, axis=0), dt=DT)


def _costs(config: Config, kind: str, unit: str, runs: list[Run]) -> Iterator[Metric]:
    straight = (config.length - 5.0) / Limits().speed
    for seconds in config.seconds:
        yield figure(
            f"least {kind} after {seconds:g} s",
            [run.after(seconds) for run in runs],
            unit,
            tolerance=Tolerance(0.3),
            note=f"a straight flight at top speed, which hover and ridge rule out: {straight:.3g} s"
            if kind == "duration"
            else "squared H1 norm",
        )
    first, last = config.seconds[0], config.seconds[-1]
    yield figure(
        f"{kind} after {last:g} s over that after {first:g} s",
        [run.after(last) / run.after(first) for run in runs],
        "",
        target=Target(1.0),
        note="paths go on becoming better",
        tolerance=LIMIT_ONLY,
    )


def _speed(config: Config, runs: list[Run]) -> Iterator[Metric]:
    first = [run.history[0, 0] if len(run.history) else math.inf for run in runs]
    yield figure("time to the first path", first, "s", target=Target(1.0), tolerance=LIMIT_ONLY)
    seconds = config.seconds[-1]
    for name, counts in (("iterations", "iterations"), ("steps flown", "steps")):
        rates = [getattr(run, counts) / seconds for run in runs]
        yield figure(f"{name} a second", rates, "1/s", better="higher", note="one thread")


def _judged(runs: list[Run]) -> Iterator[Metric]:
    found = [run for run in runs if len(run.history)]
    yield figure(
        "runs without a path", len(runs) - len(found), "", target=Target(0.0, correctness=True)
    )
    if not found:
        return
    yield figure(
        "paths that OMPL finds invalid", sum(not run.checked for run in found), "",
        target=Target(0.0, correctness=True),
    )  # fmt: skip
    wrong = [run.history[-1, 1] / run.cost - 1.0 for run in found]
    yield error(
        "our costs against those of the inputs, relative", wrong, "", 1e-6,
        f"{len(found)} paths flown again; distances by python-fcl",
    )  # fmt: skip
    yield figure(
        "least clearance of our paths", min(run.room for run in found), "m", better="higher",
        target=Target(0.0, correctness=True), note="by python-fcl at every step",
        tolerance=LIMIT_ONLY,
    )  # fmt: skip
