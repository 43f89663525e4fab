"""The figure of a Pareto set: how much risk a longer flight saves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ompl_risk.norms import Norm
from ompl_risk.ranking.export import norm_unit
from ompl_risk.report.norm_tables import mathematical
from ompl_risk.report.style import FAINT, INK, SIZES, colour, new_figure, save


def pareto_figure(
    durations: Sequence[float],
    norms: Sequence[float],
    norm: Norm,
    path: str | Path | None = None,
    *,
    unit: str = "1/m",
) -> Figure:
    """Draw norm against duration, with what no path of the roadmap reaches shaded.

    Args:
        durations: of the paths, rising [s].
        norms: of the same paths, falling.
        norm: which norm it is.
        path: where to write the figure, if given.
        unit: of the avoidance function.

    Returns:
        The figure, 900 pixels wide.

    Raises:
        FileError: the file cannot be written.
    """
    figure = new_figure(9.0, 6.0)
    axes = figure.add_axes((0.11, 0.11, 0.86, 0.73))
    if len(durations):
        span = max(durations) - min(durations) or 0.05 * durations[0]
        right = max(durations) + 0.05 * span
        axes.step(
            [*durations, right], [*norms, norms[-1]], where="post", color=colour(0), linewidth=1.4
        )
        axes.plot(durations, norms, "o", color=colour(0), markersize=4)
        left = min(durations) - 0.05 * span
        axes.set_xlim(left, right)
        top = 1.05 * max(norms) if max(norms) > 0.0 else 1.0
        axes.set_ylim(0.0, top)
        axes.fill_between(
            [left, *durations, right], 0.0, [top, *norms, norms[-1]], step="post", color=FAINT,
            alpha=0.12, linewidth=0,
        )  # fmt: skip
        axes.text(
            0.02, 0.04, "no path in the roadmap", transform=axes.transAxes, color=FAINT,
            fontsize=SIZES["small"],
        )  # fmt: skip
        _shares(axes, durations[0])
    root = norm_unit(norm, of=unit).replace("s^(1/2)", "√s")
    in_root = "" if root == "1" else f" [{root}]"
    axes.set_xlabel("duration [s]", fontsize=SIZES["text"])
    axes.set_ylabel(f"{mathematical(norm.label)} of $f${in_root}", fontsize=SIZES["text"])
    axes.tick_params(labelsize=SIZES["small"])
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    axes.spines["right"].set_visible(False)
    title = f"Pareto set of duration and risk: {_paths(len(durations))}"
    figure.text(0.11, 0.945, title, fontsize=SIZES["title"], fontweight="bold", color=INK)
    if path is not None:
        save(figure, path)
    return figure


def _paths(count: int) -> str:
    return "1 path" if count == 1 else f"{count} paths"


def _shares(axes: Axes, fastest: float) -> None:
    """How much longer than the fastest, above."""

    def longer(t: Any) -> Any:
        return 100.0 * (t / fastest - 1.0)

    def duration(share: Any) -> Any:
        return fastest * (1.0 + share / 100.0)

    above = axes.secondary_xaxis("top", functions=(longer, duration))
    above.tick_params(labelsize=SIZES["small"])
    above.set_xlabel("longer than the fastest [%]", fontsize=SIZES["small"], color=FAINT)
