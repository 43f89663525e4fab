"""Where the recommended and the paper's settings win and lose."""

from __future__ import annotations

from matplotlib.figure import Figure

from benchmarks.evidence.analysis.figures.looks import colour, heading, name, tidy
from benchmarks.evidence.analysis.findings import Findings
from benchmarks.evidence.analysis.strata import strata
from ompl_risk.report.style import FAINT, SIZES, new_figure


def strata_figure(findings: Findings) -> Figure:
    """Share of sets in which the safest is found, and tau, by stratum."""
    rows, parts = findings.rows[: findings.paper.stop], strata(findings)
    figure = new_figure(11.0, 1.9 + 0.5 * len(parts))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, metric, factor in zip(panels, ("safest", "tau"), (100.0, 1.0), strict=True):
        for place, stratum in enumerate(parts):
            intervals = stratum.scores[metric]
            for k, row in enumerate(rows):
                mean, low, high = (factor * x for x in intervals[k])
                y = place + 0.15 * (k - (len(rows) - 1) / 2)
                axes.plot([low, high], [y, y], color=colour(row), linewidth=1.6)
                axes.plot(mean, y, "o", color=colour(row), markersize=5.0,
                          label=name(row) if place == 0 else None)  # fmt: skip
        for place in range(1, len(parts)):
            new = parts[place].group != parts[place - 1].group
            axes.axhline(place - 0.5, color=FAINT, linewidth=1.0 if new else 0.3)
        tidy(axes)
        axes.grid(visible=False, axis="y")
    labels = [f"{s.group}: {s.name}\n{int(s.counted.sum())} sets" for s in parts]
    panels[0].set_yticks(range(len(parts)), labels)
    panels[0].set_ylim(len(parts) - 0.5, -0.5)
    panels[0].set_xlabel("sets in which the safest of five is found [%]", fontsize=SIZES["small"])
    panels[1].set_xlabel("mean Kendall's tau with the probability", fontsize=SIZES["small"])
    heading(
        figure,
        "Where settings win and lose",
        "decided test sets; 95 % bootstrap intervals by unit",
    )
    height = figure.get_figheight()
    figure.subplots_adjust(left=0.3, right=0.985, wspace=0.06, top=1 - 0.85 / height,
                           bottom=1.0 / height)  # fmt: skip
    figure.legend(*panels[0].get_legend_handles_labels(), loc="lower center", ncols=3,
                  frameon=False, fontsize=SIZES["small"] - 0.5)  # fmt: skip
    return figure
