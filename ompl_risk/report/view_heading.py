"""What stands above a view of a flight: its name, from where it is seen, and the north."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from ompl_risk._arrays import FloatArray
from ompl_risk.report.camera import Camera
from ompl_risk.report.style import DPI, INK, SIZES
from ompl_risk.report.viewpoints import named

ARROW = 0.22
"""Half the length of the arrow to the north, seen from above [inch]."""


def draw_heading(axes: Axes, label: str, azimuth: float, edge: str) -> None:
    """Name the flight that a view shows, and from where it is seen."""
    width, height = size(axes)
    name = axes.text(
        0.3 / width, 1.0 - 0.3 / height, label, transform=axes.transAxes, va="center",
        ha="center" if len(label) == 1 else "left", fontsize=SIZES["title"], fontweight="bold",
        color=INK,
        bbox={
            "boxstyle": "circle,pad=0.3" if len(label) == 1 else "round,pad=0.3",
            "facecolor": "white", "edgecolor": edge, "linewidth": 2.5,
        },
    )  # fmt: skip
    axes.annotate(
        f"seen from the {named(azimuth)}", (1.0, 0.5), xycoords=name, xytext=(14.0, 0.0),
        textcoords="offset points", va="center", fontsize=SIZES["text"], color=INK,
    )  # fmt: skip


def draw_compass(axes: Axes, camera: Camera) -> None:
    """An arrow to the north in the ground's plane, as the camera sees it, in the upper corner."""
    right, up, _ = camera.axes
    inches = size(axes)
    middle = 1.0 - 0.42 / inches
    arrow = ARROW * np.array([right[1], up[1]])  # the image of (0, 1, 0)
    letter = arrow * (1.0 + 0.13 / float(np.linalg.norm(arrow)))
    axes.annotate(
        "", tuple(middle + arrow / inches), tuple(middle - arrow / inches),
        xycoords="axes fraction", textcoords="axes fraction",
        arrowprops={
            "arrowstyle": "-|>", "color": INK, "linewidth": 1.4, "shrinkA": 0.0, "shrinkB": 0.0,
        },
    )  # fmt: skip
    x, y = middle + letter / inches
    axes.text(
        x, y, "N", transform=axes.transAxes, ha="center", va="center",
        fontsize=SIZES["small"], fontweight="bold", color=INK,
    )  # fmt: skip


def size(axes: Axes) -> FloatArray:
    """Width and height of axes of fixed size [inch]."""
    box = axes.get_window_extent()
    return np.array([box.width, box.height]) / DPI
