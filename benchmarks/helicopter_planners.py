"""The helicopter in OMPL's control planners: integrator, propagations, and how often they succeed.

RRT, EST and KPIECE1 draw raw inputs at random. That a helicopter stays upright so, and arrives, is
luck with which only short problems can be solved; the figures say how often.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from ompl import base as ob
from ompl import control as oc
from ompl import util as ou

from benchmarks.helicopter_problems import PROBLEMS, STEP, hover_over_ridge
from benchmarks.metric import LIMIT_ONLY, Metric, Target, error, figure
from benchmarks.timing import interleaved
from ompl_risk._kernels import rigid_body
from ompl_risk.bridge.buffers import Buffer
from ompl_risk.helicopter.goals import HelicopterGoal
from ompl_risk.helicopter.model import make_state, simulate
from ompl_risk.helicopter.parameters import Helicopter
from ompl_risk.helicopter.primitives import DT
from ompl_risk.helicopter.setup import HOLDS
from ompl_risk.helicopter.spaces import propagator

PLANNERS = {"RRT": oc.RRT, "EST": oc.EST, "KPIECE1": oc.KPIECE1}


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        steps: of the integrator, in each repeat.
        repeats: of the integrator and of the propagations.
        counted: processor time in which propagations are counted [s].
        runs: of each planner on each problem, each with a seed of its own.
        seconds: processor time of a run, at most.
    """

    steps: int = 500_000
    repeats: int = 5
    counted: float = 2.0
    runs: int = 10
    seconds: float = 8.0


QUICK = Config(steps=200_000, repeats=3, counted=0.5, runs=2, seconds=1.0)


@dataclass(frozen=True)
class Run:
    """One run of a planner on a problem.

    Attributes:
        solved: whether it reached the goal.
        seconds: processor time until then, or until the limit.
        mismatch: of the path's states and its inputs flown again; 0 without a path.
    """

    solved: bool
    seconds: float
    mismatch: float = 0.0


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """Steps and propagations a second, and each planner's success; see ``Config``."""
    ou.setLogLevel(ou.LOG_NONE)
    say(f"{config.repeats} times {config.steps} steps of the integrator")
    yield _integrator(config)
    for name in PLANNERS:
        say(f"propagations inside {name}")
        yield _propagations(name, config, seed)
    mismatches = [0.0]
    for problem, planner in itertools.product(PROBLEMS, PLANNERS):
        say(f"{config.runs} times {planner}: {problem}")
        runs = [solve(problem, planner, seed + k, config.seconds) for k in range(config.runs)]
        mismatches += [run.mismatch for run in runs]
        yield from _success(problem, planner, runs, config)
    yield error("inputs of the paths flown again", mismatches, "m", 0.0, "largest difference")


def _integrator(config: Config) -> Metric:
    helicopter, out = Helicopter(), np.empty(13)
    start = make_state((0, 0, 50), velocity=(20, 0, 0), rates=(0.1, 0.0, 0.2))
    hover = np.array([helicopter.weight, 0.0, 0.0, 0.0])

    def fly(_: int) -> None:
        rigid_body.hold(start, hover, 0.02, config.steps, helicopter.given, out)

    seconds = interleaved(config.repeats, fly)[0]
    return figure(
        "integrator, one core", config.steps / seconds, "1/s", better="higher",
        target=Target(3e6), note="steps of the Runge-Kutta method of order 4",
    )  # fmt: skip


def _propagations(planner: str, config: Config, seed: int) -> Metric:
    """Count how often OMPL calls the propagator."""
    rates = [_rate(planner, config.counted, seed + k) for k in range(config.repeats)]
    target = Target(200_000) if planner == "EST" else None
    note = "of 0.02 s, with the validity check of each; simple_setup as it comes, over a ridge"
    return figure(
        f"propagations inside {planner}", rates, "1/s", better="higher", target=target, note=note
    )


def _rate(planner: str, seconds: float, seed: int) -> float:
    ou.RNG.setSeed(seed + 1)
    setup = hover_over_ridge(limits=None, step=DT, holds=HOLDS)
    si = setup.getSpaceInformation()
    count = itertools.count()
    called, step = count.__next__, propagator(si.getStateSpace(), setup.getControlSpace())

    def counted(state: Any, control: Any, duration: float, result: Any) -> None:
        called()
        step(state, control, duration, result)

    setup.setStatePropagator(counted)
    # out of reach, so that the search goes on
    setup.setGoal(HelicopterGoal(si, (80.0, 40.0, 8.0), radius=1e-9, tolerance=1e-9))
    setup.setPlanner(PLANNERS[planner](si))
    setup.setup()
    elapsed = _solve(setup, seconds)
    return next(count) / elapsed


def solve(problem: str, planner: str, seed: int, seconds: float) -> Run:
    """Run a planner of ``PLANNERS`` on one of ``PROBLEMS``.

    Args:
        problem: by name.
        planner: by name.
        seed: of OMPL's random numbers.
        seconds: processor time, at most.
    """
    ou.RNG.setSeed(seed + 1)  # OMPL refuses 0
    setup = PROBLEMS[problem]()
    setup.setPlanner(PLANNERS[planner](setup.getSpaceInformation()))
    setup.setup()
    elapsed = _solve(setup, seconds)
    definition = setup.getProblemDefinition()
    if not definition.hasExactSolution():
        return Run(False, elapsed)
    path: Any = definition.getSolutionPath()
    mismatch = _mismatch(path, setup.getStateSpace()) if path.check() else float("inf")
    return Run(True, elapsed, mismatch)


def _solve(setup: oc.SimpleSetup, seconds: float) -> float:
    """Processor time that a search takes; not ``solve(seconds)``: other programs would count."""
    begin = time.thread_time()
    setup.solve(ob.PlannerTerminationCondition(lambda: time.thread_time() - begin >= seconds))
    return time.thread_time() - begin


def _mismatch(path: oc.PathControl, space: Any) -> float:
    """Largest difference of a path's states and its inputs flown again."""
    helicopter, buffer, found = Helicopter(), Buffer(13), 0.0
    states = []
    for state in path.getStates():
        space.serialize(buffer.capsule, state)
        states.append(buffer.numbers.copy())
    flown = states[0]
    held: list[Any] = path.getControls()
    for control, seconds, end in zip(held, path.getControlDurations(), states[1:], strict=True):
        inputs = np.tile([control[k] for k in range(4)], (round(seconds / STEP), 1))
        flown = simulate(helicopter, flown, inputs, dt=STEP)[-1]
        found = max(found, float(np.abs(flown - end).max()))
    return found


def _success(problem: str, planner: str, runs: list[Run], config: Config) -> Iterator[Metric]:
    solved = sum(run.solved for run in runs)
    seconds = [run.seconds if run.solved else np.inf for run in runs]
    yield figure(
        f"{problem}, {planner}: solved", 100.0 * solved / len(runs), "%", better="higher",
        tolerance=LIMIT_ONLY,
        note=f"of {len(runs)} runs, in {config.seconds:g} s of processor time each; raw inputs",
    )  # fmt: skip
    yield figure(
        f"{problem}, {planner}: time", seconds, "s", tolerance=LIMIT_ONLY,
        note="median over all runs; inf where half of them or more do not succeed",
    )  # fmt: skip
