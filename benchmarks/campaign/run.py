"""One run of the campaign, and the configuration that it is known by."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

from benchmarks import environment, procedures
from benchmarks.campaign import metrics
from benchmarks.campaign.objectives import OBJECTIVES
from benchmarks.campaign.scenes import SCENES, Scene

VERSIONS = ("ompl", "ompl-risk", "numpy", "numba", "python-fcl")
"""Packages that results depend on."""


@dataclass(frozen=True)
class Run:
    """A planner minimises an objective in a scene.

    Attributes:
        scene, objective, planner: their names.
        seed: of OMPL's random numbers, at least 1.
        seconds: processor time that the planner has [s].
    """

    scene: str
    objective: str
    planner: str
    seed: int
    seconds: float

    @property
    def identity(self) -> tuple[str, str, str, int]:
        """What there can be one run of in a folder."""
        return self.scene, self.objective, self.planner, self.seed

    @property
    def label(self) -> str:
        """Such as "canyon, H1 by BITstar, seed 2"."""
        return f"{self.scene}, {self.objective} by {self.planner}, seed {self.seed}"


def runs(
    scenes: Sequence[str],
    objectives: Sequence[str],
    planners: Sequence[str],
    seeds: int,
    seconds: float,
) -> list[Run]:
    """All combinations, seed by seed, so that an interrupted campaign has a bit of everything."""
    return [
        Run(scene, objective, planner, seed, seconds)
        for seed in range(1, seeds + 1)
        for scene in dict.fromkeys(scenes)
        for objective in dict.fromkeys(objectives)
        for planner in dict.fromkeys(planners)
    ]


def configuration(run: Run) -> dict[str, Any]:
    """Everything that a run's result depends on, as far as it can be told, fit for JSON."""
    scene = prepared(run.scene)
    return {
        **asdict(run),
        "scene recipe": dict(scene.recipe),
        "objective recipe": OBJECTIVES[run.objective].recipe(scene.problem),
        "judged with": {
            "error": scene.error,
            "step": metrics.STEP,
            "samples": scene.sampling.samples,
            "d0": scene.problem.avoidance.d0,
        },
        "versions": {k: v for k, v in environment.versions().items() if k in VERSIONS},
        "processor": _processor(),
    }


def key(configuration: Mapping[str, Any]) -> str:
    """A short name for a configuration, of which no two have the same."""
    text = json.dumps(configuration, sort_keys=True, default=list)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def prepared(name: str) -> Scene:
    """The scene of that name; made once in a process."""
    return SCENES[name]()


def code() -> str:
    """A fingerprint of the library's and the campaign's source."""
    return procedures.code(Path(__file__).parent)


@cache
def _processor() -> str:
    return str(environment.machine()["processor"])
