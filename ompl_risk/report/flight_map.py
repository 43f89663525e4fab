"""A small map of one flight."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from ompl_risk.report.style import INK, SIZES
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.terrains import Terrain

KM = 1e-3
MARGIN = 0.12
"""Room around the flight, as a part of its extent."""


def draw_flight_map(axes: Axes, terrain: Terrain, flight: Trajectory, colour: str) -> None:
    """Draw a flight from above on a hillshade, in kilometres and in one scale.

    Args:
        axes: where to draw, of fixed size; the map fills them as far as there is ground.
        terrain: the ground.
        flight: drawn with its start as a dot and its goal as a star.
        colour: of its line.
    """
    places = flight.positions[:, :2]
    low, high = places.min(axis=0), places.max(axis=0)
    box = axes.get_window_extent()
    shape = np.array([box.width, box.height])
    room = (high - low) + 2.0 * MARGIN * float((high - low).max(initial=1.0))
    half = 0.5 * float((room / shape).max()) * shape
    middle = 0.5 * (low + high)
    xmin, xmax, ymin, ymax = terrain.extent
    west, south = np.clip(middle - half, [xmin, ymin], [xmax, ymax])
    east, north = np.clip(middle + half, [xmin, ymin], [xmax, ymax])
    shown = terrain.window((west, south, east, north))
    x0, x1, y0, y1 = (KM * edge for edge in shown.extent)
    axes.imshow(
        shown.hillshade(), cmap="gray", vmin=-1.1, vmax=1.05, interpolation="bilinear",
        origin="lower", extent=(x0, x1, y0, y1),
    )  # fmt: skip
    edge = [withStroke(linewidth=3.4, foreground="white")]
    axes.plot(*(KM * places.T), color=colour, linewidth=1.8, path_effects=edge)
    for i, mark, size in ((0, "o", 7), (-1, "*", 12)):
        axes.plot(*(KM * places[i]), mark, color=INK, markeredgecolor="white", markersize=size)
    axes.set_xlim(KM * (middle - half)[0], KM * (middle + half)[0])
    axes.set_ylim(KM * (middle - half)[1], KM * (middle + half)[1])
    axes.set_facecolor("#E8E8E8")
    axes.tick_params(labelsize=SIZES["small"] - 1.0, length=2.5)
    axes.text(
        0.97, 0.95, "km", transform=axes.transAxes, ha="right", va="top", color=INK,
        fontsize=SIZES["small"], path_effects=[withStroke(linewidth=3, foreground="white")],
    )  # fmt: skip
