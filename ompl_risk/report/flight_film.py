"""The pictures of a film of a flight: chase view, map, d(t) and f(t)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from ompl_risk._arrays import FloatArray
from ompl_risk.clearance import TerrainClearance
from ompl_risk.ranking.sampling import distances
from ompl_risk.report.chase import Chase
from ompl_risk.report.chase_view import ChaseView
from ompl_risk.report.flight_map import draw_flight_map
from ompl_risk.report.style import FAINT, INK, SIZES, colour, new_figure
from ompl_risk.report.time_plots import BEYOND, LARGEST_F, in_unit
from ompl_risk.trajectory import Trajectory

if TYPE_CHECKING:
    from ompl_risk.avoidance import Avoidance
    from ompl_risk.ranking.sampling import Clearance
    from ompl_risk.terrains import Terrain

WIDTH, HEIGHT = 9.6, 5.4
STEP = 5.0
"""Longest step between samples of d(t) [m]."""
LEFT, WIDE = 0.685, 0.3
"""Where the plots stand, as parts of the figure's width."""


class Film:
    """A figure that shows any frame of a flight.

    Args:
        trajectory: the flight.
        terrain: the ground.
        clearance: distance to obstacles.
        avoidance: f(d), or None.
        times: of the frames [s].
        index: of the flight's colour.

    Raises:
        ExtentError: the flight leaves the terrain.
        ArgumentError: the clearance returns no distances.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        terrain: Terrain,
        clearance: Clearance,
        avoidance: Avoidance | None,
        times: FloatArray,
        index: int,
    ) -> None:
        terrain.height(*trajectory.positions[:, :2].T)  # refuses flights that leave it
        self._markers: list[tuple[Line2D, FloatArray]] = []
        self._colour = colour(index)
        self.chase = Chase.along(trajectory, terrain, times)
        fine = trajectory.densify(STEP)
        d, self.distances = distances(clearance, fine), distances(clearance, self.chase.flight)
        self.figure = new_figure(WIDTH, HEIGHT)
        self._add_view(trajectory)
        self._add_map(fine)
        self._add_distance(fine.t, d, avoidance)
        if avoidance is not None:
            self._add_avoidance(fine.t, avoidance(d), avoidance)
        self.figure.axes[-1].set_xlabel("$t$ [s]", fontsize=SIZES["small"], labelpad=1.0)
        self.nearest = None
        if isinstance(clearance, TerrainClearance):
            self.nearest = clearance.nearest(self.chase.flight.positions)

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return len(self.chase.flight)

    def draw(self, frame: int) -> None:
        """Show a frame in place of the one before."""
        nearest = None if self.nearest is None else self.nearest[frame]
        self.view.draw(frame, float(self.distances[frame]), nearest)
        for marker, places in self._markers:
            marker.set_data(places[frame : frame + 1].T)

    def _add_view(self, trajectory: Trajectory) -> None:
        axes = self.figure.add_axes((0.0, 0.0, 0.62, 1.0))
        between = float(self.chase.flight.t[1] - self.chase.flight.t[0])
        whole = trajectory.resample(step=0.5 * between)
        self.view = ChaseView(axes, self.chase, whole, self._colour)

    def _add_map(self, fine: Trajectory) -> None:
        axes = self.figure.add_axes((LEFT, 0.67, WIDE, 0.31))
        draw_flight_map(axes, self.chase.terrain, fine, self._colour)
        self._mark(axes, 1e-3 * self.chase.flight.positions[:, :2])

    def _add_distance(self, t: FloatArray, d: FloatArray, avoidance: Avoidance | None) -> None:
        tall = 0.46 if avoidance is None else 0.19
        axes = self.figure.add_axes((LEFT, 0.57 - tall, WIDE, tall))
        finite = d[np.isfinite(d)]
        top = 1.05 * float(finite.max(initial=1.0))
        if avoidance is not None:
            top = min(top, BEYOND * avoidance.d0)
            axes.axhline(avoidance.d0, color=INK, linewidth=1.0, linestyle=(0, (4, 2)))
        low = min(0.0, float(finite.min(initial=0.0)))
        axes.set_ylim(low, top)
        self._plot(axes, t, d, "distance to obstacles $d(t)$ [m]")
        self._mark(
            axes, np.stack([self.chase.flight.t, np.clip(self.distances, low, 0.97 * top)], axis=1)
        )

    def _add_avoidance(self, t: FloatArray, f: FloatArray, avoidance: Avoidance) -> None:
        axes = self.figure.add_axes((LEFT, 0.11, WIDE, 0.19))
        peak = min(float(f.max()), float(avoidance(avoidance.d0 / LARGEST_F)))
        top = 1.08 * peak if peak > 0.0 else avoidance.typical
        axes.set_ylim(0.0, top)
        self._plot(
            axes, t, np.minimum(f, 2.0 * top), f"avoidance function $f(t)${in_unit(avoidance)}"
        )
        at_frames = np.minimum(avoidance(self.distances), 0.97 * top)
        self._mark(axes, np.stack([self.chase.flight.t, at_frames], axis=1))

    def _plot(self, axes: Axes, t: FloatArray, values: FloatArray, title: str) -> None:
        axes.plot(t, values, color=self._colour, linewidth=1.4)
        axes.set_xlim(float(self.chase.flight.t[0]), float(self.chase.flight.t[-1]))
        axes.set_title(title, fontsize=SIZES["small"], loc="left", color=INK, pad=6.0)
        axes.tick_params(labelsize=SIZES["small"] - 1.0, length=2.5)
        axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)

    def _mark(self, axes: Axes, places: FloatArray) -> None:
        """A dot that moves with the frames, places of shape (frames, 2)."""
        (marker,) = axes.plot(
            [], [], "o", color=self._colour, markersize=8, markeredgecolor=INK,
            markeredgewidth=1.2, zorder=10, clip_on=False,
        )  # fmt: skip
        self._markers.append((marker, places))
