"""How settings are called and coloured in figures."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.evidence.analysis.findings import PREFERRED, Row
from ompl_risk.report.style import COLOURS, FAINT, INK, SIZES

RECOMMENDED = COLOURS[3]
PAPER = {"L1": "#56B4E9", "L2": "#0072B2", "L∞": "#003E66", "H1": "#E69F00"}
"""L^p in blues, H1 in orange, whatever the figure."""
TUNED, REFERENCE = COLOURS[1], FAINT


def colour(row: Row) -> str:
    """Of a setting, by its role."""
    if row.role == "recommended":
        return RECOMMENDED
    if row.role == "paper":
        return PAPER.get(row.setting.label.split(" ")[0], FAINT)
    return REFERENCE if row.setting.label == "duration" else TUNED


def name(row: Row) -> str:
    """A setting as axes show it."""
    mark = {"recommended": "recommended: ", "paper": "paper: "}.get(row.role, "")
    if row.role == PREFERRED:
        return "what training prefers"  # the label of a product is too long
    text = "fastest flight" if row.setting.label == "duration" else row.setting.label
    return mark + text


def heading(figure: Figure, title: str, note: str) -> None:
    """Title and, below it, what the figure shows; both above its axes."""
    height = figure.get_figheight()
    for text, inches, size, colour_ in (
        (title, 0.28, SIZES["title"], INK), (note, 0.56, SIZES["small"], FAINT)
    ):  # fmt: skip
        weight = "bold" if size == SIZES["title"] else "normal"
        figure.text(0.012, 1.0 - inches / height, text, fontsize=size, fontweight=weight,
                    color=colour_, va="center")  # fmt: skip


def tidy(axes: Axes) -> None:
    """Small ticks, a faint grid, no box."""
    axes.tick_params(labelsize=SIZES["small"] - 0.5, which="both")
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_axisbelow(True)
