"""The figure of closed-loop rollouts: where they collide, and how near they come."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ompl_risk.report.plan_view import KM, draw_plan_view
from ompl_risk.report.style import FAINT, INK, SIZES, colour, dashes, new_figure, save, short

if TYPE_CHECKING:
    from ompl_risk.simulation import CollisionEstimate
    from ompl_risk.terrains import Terrain
    from ompl_risk.trajectory import Trajectory

HEIGHT, LINE, LEFT = 6.6, 0.25, 0.045
"""Least height, and height of a line of the legend [inch]; where the map begins, as a part."""
FARTHEST = 0.99
"""Share of rollouts up to which the distribution of least clearance is drawn."""


def closed_loop_figure(
    trajectories: Sequence[Trajectory],
    estimates: Sequence[CollisionEstimate],
    terrain: Terrain,
    *,
    title: str = "",
    path: str | Path | None = None,
) -> Figure:
    """Draw the paths with the places of collision, and the distribution of least clearance.

    Args:
        trajectories: the paths as planned, one or more.
        estimates: of each, in the same order.
        terrain: the ground.
        title: what stands above the map.
        path: where to write the figure, if given.

    Returns:
        The figure, 1600 pixels wide.

    Raises:
        FileError: the file cannot be written.
    """
    names = short([trajectory.name for trajectory in trajectories])
    height = max(HEIGHT, 1.9 + LINE * len(names))
    low, tall = 0.6 / height, 1.0 - 1.45 / height
    figure = new_figure(16.0, height)
    figure.text(
        LEFT, 1.0 - 0.36 / height, title, fontsize=SIZES["title"], fontweight="bold", color=INK,
        va="center",
    )  # fmt: skip
    plan = figure.add_axes((LEFT, low, 0.41, tall))
    places = [estimate.places[:, :2] for estimate in estimates]
    draw_plan_view(plan, terrain, trajectories, names, marks=np.concatenate(places))
    for k, place in enumerate(places):
        plan.plot(
            *(KM * place.T), "X", color=colour(k), markersize=9, markeredgecolor=INK, zorder=6
        )
    plan.set_title("crosses: collisions", fontsize=SIZES["text"], loc="left", color=INK)
    _draw_distributions(figure.add_axes((0.505, low, 0.275, tall)), names, estimates)
    if path is not None:
        save(figure, path)
    return figure


def _draw_distributions(
    axes: Axes, names: Sequence[str], estimates: Sequence[CollisionEstimate]
) -> None:
    """Share of rollouts that come nearer than a distance; at 0 it is the share that collides."""
    top = max(float(estimate.quantiles(FARTHEST)) for estimate in estimates)
    for k, (name, estimate) in enumerate(zip(names, estimates, strict=True)):
        levels = np.linspace(0.0, 1.0, 401)
        d = np.clip(estimate.quantiles(levels), 0.0, top)
        axes.step(
            d, levels, where="post", color=colour(k), linestyle=dashes(k), linewidth=1.8,
            label=f"{name}: {_probability(estimate)}",
        )  # fmt: skip
    axes.set_xlim(0.0, max(top, 1.0))
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("least clearance of a rollout [m]", fontsize=SIZES["text"])
    axes.set_title("share of rollouts that come nearer", fontsize=SIZES["text"], loc="left")
    axes.tick_params(labelsize=SIZES["small"])
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(
        title=f"probability of a collision\n(interval: {100 * estimates[0].confidence:.4g} %)",
        fontsize=SIZES["small"], title_fontsize=SIZES["small"], frameon=False,
        loc="upper left", bbox_to_anchor=(1.02, 1.02), alignment="left", borderaxespad=0.0,
    )  # fmt: skip


def _probability(estimate: CollisionEstimate) -> str:
    if estimate.hits == 0:
        return f"none of {estimate.rollouts:,}, at most {estimate.high:.2g}"
    return f"{estimate.probability:.3g} ({estimate.low:.2g} to {estimate.high:.2g})"
