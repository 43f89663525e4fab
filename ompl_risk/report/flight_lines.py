"""Flights as lines in a picture from a camera: seen parts whole, hidden parts dotted."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import NDArray

from ompl_risk._arrays import FloatArray
from ompl_risk.report.camera import Camera, ground_below
from ompl_risk.report.style import INK

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain


def draw_flight(
    axes: Axes,
    camera: Camera,
    terrain: Terrain,
    curve: FloatArray,
    colour: str,
    *,
    width: float = 2.4,
    dash: Any = "solid",
    casing: bool = True,
    opacity: float = 1.0,
    zorder: float = 3.0,
) -> list[LineCollection]:
    """Draw a curve; what the ground hides is dotted and faint.

    Args:
        axes: whose data coordinates are the picture's.
        camera: where it is seen from.
        terrain: the ground.
        curve: points [m], shape (n, 3).
        colour: of the line.
        width: of the line [pt].
        dash: its style where it is seen.
        casing: whether it has a white edge.
        opacity: of the whole.
        zorder: of the whole.

    Returns:
        The hidden part, the edge if there is one, and the part that is seen.
    """
    places, depth = camera.project(curve)
    seen = camera.sees(curve, terrain)
    ahead = depth > 0.0
    style: dict[str, Any] = {"capstyle": "round", "zorder": zorder, "color": colour}
    hidden = {**style, "linewidth": 0.6 * width, "linestyle": (0, (1, 2)), "alpha": 0.55 * opacity}
    drawn = [_lines(axes, _runs(places, ahead & ~seen), **hidden)]
    whole = _runs(places, ahead & seen)
    if casing:
        edge = {**style, "color": "white", "linewidth": width + 1.8, "alpha": 0.85 * opacity}
        drawn.append(_lines(axes, whole, **edge))
    drawn.append(_lines(axes, whole, **style, linewidth=width, linestyle=dash, alpha=opacity))
    return drawn


def draw_ground_track(
    axes: Axes, camera: Camera, terrain: Terrain, curve: FloatArray, *, opacity: float = 0.55
) -> LineCollection:
    """Draw the line on the ground below a curve, where it is seen: the shadow at noon."""
    below = curve.copy()
    below[:, 2] = ground_below(terrain, curve) + 0.5
    places, depth = camera.project(below)
    seen = camera.sees(below, terrain, slack=2.0) & (depth > 0.0)
    return _lines(
        axes, _runs(places, seen), color=INK, linewidth=0.9, alpha=opacity, zorder=2.0
    )  # fmt: skip


def _runs(places: FloatArray, chosen: NDArray[np.bool_]) -> list[FloatArray]:
    """Pieces of the line that are chosen, each with the point before it, so that none is lost."""
    steps = np.concatenate([[False], chosen[1:] | chosen[:-1], [False]])
    edges = np.flatnonzero(np.diff(steps.astype(int)))
    runs = [places[begin : end + 1] for begin, end in zip(edges[::2], edges[1::2], strict=True)]
    return [run[np.isfinite(run).all(axis=1)] for run in runs]


def _lines(axes: Axes, runs: list[FloatArray], **style: Any) -> LineCollection:
    lines = LineCollection(runs, **style)
    axes.add_collection(lines, autolim=False)
    return lines
