"""Objectives by metrics: what minimising one costs in terms of the others."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.figure import Figure

from benchmarks.campaign.figures.looks import LOOKS, Floats, heading, metric_label, unit_label
from benchmarks.campaign.metrics import METRICS
from benchmarks.campaign.run import prepared
from benchmarks.campaign.summary import Standing
from ompl_risk.report.style import COLOURS, FAINT, INK, SIZES, new_figure

MOST = 4.0
"""Ratios from here on have the strongest colour."""
MAP = LinearSegmentedColormap.from_list("ratio", ["#FFFFFF", "#FDE3CF", COLOURS[3]])
CELL = 0.54, 0.36  # inch


def matrix_figure(scene: str, standings: Sequence[Standing]) -> Figure:
    """Draw, for each planner, the medians of every metric relative to the best objective.

    Args:
        scene: name of the scene.
        standings: those of the scene.
    """
    planners = list(dict.fromkeys(each.planner for each in standings))
    objectives = [name for name in LOOKS if name in {each.objective for each in standings}]
    columns = min(2, len(planners))
    lines = -(-len(planners) // columns)
    wide, tall = CELL[0] * len(METRICS), CELL[1] * len(objectives)
    width, height = columns * (wide + 1.35) + 0.2, lines * (tall + 1.1) + 0.75
    figure = new_figure(width, height)
    heading(
        figure,
        f"What each objective costs: {prepared(scene).about}",
        "Medians over seeds as multiples of the best objective's (1.00, bold; inverted for the "
        "least clearance, min d). Below: the best, or the upper bound of a probability that "
        "was estimated as 0. On the right: runs with a path, unless all.",
    )
    for k, planner in enumerate(planners):
        line, column = divmod(k, columns)
        left, top = column * (wide + 1.35) + 1.25, height - 0.75 - line * (tall + 1.1) - 0.72
        axes = figure.add_axes((left / width, (top - tall) / height, wide / width, tall / height))
        chosen = [each for each in standings if each.planner == planner]
        _draw(axes, planner, objectives, chosen)
    return figure


def ratios(medians: Floats, *, higher: bool = False, zero: float = 0.0) -> Floats:
    """Each median over the best one, at least 1; inf without a path.

    Args:
        medians: of a metric, shape (n,); not finite where there is no path.
        higher: whether more is better.
        zero: what a best value of 0 stands for, such as the upper bound of a probability.

    Returns:
        Ratios; where the best is 0 those that are not 0 are infinitely worse, unless `zero` tells
        how little worse they may be: then at least so many times.
    """
    there = np.isfinite(medians)
    found = np.full(medians.shape, math.inf)
    if not there.any():
        return found
    best = medians[there].max() if higher else medians[there].min()
    with np.errstate(divide="ignore", invalid="ignore"):
        quotients = best / medians if higher else medians / (best or zero)
    quotients[medians == best] = 1.0
    quotients = np.maximum(quotients, 1.0)
    found[there] = quotients[there]
    return found


def _draw(
    axes: Axes, planner: str, objectives: Sequence[str], standings: Sequence[Standing]
) -> None:
    by_name = {(each.objective, each.metric): each for each in standings}
    medians = np.array(
        [[by_name[o, m].spread.median if (o, m) in by_name else math.nan for m in METRICS]
         for o in objectives]
    )  # fmt: skip
    zeros = [_zero([each for each in standings if each.metric == name]) for name in METRICS]
    table = np.column_stack(
        [
            ratios(medians[:, k], higher=metric.better == "higher", zero=zeros[k])
            for k, metric in enumerate(METRICS.values())
        ]
    )
    shown = np.ma.masked_invalid(np.where(np.isfinite(medians), np.minimum(table, MOST), np.nan))
    axes.imshow(shown, cmap=MAP, norm=LogNorm(1.0, MOST), aspect="auto")
    axes.set_facecolor("#EDEDED")
    for i, j in np.ndindex(*table.shape):
        _cell(axes, j, i, float(table[i, j]), bool(np.isfinite(medians[i, j])))
    _labels(axes, objectives, medians, zeros)
    solved = {each.objective: (each.solved, each.runs) for each in standings}
    for i, name in enumerate(objectives):
        found, runs = solved.get(name, (0, 0))
        if found < runs:
            text = f"{found}/{runs}"
            axes.text(
                len(METRICS) - 0.42, i, text, fontsize=SIZES["small"] - 2, color=FAINT, va="center"
            )
    axes.set_title(planner, fontsize=SIZES["text"] + 1, loc="left", color=INK, pad=42)


def _cell(axes: Axes, x: int, y: int, ratio: float, there: bool) -> None:
    text = "no path" if not there else "∞" if math.isinf(ratio) else _ratio_text(ratio)
    best = there and ratio < 1.005
    axes.text(
        x, y, text, ha="center", va="center", color=INK if there else FAINT,
        fontsize=SIZES["small"] - (0.5 if there else 3.0), fontweight="bold" if best else "normal",
    )  # fmt: skip


def _ratio_text(ratio: float) -> str:
    return f"{ratio:.2f}" if ratio < 9.95 else f"{ratio:.0f}" if ratio < 9999 else f"{ratio:.0e}"


def _zero(standings: Sequence[Standing]) -> float:
    """The least upper bound of those objectives for which a probability of 0 was estimated."""
    return min((s.bounds[1] for s in standings if s.bounds and s.spread.median == 0.0), default=0.0)


def _labels(axes: Axes, objectives: Sequence[str], medians: Floats, zeros: Sequence[float]) -> None:
    axes.set_yticks(
        range(len(objectives)), [LOOKS[o].label for o in objectives], fontsize=SIZES["small"]
    )
    axes.set_xticks([])
    axes.tick_params(length=0)
    for k, (name, metric) in enumerate(METRICS.items()):
        axes.text(
            k, -1.02, metric_label(name), ha="center", va="center",
            fontsize=SIZES["small"] - 0.5, color=INK, linespacing=0.95,
        )  # fmt: skip
        column = medians[np.isfinite(medians[:, k]), k]
        if len(column):
            best = column.max() if metric.better == "higher" else column.min()
            text = f"{best:.3g}" if best or not zeros[k] else f"≤ {zeros[k]:.2g}"
            axes.text(
                k, len(objectives) - 0.22, text, ha="center", va="center",
                fontsize=SIZES["small"] - 2, color=FAINT,
            )  # fmt: skip
            unit = unit_label(metric.unit)
            axes.text(
                k, len(objectives) + 0.16, unit, ha="center", va="center",
                fontsize=SIZES["small"] - 2.5, color=FAINT,
            )  # fmt: skip
    axes.spines[:].set_visible(False)
