"""The command `rank`: trajectories and flights from files, whoever planned them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ompl_risk.cli.closed_loop import check_disturbances, closed_loop, write_closed_loop
from ompl_risk.cli.inputs import Input, read_input
from ompl_risk.cli.judging import Judgement, judge, report
from ompl_risk.cli.run_folder import RunFolder, settings_as_values
from ompl_risk.cli.scene import scene_of
from ompl_risk.cli.settings import JudgeSettings
from ompl_risk.errors import ArgumentError, FileError
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from rich.console import Console

    from ompl_risk.terrains import Terrain


def rank_files(
    terrain: str, files: Sequence[Path], settings: JudgeSettings, console: Console
) -> Judgement:
    """Read, rank and show trajectories, and write everything.

    Raises:
        OmplRiskError: a setting or a file is wrong.
    """
    check_disturbances(settings, flown=settings.rollouts is not None)
    names = _names(files)
    inputs = [read_input(file, name) for file, name in zip(files, names, strict=True)]
    read = [one.trajectory for one in inputs]
    scene = scene_of(terrain, settings)
    for file, trajectory in zip(files, read, strict=True):
        _check_inside(file, trajectory, scene.terrain)
    plans = [] if settings.rollouts is None else [one.plan() for one in inputs]
    folder = RunFolder(settings.output)
    values = settings_as_values(terrain, settings)
    folder.write_config("rank", {**values, "files": [file.resolve() for file in files]})
    judgement = judge(read, scene, estimates=closed_loop(plans, scene, settings, console))
    title = f"{scene.terrain.name}: {len(files)} trajectories"
    report(judgement, scene, folder, console, title=title, facts=_facts(inputs))
    write_closed_loop(judgement, scene, settings, folder, console, title)
    if plans and len({one.vehicle for one in inputs}) > 1:
        console.print(_two_vehicles(inputs), markup=False, soft_wrap=True)
    return judgement


def _facts(inputs: Sequence[Input]) -> dict[str, Any]:
    """What the provenance tells of the files."""
    files = {one.trajectory.name: str(one.file.resolve()) for one in inputs}
    if all(one.flight is None for one in inputs):
        return {"files": files}
    return {"files": files, "vehicles": {one.trajectory.name: one.vehicle for one in inputs}}


def _two_vehicles(inputs: Sequence[Input]) -> str:
    """Tells that probabilities differ by the vehicle too."""
    flown = [one.trajectory.name for one in inputs if one.flight is not None]
    others = [one.trajectory.name for one in inputs if one.flight is None]
    return (
        f"Flown by the helicopter: {', '.join(flown)}; by a point: {', '.join(others)}. Part of "
        "the difference between their probabilities is the vehicle's."
    )


def _names(files: Sequence[Path]) -> list[str]:
    """Names of the trajectories: the files' stems, or more of their paths where these repeat.

    Raises:
        ArgumentError: fewer than two files, or one that is given twice.
    """
    if len(files) < 2:
        given = [str(f) for f in files]
        raise ArgumentError("files", given, "at least two, or there is nothing to compare")
    for k, file in enumerate(files):
        if file.resolve() in [other.resolve() for other in files[:k]]:
            raise ArgumentError("files", str(file), "given only once")
    stems = [f.stem for f in files]
    if len(set(stems)) == len(stems):
        return stems
    return [str(f) for f in files]


def _check_inside(file: Path, trajectory: Trajectory, terrain: Terrain) -> None:
    """Refuse a trajectory that leaves the map: there the distance to the ground is unknown."""
    xmin, xmax, ymin, ymax = terrain.extent
    x, y, _ = trajectory.positions.T
    outside = np.flatnonzero((x < xmin) | (x > xmax) | (y < ymin) | (y > ymax))
    if len(outside):
        i = int(outside[0])
        raise FileError(
            file,
            f"{len(outside)} of {len(x)} samples lie outside the terrain, the first, at "
            f"t = {trajectory.t[i]:g} s, at ({x[i]:.7g}, {y[i]:.7g}) m",
            f"the terrain spans x {xmin:.7g} to {xmax:.7g} m, y {ymin:.7g} to {ymax:.7g} m",
        )
