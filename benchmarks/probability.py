"""Speed and error of the estimators of the probability of collision."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.metric import Metric, Target, comparison, error, figure
from benchmarks.scenes import above_ground
from benchmarks.timing import interleaved
from ompl_risk import BallSampling, ColumnQuadrature, TerrainClearance, terrains
from ompl_risk.terrains import Terrain

Floats = NDArray[np.float64]

BATCHES = 20
"""Times that the quadrature is given all states in a repeat."""


@dataclass(frozen=True)
class Config:
    """How much is measured.

    Attributes:
        terrain: name of the terrain.
        radius: of the ball [m].
        states: positions, from the ground to ``radius`` above it.
        few: points in the ball, as many as the quadrature has columns.
        many: points in the ball, as many as the paper's kind of sampling needs.
        columns: of the reference quadrature.
        repeats: of every timing.
    """

    terrain: str = "jacksboro"
    radius: float = 100.0
    states: int = 300
    few: int = 128
    many: int = 8_600
    columns: int = 400_000
    repeats: int = 9


QUICK = Config(states=100, columns=100_000, repeats=5)


def fine_share(terrain: Terrain, centre: Floats, radius: float, columns: int) -> float:
    """Share of a ball below a terrain, from very many vertical columns.

    The columns stand on a sunflower lattice, each for the same area of the disk: another rule than
    the library's, and the library's kernels are not used except for the heights.
    """
    k = np.arange(columns) + 0.5
    rho, angle = np.sqrt(k / columns), k * (math.pi * (3.0 - math.sqrt(5.0)))
    half = radius * np.sqrt(1.0 - rho * rho)
    x = centre[0] + radius * rho * np.cos(angle)
    y = centre[1] + radius * rho * np.sin(angle)
    filled = np.clip(terrain.height(x, y) - (centre[2] - half), 0.0, 2.0 * half)
    return float(0.75 * filled.mean() / radius)  # (pi r^2 mean) / (4/3 pi r^3)


def measure(config: Config, seed: int, say: Callable[[str], None]) -> Iterator[Metric]:
    """States a second and rms error of both estimators; see ``Config``."""
    terrain, r = terrains.load(config.terrain), config.radius
    clearance = TerrainClearance(terrain, threads=1)
    rng = np.random.default_rng(seed)
    states = above_ground(terrain, config.states, rng, low=0.0, high=r, margin=r)
    say(f"reference with {config.columns} columns for each of {config.states} states")
    exact = np.array([fine_share(terrain, x, r, config.columns) for x in states])
    coarse = np.array([fine_share(terrain, x, r, config.columns // 4) for x in states])
    doubt = _rms(exact - coarse)
    yield error(
        "reference, change from a quarter", doubt, "", 2e-5, "root mean square over the states"
    )
    estimators = ColumnQuadrature(), BallSampling(config.few), BallSampling(config.many)
    say(f"{config.repeats} repeats of three estimators")
    often = np.tile(states, (BATCHES, 1))  # the quadrature takes a fraction of a millisecond
    batches = often, states, states
    seconds = interleaved(
        config.repeats,
        *(
            lambda _, chosen=chosen, batch=batch: chosen.estimate(clearance, batch, r)
            for chosen, batch in zip(estimators, batches, strict=True)
        ),
    )
    rates = np.array([[len(batch)] for batch in batches]) / seconds
    errors = [chosen.estimate(clearance, states, r).p - exact for chosen in estimators]
    quadrature, few, many = (_rms(e) for e in errors)
    columns = len(estimators[0].columns())
    for peer, rate, rms in (
        (f"sampling, {config.few}", rates[1], few), (f"sampling, {config.many}", rates[2], many)
    ):  # fmt: skip
        yield comparison(
            f"columns against {peer}: speed", rates[0], "states/s", peer, rate,
            better="higher", note=f"one thread; quadrature with {columns} columns",
        )  # fmt: skip
        yield comparison(
            f"columns against {peer}: rms error", quadrature, "", peer, rms,
            target=Target(1e-3, correctness=True),
        )  # fmt: skip
    yield _calibration(errors[1], exact, config.few)
    yield _calibration(errors[2], exact, config.many)


def _rms(errors: Floats) -> Floats:
    return np.array([np.sqrt(np.mean(errors**2))])


def _calibration(errors: Floats, exact: Floats, samples: int) -> Metric:
    """The errors of sampling in units of their own standard deviation: 1 if all is right.

    States with so little share, or so little besides, that hits are rare are left out: there the
    ratio is far from normally distributed.
    """
    variance = exact * (1.0 - exact) / samples
    usual = variance * samples**2 >= 5.0
    count = int(usual.sum())
    return figure(
        f"sampling, {samples}: rms error over theory",
        _rms(errors[usual] / np.sqrt(variance[usual])),
        "",
        target=Target(1.0 + 5.0 / math.sqrt(2.0 * max(count, 1)), correctness=True),
        note=f"theory: binomial proportion, {count} states",
    )
