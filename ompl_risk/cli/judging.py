"""Rank trajectories, show and write what came out: the common part of `plan` and `rank`."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ompl_risk.cli.run_folder import RunFolder
from ompl_risk.cli.scene import Scene
from ompl_risk.errors import DurationWarning
from ompl_risk.norms import Lp
from ompl_risk.probability import CollisionProfile, collision_probabilities
from ompl_risk.ranking import Ranking, rank
from ompl_risk.ranking.assessment import Estimate
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from rich.console import Console


@dataclass(frozen=True, eq=False)
class Judgement:
    """A ranking and the probabilities of collision that it was made with.

    Args:
        ranking: the ranking, trajectories in order of the L2 norm of the probability.
        profiles: probability of collision at the ranking's samples, by name.
        order: which of the trajectories given is the first, the second, and so on.
    """

    ranking: Ranking
    profiles: Mapping[str, CollisionProfile]
    order: tuple[int, ...]


def judge(
    trajectories: Sequence[Trajectory],
    scene: Scene,
    *,
    letters: bool = False,
    estimates: Sequence[Estimate] = (),
) -> Judgement:
    """Rank trajectories by the norms of f and of the probability of collision.

    Args:
        trajectories: with names that differ.
        scene: what they are judged by.
        letters: call them A, B and so on, in order of the L2 norm of the probability.
        estimates: probability that each ends in collision, in the same order; or none.

    Raises:
        ArgumentError: see `rank`.
    """
    # The ranking chooses the samples; the probability is then taken at the same ones, so that a
    # row of the files written has all of them.
    sampled = [a.trajectory for a in _rank(trajectories, scene).assessments]
    found = collision_probabilities(sampled, scene.terrain, scene.uncertainty, max_step=None)
    profiles = list(found.values())
    risks = [Lp(2)(profile.t, profile.p) for profile in profiles]
    order = sorted(range(len(risks)), key=risks.__getitem__)
    names = [_letters(k) if letters else sampled[i].name for k, i in enumerate(order)]
    by_name = {name: profiles[i] for name, i in zip(names, order, strict=True)}
    ordered = [_renamed(sampled[i], name) for name, i in zip(names, order, strict=True)]
    known: Mapping[str, Any] = by_name
    if estimates:
        known = {name: (by_name[name], estimates[i]) for name, i in zip(names, order, strict=True)}
    return Judgement(_rank(ordered, scene, known), by_name, tuple(order))


def report(
    judgement: Judgement,
    scene: Scene,
    folder: RunFolder,
    console: Console,
    *,
    title: str,
    facts: Mapping[str, Any],
    ceiling: float | None = None,
) -> None:
    """Print the tables; write figure, ranking, trajectories and provenance."""
    from ompl_risk.report import ranking_figure

    ranking = judgement.ranking
    ranking.to_json(folder.path / "ranking.json")
    folder.write_trajectories(ranking, judgement.profiles)
    folder.write_provenance(facts)
    ranking_figure(
        ranking,
        judgement.profiles,
        scene.terrain,
        ceiling=ceiling,
        title=title,
        path=folder.path / "figure.png",
    )
    console.print(ranking)
    console.print(
        f"Written to {folder.path}: figure.png, ranking.json, trajectories/, "
        "config.toml, provenance.json",
        soft_wrap=True,
        markup=False,
    )


def _rank(
    trajectories: Sequence[Trajectory],
    scene: Scene,
    known: Mapping[str, Any] | None = None,
) -> Ranking:
    with warnings.catch_warnings():
        # The printed ranking says the same, with the Pareto sets.
        warnings.simplefilter("ignore", DurationWarning)
        return rank(
            trajectories,
            scene.clearance,
            scene.avoidance,
            scene.norms,
            duration_tolerance=scene.duration_tolerance,
            probability=known,
        )


def _renamed(t: Trajectory, name: str) -> Trajectory:
    return Trajectory(
        t.t,
        t.positions,
        name,
        orientations=t.orientations,
        velocities=t.velocities,
        controls=t.controls,
    )


def _letters(index: int) -> str:
    """A to Z, then AA, AB and so on."""
    head = _letters(index // 26 - 1) if index >= 26 else ""
    return head + chr(ord("A") + index % 26)
