"""Flights over the terrain from several sides: the paper's Fig. 4."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ompl_risk._arrays import FloatArray, positive
from ompl_risk.errors import ArgumentError
from ompl_risk.report.attitudes import attitudes
from ompl_risk.report.camera import Camera
from ompl_risk.report.faces import draw_faces
from ompl_risk.report.flight_lines import draw_flight, draw_ground_track
from ompl_risk.report.flight_scene import Scene, scene_of
from ompl_risk.report.helicopter_glyph import draw_helicopter
from ompl_risk.report.style import INK, SIZES, colour, new_figure, save, short
from ompl_risk.report.view_legend import draw_compass, draw_heading, draw_legend
from ompl_risk.report.viewpoints import camera_towards, viewpoints
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

WIDTH, PANEL = 16.0, 4.3
"""Width of the figure and height of a row [inch]."""


def flight_views(
    trajectories: Sequence[Trajectory],
    terrain: Terrain,
    *,
    poses: int = 6,
    exaggeration: float = 2.5,
    title: str = "",
    path: str | Path | None = None,
) -> Figure:
    """Draw each flight in a view of its own, with the helicopter at several of its states.

    A view has one flight with helicopters, the others thin. Parts of flights behind hills are
    dotted. Helicopters are at equal times, in their true attitude although heights are
    exaggerated, and as many times their size as the figure says.

    Args:
        trajectories: one or more; where one has no orientations, its helicopters are level.
        terrain: the ground.
        poses: helicopters along a flight, 2 or more.
        exaggeration: factor on the heights.
        title: what stands above.
        path: where to write the figure, if given.

    Returns:
        The figure, 1600 pixels wide; its axes are the views in the trajectories' order, then the
        legend.

    Raises:
        ArgumentError: no trajectory, fewer than two poses, an exaggeration that is not positive.
        ExtentError: a trajectory leaves the terrain.
        FileError: the file cannot be written.

    Reference: Nair and Kobilarov, Fig. 4.
    """
    if not trajectories:
        raise ArgumentError("trajectories", list(trajectories), "one or more")
    if isinstance(poses, bool) or not isinstance(poses, int) or poses < 2:
        raise ArgumentError("poses", poses, "a whole number, 2 or more")
    scene = scene_of(trajectories, terrain, positive("exaggeration", exaggeration))
    figure, places = _layout(len(trajectories) + 1)
    labels = short([t.name for t in trajectories])
    azimuths = viewpoints(scene.curves, scene.ground, scene.exaggeration)
    for i, (azimuth, place) in enumerate(zip(azimuths, places, strict=False)):
        axes = figure.add_axes(place)
        camera = camera_towards(scene.box, azimuth, scene.exaggeration)
        _draw_view(axes, camera, scene, i, _poses(trajectories[i], poses))
        draw_heading(axes, labels[i], azimuth, colour(i))
        draw_compass(axes, camera)
    draw_legend(figure.add_axes(places[-1]), scene, trajectories, labels, poses)
    text = title or f"Flights over {terrain.name}"
    y = 1.0 - 0.3 / figure.get_figheight()
    figure.text(0.02, y, text, fontsize=SIZES["title"], fontweight="bold", color=INK, va="center")
    if path is not None:
        save(figure, path)
    return figure


def _poses(trajectory: Trajectory, count: int) -> tuple[FloatArray, FloatArray]:
    """Positions and quaternions at equal times, the first and last a little within the flight."""
    share = (np.arange(count) + 0.5) / count
    times = trajectory.t[0] + share * trajectory.duration
    upright = Trajectory(trajectory.t, trajectory.positions, orientations=attitudes(trajectory))
    at = upright.resample(times)
    return at.positions, at.poses[:, 3:]


def _layout(cells: int) -> tuple[Figure, list[tuple[float, float, float, float]]]:
    """A figure and places for views in it, row by row."""
    columns = max(2, math.ceil(math.sqrt(cells)))
    rows = math.ceil(cells / columns)
    height = 0.6 + PANEL * rows
    top, tall, wide = 1.0 - 0.6 / height, PANEL / height, 1.0 / columns
    places = [
        (k % columns * wide + 0.008, top - (k // columns + 1) * tall, wide - 0.016, 0.97 * tall)
        for k in range(cells)
    ]
    return new_figure(WIDTH, height), places


def _draw_view(
    axes: Axes, camera: Camera, scene: Scene, chosen: int, poses: tuple[FloatArray, FloatArray]
) -> None:
    _frame(axes, camera, scene)
    draw_faces(axes, camera, scene.faces)
    for i, curve in enumerate(scene.curves):
        if i != chosen:
            draw_flight(
                axes, camera, scene.ground, curve, colour(i), width=1.1, casing=False, opacity=0.8
            )
    curve = scene.curves[chosen]
    draw_ground_track(axes, camera, scene.ground, curve)
    draw_flight(axes, camera, scene.ground, curve, colour(chosen), width=2.0, zorder=4.0)
    _draw_ends(axes, camera, curve)
    positions, orientations = poses
    _, depth = camera.project(positions)
    seen = camera.sees(positions, scene.ground)
    for k, i in enumerate(np.argsort(-depth)):
        draw_helicopter(
            axes, camera, positions[i], orientations[i], colour(chosen),
            scale=scene.scale, blade=0.6 + 0.7 * i, opacity=1.0 if seen[i] else 0.4,
            zorder=10.0 + k,
        )  # fmt: skip


def _frame(axes: Axes, camera: Camera, scene: Scene) -> None:
    """Limits that hold ground and flights, in one scale, with room for the heading."""
    places, _ = camera.project(np.concatenate([scene.faces.corners, *scene.curves]))
    low, high = places.min(axis=0), places.max(axis=0)
    box = axes.get_window_extent()
    room = high - low
    scale = max(1.03 * room[0] / box.width, 1.03 * room[1] / (0.86 * box.height))
    half = 0.5 * scale * np.array([box.width, box.height])
    middle = 0.5 * (low + high) + [0.0, 0.07 * half[1]]
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    axes.set_axis_off()


def _draw_ends(axes: Axes, camera: Camera, curve: FloatArray) -> None:
    (start, goal), _ = camera.project(curve[[0, -1]])
    style: dict[str, Any] = {"linestyle": "none", "markeredgecolor": "white", "color": INK}
    axes.plot(*start, marker="o", markersize=9, zorder=6.0, **style)
    axes.plot(*goal, marker="*", markersize=15, zorder=6.0, **style)
