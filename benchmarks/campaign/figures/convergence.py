"""Cost over time: how soon each planner has found how good a path."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from benchmarks.campaign.figures.looks import (
    LOOKS,
    Floats,
    decimal_ticks,
    heading,
    tidy,
    unit_label,
)
from benchmarks.campaign.objectives import OBJECTIVES, Objective
from benchmarks.campaign.planners import PLANNERS
from benchmarks.campaign.run import prepared
from benchmarks.campaign.store import Record
from ompl_risk.report.style import FAINT, INK, SIZES, colour, new_figure

FIRST = 0.01
"""Where the time axis begins [s]."""
Curves = Mapping[str, Sequence[Sequence[Sequence[float]]]]


def convergence_figure(scene: str, records: Sequence[Record]) -> Figure:
    """Draw, for each objective, median and quartiles over seeds of the best cost so far.

    Args:
        scene: name of the scene.
        records: its runs.
    """
    there = {each["configuration"]["objective"] for each in records}
    names = [name for name in OBJECTIVES if name in there]
    columns = len(names) if len(names) < 4 else -(-len(names) // 2)
    lines = -(-len(names) // columns)
    width, height = 3.25 * columns + 0.3, 2.75 * lines + 1.35
    figure = new_figure(max(width, 9.0), height)
    grid = figure.subplots(lines, columns, squeeze=False)
    seeds = len({each["configuration"]["seed"] for each in records})
    heading(
        figure,
        f"Best cost so far over time: {prepared(scene).about}",
        f"Median (line) and quartiles (band) of {seeds} seeds; a line begins when more than "
        "half of the runs have a path. Less is better everywhere.",
    )
    for axes, name in zip(grid.flat, names, strict=False):
        chosen = [each for each in records if each["configuration"]["objective"] == name]
        _draw(axes, name, chosen)
    for axes in list(grid.flat)[len(names) :]:
        axes.set_axis_off()
    for axes in list(grid.flat)[len(names) - columns : len(names)]:
        axes.set_xlabel("processor time [s]", fontsize=SIZES["small"])
    figure.legend(
        *grid[0, 0].get_legend_handles_labels(), loc="lower center", ncols=len(PLANNERS),
        fontsize=SIZES["text"], frameon=False,
    )  # fmt: skip
    figure.subplots_adjust(
        left=0.75 / width, right=1.0 - 0.12 / width, bottom=0.98 / height, top=1.0 - 0.98 / height,
        wspace=0.3, hspace=0.4,
    )  # fmt: skip
    return figure


def best_so_far(curve: Sequence[Sequence[float]], times: Floats) -> Floats:
    """Cost of the best path at each time, inf before the first; shape (n,)."""
    costs = np.array([math.inf, *(cost for _, cost in curve)])
    return costs[np.searchsorted([t for t, _ in curve], times, side="right")]


def quantiles(samples: Floats) -> Floats:
    """Lower quartile, median and upper quartile of the columns, shape (3, n).

    As in `Spread`: runs without a path yet count with infinity, so quartiles are not interpolated.
    """
    ordered = np.sort(samples, axis=0)
    low, high = np.quantile(ordered, (0.25, 0.75), axis=0, method="nearest")
    n = len(ordered)
    return np.array([low, 0.5 * (ordered[(n - 1) // 2] + ordered[n // 2]), high])


def _draw(axes: Axes, name: str, records: Sequence[Record]) -> None:
    objective = OBJECTIVES[name]
    end = max(each["configuration"]["seconds"] for each in records)
    times = np.geomspace(min(FIRST, end / 10.0), end, 300)
    drawn: list[Floats] = []
    absent: list[str] = []
    for k, planner in enumerate(PLANNERS):
        runs = [each for each in records if each["configuration"]["planner"] == planner]
        if not runs:
            continue
        bands = quantiles(np.array([_values(objective, each, times) for each in runs]))
        _band(axes, times, bands, colour(k), planner)
        drawn.append(bands[np.isfinite(bands)])
        missing = sum(not each["result"].get("curve") for each in runs)
        if missing:
            absent.append(f"no path: {missing}/{len(runs)} {planner}")
    _limits(axes, np.concatenate(drawn), times)
    tidy(axes)
    inverted = ""
    if name == "clearance":  # its values are negative, as less is better
        inverted = ", more is lower"
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{abs(value):g}"))
    axes.set_title(
        f"{LOOKS[name].label} [{unit_label(objective.unit)}]{inverted}",
        fontsize=SIZES["text"],
        loc="left",
    )
    axes.text(
        0.98, 0.97, "\n".join(absent), transform=axes.transAxes, ha="right", va="top",
        fontsize=SIZES["small"] - 2.5, color=INK, linespacing=1.1,
        bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1.0},
    )  # fmt: skip


def _values(objective: Objective, record: Record, times: Floats) -> Floats:
    recipe: dict[str, Any] = record["configuration"]["objective recipe"]
    curve = record["result"].get("curve", [])
    return best_so_far([(t, objective.value(cost, recipe)) for t, cost in curve], times)


def _band(axes: Axes, times: Floats, bands: Floats, shade: str, label: str) -> None:
    low, middle, high = np.where(np.isfinite(bands), bands, np.nan)
    high = np.where(np.isfinite(low) & np.isnan(high), 1e30, high)  # beyond the axes
    axes.fill_between(times, low, high, color=shade, alpha=0.14, linewidth=0, step="post")
    axes.step(times, middle, color=shade, linewidth=1.8, label=label, where="post")


def _limits(axes: Axes, values: Floats, times: Floats) -> None:
    axes.set_xscale("log")
    axes.set_xlim(times[0], times[-1])
    decimal_ticks(axes.xaxis, times[0], times[-1])
    if not len(values):
        axes.set_yticks([])
        axes.text(0.5, 0.5, "no path", transform=axes.transAxes, ha="center", color=FAINT)
        return
    low, high = float(values.min()), float(values.max())
    if low > 0.0 and high > 1.5 * low:
        axes.set_yscale("log")
        axes.set_ylim(low / 1.1, high * 1.15)
        decimal_ticks(axes.yaxis, low / 1.1, high * 1.15)
        return
    margin = 0.08 * (high - low) or 0.05 * abs(high) or 1.0
    axes.set_ylim(low - margin, high + margin)
