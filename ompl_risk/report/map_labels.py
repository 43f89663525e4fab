"""Labels of curves on a map, where they cover neither each other nor other curves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from ompl_risk._arrays import FloatArray
from ompl_risk.report.style import DPI, INK, SIZES
from ompl_risk.report.text_size import POINTS_PER_INCH, text_width

COVERING = 0.1
"""Factor on the distance from other curves where a label would cover something."""
NOWHERE: FloatArray = np.empty((0, 2))
PAD, EDGE, CAPITALS = 0.25, 2.0, 0.8
"""Around a label's text, in sizes of its type; width of the edge [pt]; height of the letters, in
sizes of the type."""


def label_points(
    curves: Sequence[FloatArray],
    *,
    size: tuple[float, float] = (0.0, 0.0),
    avoid: FloatArray = NOWHERE,
) -> list[FloatArray]:
    """Where to label each curve: where it is farthest from the others and from labels so far.

    Places where a label would cover another one come last; those where it would cover an end or
    what is to be avoided count as nearer than they are.

    Args:
        curves: points (n, 2), all in the same unit.
        size: width and height of a label, in the same unit.
        avoid: more places (k, 2) that are not to be covered.

    Returns:
        A point (2,) on each curve.
    """
    ends = np.concatenate([curve[[0, -1]] for curve in curves])
    shape = np.array([size[1] / size[0] if size[0] > 0.0 else 1.0, 1.0])
    taken: list[FloatArray] = []
    for i, curve in enumerate(curves):
        inner = curve[len(curve) // 10 : -len(curve) // 10 or None]
        others = [other for k, other in enumerate(curves) if k != i]
        gap = _distance(inner, np.concatenate([ends, *others]))
        if taken:
            gap = np.minimum(gap, _distance(inner * shape, np.array(taken) * shape))
        gap[_apart(inner, np.concatenate([ends, avoid]), size) < 1.0] *= COVERING
        room = np.minimum(1.0, _apart(inner, np.reshape(taken, (-1, 2)), size))
        taken.append(inner[int(np.lexsort((gap, room))[-1])])
    return taken


def label_size(axes: Axes, labels: Sequence[str]) -> tuple[float, float]:
    """Width and height of the widest label, in the unit of axes of fixed size and equal scales."""
    unit = float(np.ptp(axes.get_xlim())) / axes.get_window_extent().width * DPI  # an inch
    high = (SIZES["text"] * (CAPITALS + 2.0 * PAD) + 2.0 * EDGE) / POINTS_PER_INCH
    pads = (2.0 * PAD * SIZES["text"] + 2.0 * EDGE) / POINTS_PER_INCH
    wide = max(text_width(label, SIZES["text"], bold=True) for label in labels)
    return unit * max(wide + pads, high), unit * high


def draw_label(axes: Axes, label: str, point: FloatArray, edge: str) -> None:
    """Write a label in a white frame, centred at a point."""
    axes.annotate(
        label,
        (float(point[0]), float(point[1])),
        ha="center",
        va="center",
        fontsize=SIZES["text"],
        fontweight="bold",
        color=INK,
        bbox={
            "boxstyle": f"{'circle' if len(label) == 1 else 'round'},pad={PAD}",
            "facecolor": "white",
            "edgecolor": edge,
            "linewidth": EDGE,
        },
    )


def _distance(points: FloatArray, others: FloatArray) -> FloatArray:
    """Distance of each point to the nearest of the others."""
    steps = points[:, None, :] - others[None, :, :]
    return np.sqrt((steps**2).sum(axis=2)).min(axis=1)


def _apart(points: FloatArray, others: FloatArray, size: tuple[float, float]) -> FloatArray:
    """How far rectangles of a size at points are from those at others: 1 where they touch.

    ::

        min over others of max(|dx| / width, |dy| / height)
    """
    if len(others) == 0 or min(size) <= 0.0:
        return np.full(len(points), np.inf)
    steps = np.abs(points[:, None, :] - others[None, :, :]) / np.array(size)
    return steps.max(axis=2).min(axis=1)
