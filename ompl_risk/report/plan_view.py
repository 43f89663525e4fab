"""Paths seen from above, on a hillshade."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from ompl_risk._arrays import FloatArray
from ompl_risk.report.map_labels import NOWHERE, draw_label, label_points, label_size
from ompl_risk.report.style import DPI, INK, SIZES, colour, dashes
from ompl_risk.report.text_size import POINTS_PER_INCH
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

MARGIN = 0.07
"""Room around the paths, as a part of their extent."""
ABOVE = "#8C2D04"
KM = 1e-3


def draw_plan_view(
    axes: Axes,
    terrain: Terrain,
    trajectories: Sequence[Trajectory],
    labels: Sequence[str],
    *,
    ceiling: float | None = None,
    marks: FloatArray = NOWHERE,
) -> None:
    """Draw paths with their labels, start and goal.

    Both axes have one scale; the map is extended to fill the axes.

    Args:
        axes: where to draw, of fixed size.
        terrain: the ground.
        trajectories: the paths.
        labels: a short label for each.
        ceiling: ground above this altitude [m] is tinted, if given.
        marks: places [m], shape (n, 2), that labels had better not cover.
    """
    curves = [_curve(trajectory) for trajectory in trajectories]
    _set_limits(axes, np.concatenate(curves))
    _draw_ground(axes, terrain, ceiling)
    for i, curve in reversed(list(enumerate(curves))):  # the first, safest one comes on top
        axes.plot(
            *curve.T,
            color=colour(i),
            linestyle=dashes(i),
            linewidth=2.6,
            path_effects=[withStroke(linewidth=4.6, foreground="white")],
            solid_capstyle="round",
        )
    _draw_ends(axes, curves)
    points = label_points(curves, size=label_size(axes, labels), avoid=KM * marks)
    for i, (label, point) in enumerate(zip(labels, points, strict=True)):
        draw_label(axes, label, point, colour(i))
    axes.set_xlabel("east [km]", fontsize=SIZES["text"])
    axes.set_ylabel("north [km]", fontsize=SIZES["text"])
    axes.tick_params(labelsize=SIZES["small"])


def _curve(trajectory: Trajectory) -> FloatArray:
    """Some 200 points at equal times along the path, its corners among them, in km."""
    times = np.linspace(trajectory.t[0], trajectory.t[-1], 200)
    every = max(1, len(trajectory) // 400)  # a ranking's trajectory has thousands of samples
    times = np.union1d(times, trajectory.t[::every])
    return trajectory.resample(times).positions[:, :2] * KM


def _set_limits(axes: Axes, points: FloatArray) -> None:
    """Limits that hold all points with a margin and have the shape of the axes."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, size = (low + high) / 2, (high - low) + 2 * MARGIN * (high - low).max()
    box = axes.get_window_extent()
    scale = max(size[0] / box.width, size[1] / box.height)  # km a pixel
    half = np.array([box.width, box.height]) * scale / 2
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    axes.set_aspect("equal", adjustable="box")


def _draw_ground(axes: Axes, terrain: Terrain, ceiling: float | None) -> None:
    limits = axes.get_xlim(), axes.get_ylim()
    shown = _part_within(terrain, *limits)
    x, y = shown.axes
    half_x, half_y = x.step / 2, y.step / 2  # a pixel is centred on its post
    edges = (x.start - half_x, x.stop + half_x, y.start - half_y, y.stop + half_y)
    axes.set_facecolor("#E8E8E8")
    axes.imshow(
        shown.hillshade(),
        cmap="gray",
        vmin=-1.1,
        vmax=1.05,
        interpolation="bilinear",
        origin="lower",
        extent=(KM * edges[0], KM * edges[1], KM * edges[2], KM * edges[3]),
        aspect="equal",
    )
    if ceiling is not None and shown.heights.max() > ceiling:
        posts = [KM * (axis.start + axis.step * np.arange(axis.count)) for axis in (x, y)]
        axes.contourf(*posts, shown.heights, [ceiling, math.inf], colors=[ABOVE], alpha=0.45)
        patch = Patch(color=ABOVE, alpha=0.45, label=f"ground above the ceiling, {ceiling:.0f} m")
        axes.legend(handles=[patch], loc="lower right", fontsize=SIZES["small"], framealpha=0.9)
    axes.set_xlim(limits[0])
    axes.set_ylim(limits[1])


def _part_within(terrain: Terrain, x: tuple[float, float], y: tuple[float, float]) -> Terrain:
    """The posts that can be seen between limits [km]: large maps need not be drawn whole."""
    xmin, xmax, ymin, ymax = terrain.extent
    west, east = np.clip(np.array(x) / KM, xmin, xmax)
    south, north = np.clip(np.array(y) / KM, ymin, ymax)
    if not (west < east and south < north):
        return terrain
    return terrain.window((float(west), float(south), float(east), float(north)))


def _draw_ends(axes: Axes, curves: Sequence[FloatArray]) -> None:
    starts = np.unique(np.round([curve[0] for curve in curves], 3), axis=0)
    goals = np.unique(np.round([curve[-1] for curve in curves], 3), axis=0)
    style: dict[str, Any] = {"linestyle": "none", "markeredgecolor": "white", "color": INK}
    axes.plot(*starts.T, marker="o", markersize=11, **style)
    axes.plot(*goals.T, marker="*", markersize=18, **style)
    for name, points in (("start", starts), ("goal", goals)):
        if len(points) == 1:
            _annotate(axes, name, points[0])


def _annotate(axes: Axes, name: str, point: FloatArray) -> None:
    """Name an end, below it and a little away from the middle of the map, but within the map."""
    middle = float(np.mean(axes.get_xlim()))
    text = axes.annotate(
        name,
        (float(point[0]), float(point[1])),
        xytext=(-14 if point[0] < middle else 14, -21),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=SIZES["text"],
        fontweight="bold",
        color=INK,
        path_effects=[withStroke(linewidth=3, foreground="white")],
    )
    shown, room = text.get_window_extent(), axes.get_window_extent().padded(-4.0)
    right = max(0.0, room.x0 - shown.x0) - max(0.0, shown.x1 - room.x1)
    up = 42.0 if shown.y0 < room.y0 else 0.0
    x, y = text.xyann
    text.xyann = (x + right * POINTS_PER_INCH / DPI, y + up)
