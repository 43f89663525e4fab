"""Expected number of collisions against the closed-loop probability."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from benchmarks.evidence.analysis.figures.looks import heading, tidy
from benchmarks.evidence.analysis.findings import Findings
from ompl_risk.report.style import COLOURS, FAINT, INK, SIZES, new_figure


def calibration_figure(findings: Findings) -> Figure:
    """A panel for each level: flights, and means of tenths of them."""
    figure = new_figure(12.0, 4.9)
    panels = figure.subplots(1, len(findings.calibration), sharex=True, sharey=True)
    least = 0.5 / int(findings.test.rollouts.max())
    for axes, each in zip(panels, findings.calibration, strict=True):
        axes.plot(
            np.maximum(each.predicted, least / 2), np.maximum(each.observed, least), "o",
            color=COLOURS[5], markersize=2.5, alpha=0.5, markeredgewidth=0.0, label="test flights",
        )  # fmt: skip
        predicted, observed = each.groups()
        axes.plot(
            np.maximum(predicted, least / 2), np.maximum(observed, least), "o",
            color=COLOURS[3], markersize=6.0, markeredgecolor="white", label="tenths of them, mean",
        )  # fmt: skip
        axes.plot([least / 2, 1.0], [least / 2, 1.0], color=INK, linewidth=1.0, label="equal")
        axes.axhline(least, color=FAINT, linestyle=":", linewidth=1.0)
        axes.set(xscale="log", yscale="log")
        axes.set_title(f"{each.level}: {each.setting.label}", fontsize=SIZES["small"], loc="left")
        axes.set_xlabel("predicted probability", fontsize=SIZES["small"])
        tidy(axes)
    panels[0].set_ylabel("closed-loop probability", fontsize=SIZES["small"])
    panels[0].set_ylim(least / 1.5, 1.3)
    panels[0].set_xlim(least / 3, 1.3)
    panels[0].legend(loc="upper left", frameon=False, fontsize=SIZES["small"] - 0.5)
    heading(
        figure,
        "Does the expected number of collisions give the probability?",
        "rates fitted by likelihood on training flights, shown on test flights; "
        "on the dotted line: no collision in any rollout",
    )
    figure.subplots_adjust(left=0.07, right=0.985, wspace=0.06, top=0.79, bottom=0.12)
    return figure
