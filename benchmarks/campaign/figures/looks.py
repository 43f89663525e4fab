"""How objectives and metrics look and are called in the campaign's figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ompl_risk.report.style import FAINT, INK, SIZES

Floats = NDArray[np.float64]


class Look(NamedTuple):
    """How an objective is drawn and called."""

    label: str
    colour: str
    marker: str


LOOKS = {
    "length": Look("length", "#000000", "X"),
    "L1": Look("$L^1$", "#9CC9E8", "o"),
    "L2": Look("$L^2$", "#56B4E9", "s"),
    "L4": Look("$L^4$", "#0072B2", "D"),
    "Linf": Look(r"$L^\infty$", "#003E66", "v"),
    "H1(0.3)": Look("$H^1$, 0.3 s", "#F2B27C", "o"),
    "H1": Look("$H^1$, 1 s", "#D55E00", "s"),
    "H1(3)": Look("$H^1$, 3 s", "#7F3300", "D"),
    "clearance": Look("clearance", "#009E73", "^"),
    "time+risk": Look("time + risk", "#CC79A7", "P"),
}
"""Families share a hue: L^p blue, H^1 orange; darker with p and with the time scale."""

METRIC_LABELS = {
    "duration": "time",
    "clearance": "min $d$",
    "pc L2": "$L^2$ of $P_c$",
    "pc max": "max $P_c$",
    "pc ever": "$P$(ever)",
}


def metric_label(name: str) -> str:
    """A metric as axes show it; norms as the objectives of that name."""
    return METRIC_LABELS.get(name) or LOOKS[name].label.replace(", ", "\n")


def unit_label(unit: str) -> str:
    """A unit as text of a figure: "s^(1/4)/m" with its exponent raised, none for a bare number."""
    return "" if unit == "1" else unit.replace("s^(1/4)", "s$^{1/4}$")


def heading(figure: Figure, title: str, note: str) -> None:
    """Title and, below it, what the figure shows; both above its axes."""
    height = figure.get_figheight()
    y = 1.0 - 0.3 / height
    figure.text(0.012, y, title, fontsize=SIZES["title"], fontweight="bold", color=INK, va="center")
    y -= 0.28 / height
    figure.text(0.012, y, note, fontsize=SIZES["small"], color=FAINT, va="center")


def tidy(axes: Axes) -> None:
    """Small ticks, a faint grid, no box."""
    axes.tick_params(labelsize=SIZES["small"] - 1.0, which="both")
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def decimal_ticks(axis: Any, low: float, high: float, *, most: int = 5) -> None:
    """Ticks of a logarithmic axis as plain numbers, also where it spans less than a decade."""
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    for steps in ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), tuple(np.arange(1.0, 10.0, 0.5))):
        exponents = range(int(np.floor(np.log10(low))) - 1, int(np.ceil(np.log10(high))) + 1)
        ticks = [s * 10.0**e for e in exponents for s in steps if low <= s * 10.0**e <= high]
        if len(ticks) >= 3:
            break
    else:
        ticks = [float(f"{t:.3g}") for t in np.linspace(low, high, 5)[1:-1]]
    axis.set_major_locator(FixedLocator(_thinned(ticks, most)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.4g}"))


def _thinned(ticks: Sequence[float], most: int) -> list[float]:
    every = -(-len(ticks) // most)
    return list(ticks)[::every]
