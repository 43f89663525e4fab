"""How settings did on the test units, and by how much the recommended one differs from each."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.evidence.analysis.figures.looks import colour, heading, name, tidy
from benchmarks.evidence.analysis.findings import POINTS, Findings, Row
from benchmarks.evidence.analysis.settings import FASTEST
from benchmarks.evidence.analysis.statistics import Interval
from ompl_risk._arrays import FloatArray
from ompl_risk.report.style import FAINT, INK, SIZES, new_figure

CEILING = "#CFE8DC"


def distinct(findings: Findings) -> list[int]:
    """Rows by setting, each setting once, in their order."""
    seen = {row.setting: k for k, row in reversed(list(enumerate(findings.rows)))}
    return sorted(seen.values())


def standing(findings: Findings) -> Figure:
    """Share of sets in which each setting finds the safest flight, and its tau."""
    chosen = distinct(findings)
    rows = [findings.rows[k] for k in chosen]
    figure = new_figure(11.0, 1.75 + 0.3 * len(rows))
    left, right = figure.subplots(1, 2, sharey=True)
    sets = int(findings.masks["pooled"].sum())
    for axes, metric, factor in ((left, "safest", 100.0), (right, "tau", 1.0)):
        intervals = [findings.intervals(metric)[k] for k in chosen]
        _ceiling(axes, findings, metric, factor)
        _marks(axes, rows, intervals, factor)
    left.set_yticks(range(len(rows)), [name(row) for row in rows])
    left.set_ylim(len(rows) - 0.4, -0.6)
    left.axvline(100.0 * findings.chance, color=FAINT, linestyle=":", linewidth=1.2)
    left.set_xlabel("sets in which the safest of five is found [%]", fontsize=SIZES["small"])
    right.set_xlabel("mean Kendall's tau with the probability", fontsize=SIZES["small"])
    heading(
        figure,
        "Which setting predicts collisions",
        f"{sets} decided test sets, levels pooled; 95 % bootstrap intervals by unit; "
        "dotted: chance; green: the judge by itself (see the page)",
    )
    _fit(figure)
    return figure


def differences(findings: Findings) -> Figure:
    """The recommended setting less each other, on the same sets."""
    chosen = [k for k in distinct(findings) if k > 0 and findings.rows[k].setting != FASTEST]
    rows = [findings.rows[k] for k in chosen]
    figure = new_figure(11.0, 1.75 + 0.3 * len(rows))
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, metric, factor in ((left, "safest", 100.0), (right, "tau", 1.0)):
        scores: FloatArray = getattr(findings.by_judge, metric)
        gains = findings.draws.intervals(scores[0] - scores[chosen], findings.masks["pooled"])
        axes.axvline(0.0, color=INK, linewidth=1.0)
        _marks(axes, rows, gains, factor)
    left.axvline(100.0 * POINTS, color=FAINT, linestyle="--", linewidth=1.2)
    left.set_yticks(range(len(rows)), [f"over {name(row)}" for row in rows])
    left.set_ylim(len(rows) - 0.4, -0.6)
    left.set_xlabel("safest found more often by [percentage points]", fontsize=SIZES["small"])
    right.set_xlabel("greater Kendall's tau by", fontsize=SIZES["small"])
    heading(
        figure,
        f"Gain of {findings.rows[0].setting.label}",
        "paired differences on the decided test sets, 95 % bootstrap intervals by unit; "
        "dashed: the target over the best of the paper's four",
    )
    _fit(figure)
    return figure


def _marks(axes: Axes, rows: Sequence[Row], intervals: Sequence[Interval], factor: float) -> None:
    for k, (row, interval) in enumerate(zip(rows, intervals, strict=True)):
        mean, low, high = (factor * x for x in interval)
        axes.plot([low, high], [k, k], color=colour(row), linewidth=2.2, solid_capstyle="butt")
        axes.plot(mean, k, "o", color=colour(row), markersize=6.5, markeredgecolor="white")
    tidy(axes)


def _ceiling(axes: Axes, findings: Findings, metric: str, factor: float) -> None:
    """From one half of the rollouts by the other to all of them drawn again."""
    ends = [
        factor
        * findings.draws.intervals(getattr(s, metric)[None], findings.masks["pooled"])[0].mean
        for s in findings.ceiling
    ]
    axes.axvspan(*sorted(ends), color=CEILING, zorder=0)


def _fit(figure: Figure) -> None:
    height = figure.get_figheight()
    figure.subplots_adjust(left=0.34, right=0.985, wspace=0.06, top=1 - 0.85 / height,
                           bottom=0.6 / height)  # fmt: skip
