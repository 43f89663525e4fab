"""What stands beside the views of flights: headings, compass and legend."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ompl_risk.report.camera import Camera
from ompl_risk.report.flight_scene import Scene
from ompl_risk.report.style import FAINT, INK, SIZES, colour
from ompl_risk.report.viewpoints import named
from ompl_risk.trajectory import Trajectory

_ROW = 0.075


def draw_heading(axes: Axes, label: str, azimuth: float, edge: str) -> None:
    """Name the flight that a view shows, and from where it is seen."""
    axes.text(
        0.035, 0.95, label, transform=axes.transAxes, ha="left", va="center",
        fontsize=SIZES["title"], fontweight="bold", color=INK,
        bbox={
            "boxstyle": "circle,pad=0.3" if len(label) == 1 else "round,pad=0.3",
            "facecolor": "white", "edgecolor": edge, "linewidth": 2.5,
        },
    )  # fmt: skip
    axes.text(
        0.09 + 0.018 * len(label), 0.95, f"seen from the {named(azimuth)}",
        transform=axes.transAxes, ha="left", va="center", fontsize=SIZES["text"], color=INK,
    )  # fmt: skip


def draw_compass(axes: Axes, camera: Camera) -> None:
    """An arrow to the north in the ground's plane, as the camera sees it, in the upper corner."""
    right, up, _ = camera.axes
    arrow = np.array([right[1], up[1]])  # the image of (0, 1, 0)
    (x0, y0), half = (0.92, 0.9), np.full(2, 0.065)
    box = axes.get_window_extent()
    arrow = arrow * half * [box.height / box.width, 1.0]
    axes.annotate(
        "", (x0 + arrow[0], y0 + arrow[1]), (x0 - arrow[0], y0 - arrow[1]),
        xycoords="axes fraction", textcoords="axes fraction",
        arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.4},
    )  # fmt: skip
    axes.text(
        x0 + 1.7 * arrow[0], y0 + 1.7 * arrow[1], "N", transform=axes.transAxes, ha="center",
        va="center", fontsize=SIZES["small"], fontweight="bold", color=INK,
    )  # fmt: skip


def draw_legend(
    axes: Axes,
    scene: Scene,
    trajectories: Sequence[Trajectory],
    labels: Sequence[str],
    poses: int,
) -> None:
    """Name the flights' colours, durations and lengths, and what is not to scale."""
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.0)
    y = 0.9
    step = min(_ROW, 0.5 / len(labels))
    for i, (label, t) in enumerate(zip(labels, trajectories, strict=True)):
        axes.plot([0.06, 0.15], [y, y], color=colour(i), linewidth=3.0)
        _text(axes, 0.18, y, label, fontweight="bold")
        _text(axes, 0.42, y, f"{t.duration:.1f} s", ha="right" if len(label) < 4 else "left")
        _text(axes, 0.66, y, f"{1e-3 * t.length:.2f} km", ha="right")
        y -= step
    y -= 0.02
    axes.plot([0.06, 0.15], [y, y], color=FAINT, linewidth=1.6, linestyle=(0, (1, 2)))
    _text(axes, 0.18, y, "hidden behind a hill")
    axes.plot([0.06, 0.15], [y - _ROW, y - _ROW], color=INK, linewidth=0.9, alpha=0.6)
    _text(axes, 0.18, y - _ROW, "ground below the flight")
    for k, note in enumerate(_notes(scene, trajectories, poses)):
        _text(axes, 0.06, y - (2.1 + 0.8 * k) * _ROW, note, fontsize=SIZES["small"], color=FAINT)


def _notes(scene: Scene, trajectories: Sequence[Trajectory], poses: int) -> list[str]:
    (west, south, _), (east, north, _) = scene.box
    between = np.mean([t.duration for t in trajectories]) / poses
    return [
        f"helicopters: {scene.scale:g} times their size, every {between:.3g} s",
        f"ground: {1e-3 * (east - west):.3g} km from west to east, "
        f"{1e-3 * (north - south):.3g} km from south to north",
        f"heights: drawn {scene.exaggeration:g} times; attitudes are true",
    ]


def _text(axes: Axes, x: float, y: float, text: str, **style: Any) -> None:
    axes.text(x, y, text, **{"va": "center", "fontsize": SIZES["text"], "color": INK, **style})
