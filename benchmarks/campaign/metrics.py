"""How good a path is, whoever says that it has found it: everything from its corners alone."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from benchmarks.campaign.objectives import NORMS, NormOfRisk
from benchmarks.campaign.scenes import Scene
from ompl_risk import Lp, Trajectory, collision_probability, rank
from ompl_risk.motion import Risk, motion_model

Floats = NDArray[np.float64]

STEP = 0.2
"""Longest step between states whose probability of collision is estimated, as a part of r."""
TOLERANCE = 1e-4
"""Error of the least clearance, as a part of d0."""


@dataclass(frozen=True)
class Metric:
    """A figure by which paths are judged.

    Attributes:
        unit: its unit.
        better: which paths are better.
        about: one line for tables.
    """

    unit: str
    better: Literal["lower", "higher"]
    about: str

    @property
    def worst(self) -> float:
        """What a run without a path counts as."""
        return math.inf if self.better == "lower" else -math.inf


def _norms() -> dict[str, Metric]:
    return {
        name: Metric(NormOfRisk(norm).unit, "lower", f"{norm.label} norm of f")
        for name, norm in NORMS.items()
    }


METRICS: Mapping[str, Metric] = MappingProxyType(
    {
        "duration": Metric("s", "lower", "duration at constant speed"),
        **_norms(),
        "clearance": Metric("m", "higher", "least clearance"),
        "pc L2": Metric("√s", "lower", "L2 norm of the probability of collision P_c(t)"),
        "pc max": Metric("1", "lower", "greatest probability of collision P_c(t)"),
        "pc ever": Metric("1", "lower", "probability that a constant error makes it collide"),
    }
)

BOUNDS = ("pc L2 low", "pc L2 high", "pc max low", "pc max high", "pc ever low", "pc ever high")
"""Bounds of the probabilities: the quadrature's estimated error, or 95 % intervals of sampling."""


def judge(scene: Scene, corners: Floats) -> tuple[bool, dict[str, float]]:
    """Every metric of a path.

    Args:
        scene: where it leads.
        corners: of the path [m], shape (n, 3).

    Returns:
        Whether it is free, keeps the least clearance demanded and leads within the box from start
        to goal; and its metrics with `BOUNDS`. A path in collision has infinite norms.
    """
    path = Trajectory.at_constant_speed(corners, scene.problem.speed, "path")
    values = _risk(scene, path)
    values["clearance"] = least_clearance(
        scene.problem.clearance, path.positions, TOLERANCE * scene.problem.avoidance.d0
    )
    values |= _probability(scene, path)
    return is_sound(scene, path.positions), {k: values[k] for k in (*METRICS, *BOUNDS)}


def is_sound(scene: Scene, corners: Floats) -> bool:
    """Whether every motion is free by the exact check, and the path solves the problem."""
    problem = scene.problem
    ends = np.array([problem.start, problem.goal])
    slack = 1e-9 * float(np.abs([problem.low, problem.high]).max())
    if np.abs(corners[[0, -1]] - ends).max() > slack:
        return False
    if (corners < problem.low - slack).any() or (corners > problem.high + slack).any():
        return False
    model = motion_model(problem.obstacles, Risk(speed=problem.speed))
    for a, b in pairwise(corners):
        model.a[:], model.b[:] = a, b
        if not model.is_motion_free():
            return False
    return True


def least_clearance(clearance: Any, corners: Floats, tolerance: float) -> float:
    """Least clearance along straight motions, by halving whatever may hold less.

    A piece of length h with d0 and d1 at its ends has at least (d0 + d1 - h) / 2 in between.

    Args:
        clearance: d(q), 1-Lipschitz.
        corners: shape (n, 3) [m].
        tolerance: the result is at most this much too great [m].
    """
    a, b = corners[:-1], corners[1:]
    da, db = (np.asarray(clearance(np.ascontiguousarray(x))) for x in (a, b))
    least = float(min(da.min(), db.min()))
    while len(a):
        lengths = np.linalg.norm(b - a, axis=1)
        open_ = 0.5 * (da + db - lengths) < least - tolerance
        a, b, da, db = a[open_], b[open_], da[open_], db[open_]
        if not len(a) or math.isinf(least):
            break
        middle = 0.5 * (a + b)
        dm = np.asarray(clearance(middle))
        least = min(least, float(dm.min()))
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
        da, db = np.concatenate([da, dm]), np.concatenate([dm, db])
    return least


def _risk(scene: Scene, path: Trajectory) -> dict[str, float]:
    """Duration and norms, by dense sampling."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ranking = rank(
            [path], scene.problem.clearance, scene.problem.avoidance, tuple(NORMS.values())
        )
    found = ranking.assessments[0]
    norms = {name: float(found.norms[norm.label]) for name, norm in NORMS.items()}
    return {"duration": path.duration, **norms}


def _probability(scene: Scene, path: Trajectory) -> dict[str, float]:
    """P_c(t): quadrature over terrain, sampling elsewhere; and the share of errors that collide."""
    clearance, step = scene.problem.clearance, STEP * scene.error
    shared = collision_probability(
        path, clearance, scene.error, estimator=scene.sampling, max_step=step
    )
    profile = shared
    if scene.is_terrain:
        profile = collision_probability(path, clearance, scene.error, max_step=step)
    k, ever, L2 = int(np.argmax(profile.p)), shared.ever, Lp(2)
    values = {"pc L2": L2(profile.t, profile.p), "pc max": float(profile.p[k])}
    values |= {"pc L2 low": L2(profile.t, profile.low), "pc L2 high": L2(profile.t, profile.high)}
    values |= {"pc max low": float(profile.low[k]), "pc max high": float(profile.high[k])}
    if ever is None:
        raise TypeError("scene.sampling: offsets must be shared")
    return values | {"pc ever": ever[0], "pc ever low": ever[1], "pc ever high": ever[2]}
