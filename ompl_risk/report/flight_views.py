"""Flights over the terrain from several sides: the paper's Fig. 4."""

from __future__ import annotations

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
from ompl_risk.report.style import FAINT, INK, SIZES, colour, dashes, new_figure, save, short
from ompl_risk.report.view_heading import draw_compass, draw_heading, size
from ompl_risk.report.view_layout import GAP, HEADING, WIDTH, even_ranks, view_layout
from ompl_risk.report.view_legend import Shown, view_legend
from ompl_risk.report.viewpoints import camera_towards, viewpoints
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

MOST = 8
"""More views than this are too small: with the legend they fill three rows of three."""
TITLE, LINE = 0.55, 0.3
"""Room for the title and for a line below it [inch]."""


def flight_views(
    trajectories: Sequence[Trajectory],
    terrain: Terrain,
    *,
    poses: int = 6,
    exaggeration: float = 2.5,
    most: int = MOST,
    ranked_by: str = "",
    title: str = "",
    path: str | Path | None = None,
) -> Figure:
    """Draw each flight in a view of its own, with the helicopter at several of its states.

    A view has one flight with helicopters, the others thin. Parts of flights behind hills are
    dotted. Helicopters are at equal times, in their true attitude although heights are
    exaggerated, and as many times their size as the figure says. Of more flights than fit, the
    first, the last and those between at even ranks are drawn, and a line says so.

    Args:
        trajectories: one or more; where one has no orientations, its helicopters are level.
        terrain: the ground.
        poses: helicopters along a flight, 2 or more.
        exaggeration: factor on the heights.
        most: flights that are drawn at most, 2 or more.
        ranked_by: what the flights are in order of, the safest first, in words; left out, nothing
            is said of safety.
        title: what stands above.
        path: where to write the figure, if given.

    Returns:
        The figure, 1600 pixels wide and as high as it needs; its axes are the views in the
        trajectories' order, then the legend.

    Raises:
        ArgumentError: no trajectory, fewer than two poses or views, an exaggeration that is not
            positive.
        ExtentError: a trajectory that is drawn leaves the terrain.
        FileError: the file cannot be written.

    Reference: Nair and Kobilarov, Fig. 4.
    """
    if not trajectories:
        raise ArgumentError("trajectories", list(trajectories), "one or more")
    _check_whole("poses", poses)
    _check_whole("most", most)
    labels = short([t.name for t in trajectories])
    flights = [Shown(i, labels[i], trajectories[i]) for i in even_ranks(len(labels), most)]
    exaggeration = positive("exaggeration", exaggeration)
    scene = scene_of([f.trajectory for f in flights], terrain, exaggeration)
    remark = _remark(flights, len(labels), ranked_by)
    figure = _draw(scene, flights, poses, title or f"Flights over {terrain.name}", remark)
    if path is not None:
        save(figure, path)
    return figure


def _check_whole(name: str, value: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or value < 2:
        raise ArgumentError(name, value, "a whole number, 2 or more")


def _remark(flights: Sequence[Shown], count: int, ranked_by: str) -> str:
    """What is left out, if anything."""
    if len(flights) == count:
        return ""
    first, last = flights[0].label, flights[-1].label
    shown = f"{len(flights)} of {count} flights"
    if not ranked_by:
        return f"{shown}, evenly from the first, {first}, to the last, {last}"
    ends = f"from the safest, {first}, to the riskiest, {last}"
    return f"{shown}, at even ranks by {ranked_by}, {ends}"


def _draw(scene: Scene, flights: Sequence[Shown], poses: int, title: str, remark: str) -> Figure:
    azimuths = viewpoints(scene.curves, scene.ground, scene.exaggeration)
    cameras = [camera_towards(scene.box, a, scene.exaggeration) for a in azimuths]
    legend = view_legend(scene, flights, poses)
    extents = [np.ptp(_drawn(camera, scene), axis=0) for camera in cameras]
    above = TITLE + (LINE if remark else 0.0)
    places = view_layout([high / wide for wide, high in extents], legend.height, above=above)
    figure = new_figure(WIDTH, places.height)
    for k, (flight, camera, place) in enumerate(zip(flights, cameras, places.views, strict=True)):
        axes = figure.add_axes(place)
        _draw_view(axes, camera, scene, flights, k, poses)
        draw_heading(axes, flight.label, azimuths[k], colour(flight.index))
        draw_compass(axes, camera)
    axes = figure.add_axes(places.legend)
    legend.draw(axes, *size(axes))
    for text, y, style in (
        (title, 0.3, {"fontsize": SIZES["title"], "fontweight": "bold", "color": INK}),
        (remark, TITLE + 0.03, {"fontsize": SIZES["text"], "color": FAINT}),
    ):
        figure.text(GAP / WIDTH, 1.0 - y / places.height, text, va="center", **style)
    return figure


def _poses(trajectory: Trajectory, count: int) -> tuple[FloatArray, FloatArray]:
    """Positions and quaternions at equal times, the first and last a little within the flight."""
    share = (np.arange(count) + 0.5) / count
    times = trajectory.t[0] + share * trajectory.duration
    upright = Trajectory(trajectory.t, trajectory.positions, orientations=attitudes(trajectory))
    at = upright.resample(times)
    return at.positions, at.poses[:, 3:]


def _draw_view(
    axes: Axes, camera: Camera, scene: Scene, flights: Sequence[Shown], chosen: int, poses: int
) -> None:
    _frame(axes, camera, scene)
    draw_faces(axes, camera, scene.faces)
    for k, curve in enumerate(scene.curves):
        index = flights[k].index
        style: dict[str, Any] = {"width": 1.1, "casing": False, "opacity": 0.8}
        if k == chosen:
            draw_ground_track(axes, camera, scene.ground, curve)
            _draw_ends(axes, camera, curve)
            style = {"width": 2.0, "zorder": 4.0}
        draw_flight(
            axes, camera, scene.ground, curve, colour(index), dash=dashes(index), **style
        )  # fmt: skip
    positions, orientations = _poses(flights[chosen].trajectory, poses)
    _, depth = camera.project(positions)
    seen = camera.sees(positions, scene.ground)
    for k, i in enumerate(np.argsort(-depth)):
        draw_helicopter(
            axes, camera, positions[i], orientations[i], colour(flights[chosen].index),
            scale=scene.scale, blade=0.6 + 0.7 * i, opacity=1.0 if seen[i] else 0.4,
            zorder=10.0 + k,
        )  # fmt: skip


def _drawn(camera: Camera, scene: Scene) -> FloatArray:
    """Where ground and flights are in the picture, shape (n, 2)."""
    return camera.project(np.concatenate([scene.faces.corners, *scene.curves]))[0]


def _frame(axes: Axes, camera: Camera, scene: Scene) -> None:
    """Limits that hold ground and flights, in one scale, with room for the heading."""
    places = _drawn(camera, scene)
    low, high = places.min(axis=0), places.max(axis=0)
    width, height = size(axes)
    below = height - HEADING
    wide, tall = high - low
    scale = max(1.03 * wide / width, 1.03 * tall / below)
    middle = 0.5 * (low + high)
    axes.set_xlim(middle[0] - 0.5 * scale * width, middle[0] + 0.5 * scale * width)
    bottom = middle[1] - 0.5 * scale * below
    axes.set_ylim(bottom, bottom + scale * height)
    axes.set_axis_off()


def _draw_ends(axes: Axes, camera: Camera, curve: FloatArray) -> None:
    (start, goal), _ = camera.project(curve[[0, -1]])
    style: dict[str, Any] = {"linestyle": "none", "markeredgecolor": "white", "color": INK}
    axes.plot(*start, marker="o", markersize=9, zorder=6.0, **style)
    axes.plot(*goal, marker="*", markersize=15, zorder=6.0, **style)
