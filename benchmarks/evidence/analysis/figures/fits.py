"""How the objective on training depends on what is tuned."""

from __future__ import annotations

import math
from collections.abc import Callable

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from benchmarks.evidence.analysis.figures.looks import heading, tidy
from benchmarks.evidence.analysis.fitting import Family, Fit
from benchmarks.evidence.analysis.settings import ExpectedCollisions, NormOf, Setting
from ompl_risk import Lp, Sobolev
from ompl_risk._arrays import FloatArray
from ompl_risk.report.style import SIZES, colour, dashes, new_figure

Parameter = Callable[[Setting], float | None]
INFINITE = 32.0
"""Where p = inf is drawn."""


def length(setting: Setting) -> float | None:
    """d0, r or sigma [m]."""
    if isinstance(setting, ExpectedCollisions):
        return setting.rate.sigma
    return setting.integrand.scale if isinstance(setting, NormOf) else None


def time_scale(setting: Setting) -> float | None:
    """tau of a Sobolev norm [s]."""
    norm = setting.norm if isinstance(setting, NormOf) else None
    return norm.time_scale if isinstance(norm, Sobolev) else None


def exponent(setting: Setting) -> float | None:
    """p of an L^p norm."""
    norm = setting.norm if isinstance(setting, NormOf) else None
    return (INFINITE if math.isinf(norm.p) else norm.p) if isinstance(norm, Lp) else None


PARAMETERS: tuple[tuple[str, Parameter], ...] = (
    ("length of the integrand, d0, r or σ [m]", length),
    ("time scale τ of H1 [s]", time_scale),
    ("exponent p of L^p", exponent),
)


def fit_curves(fit: Fit) -> Figure:
    """The best objective at each value of a parameter, a panel for each parameter."""
    figure = new_figure(13.0, 5.6)
    panels = figure.subplots(1, len(PARAMETERS), sharey=True)
    for axes, (words, parameter) in zip(panels, PARAMETERS, strict=True):
        for k, (family, objective) in enumerate(zip(fit.families, fit.objectives, strict=True)):
            points = curve(family, objective, parameter)
            if len(points) > 1:
                axes.plot(*zip(*points, strict=True), color=colour(k), linestyle=dashes(k),
                          linewidth=1.6, marker="o", markersize=3.0, label=family.name)  # fmt: skip
        _scale(axes, words)
    panels[0].set_ylabel("(safest found + tau) / 2", fontsize=SIZES["small"])
    named = {
        label: handle
        for axes in panels
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    names = [family.name for family in fit.families if family.name in named]
    figure.legend([named[n] for n in names], names, loc="lower center", ncols=4, frameon=False,
                  fontsize=SIZES["small"] - 0.5)  # fmt: skip
    heading(
        figure,
        "What was tuned, on training units",
        f"objective over {fit.sets[0]} decided training sets; at each value the best over a "
        "family's other parameter",
    )
    figure.subplots_adjust(left=0.055, right=0.99, wspace=0.05, top=0.83, bottom=0.28)
    return figure


def curve(family: Family, objective: FloatArray, parameter: Parameter) -> list[tuple[float, float]]:
    """Values of a parameter with the best objective there, in order; empty without it."""
    best: dict[float, float] = {}
    for setting, reached in zip(family.settings, objective, strict=True):
        value = parameter(setting)
        if value is not None:
            best[value] = max(best.get(value, -math.inf), float(reached))
    return sorted(best.items())


def _scale(axes: Axes, words: str) -> None:
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    ticks = [m * 10.0**e for e in range(-2, 4) for m in (1, 2, 5)]
    if "exponent" in words:
        ticks = [1.0, 1.5, 2.0, 3.0, 4.0, 8.0, 16.0, INFINITE]
    axes.set_xticks([tick for tick in ticks if low <= tick <= high])
    axes.xaxis.set_minor_locator(NullLocator())
    infinite = INFINITE if "exponent" in words else math.nan
    axes.xaxis.set_major_formatter(
        FuncFormatter(lambda value, _: "∞" if value == infinite else f"{value:g}")
    )
    axes.set_xlabel(words, fontsize=SIZES["small"])
    tidy(axes)
