"""Duration against risk: which objectives give paths that no other path beats in both."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from numpy.typing import NDArray

from benchmarks.campaign.figures.looks import (
    LOOKS,
    Floats,
    decimal_ticks,
    heading,
    tidy,
    unit_label,
)
from benchmarks.campaign.metrics import METRICS
from benchmarks.campaign.objectives import NORMS
from benchmarks.campaign.planners import PLANNERS
from benchmarks.campaign.run import prepared
from benchmarks.campaign.table import Row
from ompl_risk.report.style import FAINT, INK, SIZES, new_figure

AGAINST = (*NORMS, "pc L2")
LINEAR = 0.1
"""Up to this excess of duration [%] the axis is linear, as 0 has no logarithm."""


def pareto_figure(scene: str, rows: Sequence[Row]) -> Figure:
    """Draw all paths by duration and each norm, and the front of those that none beats.

    Args:
        scene: name of the scene.
        rows: its runs.
    """
    solved = [each for each in rows if each["status"] == "solved"]
    width, height = 16.0, 8.3
    figure = new_figure(width, height)
    grid = figure.subplots(2, 4, squeeze=False)
    first = next((p for p in PLANNERS if any(each["planner"] == p for each in rows)), "")
    heading(
        figure,
        f"Duration against risk: {prepared(scene).about}",
        f"Every path of every seed; filled: {first}, hollow: the other planners. The line is the "
        f"Pareto front of all paths: nothing lies below and left of it. {_shortest(solved)}",
    )
    for axes, name in zip(grid.flat, AGAINST, strict=True):
        _draw(axes, name, solved, first)
    for axes in grid[-1]:
        axes.set_xlabel("duration above the shortest [%]", fontsize=SIZES["small"])
    there = {each["objective"] for each in rows}
    handles = [
        Line2D([], [], color=look.colour, marker=look.marker, linestyle="none", label=look.label)
        for name, look in LOOKS.items()
        if name in there
    ]
    figure.legend(
        handles=handles, loc="lower center", ncols=len(handles), fontsize=SIZES["text"],
        frameon=False, columnspacing=1.4, handletextpad=0.2,
    )  # fmt: skip
    figure.subplots_adjust(0.05, 0.125, 0.99, 0.875, wspace=0.22, hspace=0.26)
    return figure


def front(points: Floats) -> NDArray[np.intp]:
    """Indices of the points that no other beats.

    One point beats another if it is less in one column and no more in the other.

    Args:
        points: shape (n, 2), finite.

    Returns:
        Indices in the order of the first column; of equal points one.
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    least = np.minimum.accumulate(points[order, 1])
    better = np.append(True, points[order[1:], 1] < least[:-1]) if len(order) else []
    return order[np.asarray(better, dtype=bool)]


def _shortest(rows: Sequence[Row]) -> str:
    if not rows:
        return ""
    return f"The shortest path takes {min(each['duration'] for each in rows):.4g} s."


def _draw(axes: Axes, name: str, rows: Sequence[Row], first: str) -> None:
    metric = METRICS[name]
    title = "$L^2$ norm of $P_c$" if name == "pc L2" else f"{LOOKS[name].label} norm of $f$"
    axes.set_title(f"{title} [{unit_label(metric.unit)}]", fontsize=SIZES["text"], loc="left")
    tidy(axes)
    positive = [each[name] for each in rows if each[name] > 0.0]
    if not positive:
        text = "no risk" if rows else "no path"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, color=FAINT, ha="center")
        return
    zero = min(positive) / 2.0  # 0 has no logarithm: such paths lie on the bottom edge
    shortest = min(each["duration"] for each in rows)
    excess = [100.0 * (each["duration"] / shortest - 1.0) for each in rows]
    points = np.column_stack([excess, [each[name] or zero for each in rows]])
    best = points[front(points)]
    _scale(axes, points)
    axes.step(*_extended(axes, best).T, where="post", color=INK, linewidth=1.0, zorder=1)
    for each, (x, y) in zip(rows, points, strict=True):
        look, filled = LOOKS[each["objective"]], each["planner"] == first
        axes.plot(
            x, y, look.marker, color=look.colour, markersize=7.0 if filled else 5.0,
            markerfacecolor=look.colour if filled else "none",
            markeredgecolor="white" if filled else look.colour,
            markeredgewidth=0.6 if filled else 0.9, zorder=3 if filled else 2,
        )  # fmt: skip
    if len(positive) < len(rows):
        text = f"on the bottom edge: {len(rows) - len(positive)} paths of 0"
        axes.text(
            1.0, 1.02, text, transform=axes.transAxes, ha="right", va="bottom",
            fontsize=SIZES["small"] - 1.5, color=INK,
        )  # fmt: skip


def _scale(axes: Axes, points: Floats) -> None:
    axes.set_xscale("symlog", linthresh=LINEAR, linscale=0.5)
    axes.set_xlim(-0.25 * LINEAR, 1.6 * max(float(points[:, 0].max()), LINEAR))
    axes.xaxis.set_major_locator(FixedLocator([0.0, 0.1, 1.0, 10.0, 100.0, 1000.0]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    low, high = float(points[:, 1].min()) / 1.1, float(points[:, 1].max()) * 1.25
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    decimal_ticks(axes.yaxis, low, high)


def _extended(axes: Axes, best: Floats) -> Floats:
    """The front with its ends drawn out to the axes' edges."""
    top, right = axes.get_ylim()[1], axes.get_xlim()[1]
    return np.vstack([(best[0, 0], top), best, (right, best[-1, 1])])
