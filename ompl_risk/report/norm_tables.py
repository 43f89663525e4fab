"""The tables of norms, PC and CA, as parts of a figure."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from ompl_risk.report.style import FAINT, INK, RISKIEST, SAFEST, SIZES, colour, dashes

MOST_NAMES = 7
"""An order of more names than this does not fit below its column."""


@dataclass(frozen=True)
class NormTable:
    """Norms of several trajectories.

    Args:
        title: what stands above.
        labels: short labels of the trajectories, a row each.
        columns: values by the norm's label, one for each trajectory.
        units: unit of each column, by the norm's label.
        form: how numbers are written.
    """

    title: str
    labels: Sequence[str]
    columns: Mapping[str, Sequence[float]]
    units: Mapping[str, str]
    form: str = "#.3g"

    def text(self, value: float) -> str:
        """A number as it is shown; infinity is a collision."""
        return "collides" if math.isinf(value) else format(value, self.form)

    def order(self, column: str) -> list[int]:
        """Rows from the least value to the greatest."""
        values = self.columns[column]
        return sorted(range(len(values)), key=lambda i: (values[i], i))


def draw_norm_table(axes: Axes, table: NormTable) -> None:
    """Draw a table; the least number of a column is marked as safest, the greatest as riskiest."""
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    rows = len(table.labels)
    axes.set_ylim(rows + 3.2, 0.0)  # in lines of text, downwards
    axes.text(0.0, 0.45, table.title, fontsize=SIZES["text"] + 1, color=INK, va="center")
    first = 0.16 if max(map(len, table.labels)) <= 4 else 0.3
    width = (1.0 - first) / len(table.columns)
    for i, label in enumerate(table.labels):
        style: Any = dashes(i)
        axes.plot([0.01, 0.05], [i + 2.5] * 2, color=colour(i), linestyle=style, linewidth=4)
        _cell(axes, 0.07, i + 2.5, label, weight="bold", align="left")
    for k, column in enumerate(table.columns):
        _draw_column(axes, table, column, first + k * width, width)
    _rule(axes, 1.95, 1.2)
    _rule(axes, rows + 2.05, 0.8)
    _cell(axes, 0.012, rows + 2.6, "order", align="left", faint=True)


def _draw_column(axes: Axes, table: NormTable, column: str, left: float, width: float) -> None:
    centre, rows, order = left + width / 2, len(table.labels), table.order(column)
    _cell(axes, centre, 1.2, mathematical(column), weight="bold")
    _cell(axes, centre, 1.68, table.units[column], faint=True, small=True)
    texts = [table.text(value) for value in table.columns[column]]
    for i, text in enumerate(texts):
        background = _background(text, least=texts[order[0]], greatest=texts[order[-1]])
        if background:
            box = Rectangle((left + 0.06 * width, i + 2.05), 0.88 * width, 0.9, color=background)
            axes.add_patch(box)
        _cell(axes, centre, i + 2.5, text, weight="bold" if background else "normal")
    if rows <= MOST_NAMES and all(len(label) <= 2 for label in table.labels):
        _cell(axes, centre, rows + 2.6, " ".join(table.labels[i] for i in order), small=True)
    else:
        _cell(axes, centre, rows + 2.6, f"safest: {table.labels[order[0]]}", small=True)


def _background(text: str, *, least: str, greatest: str) -> str | None:
    """Numbers that look the same are marked the same."""
    if least == greatest:
        return None
    return {least: SAFEST, greatest: RISKIEST}.get(text)


def _cell(
    axes: Axes,
    x: float,
    y: float,
    text: str,
    *,
    weight: str = "normal",
    align: str = "center",
    faint: bool = False,
    small: bool = False,
) -> None:
    axes.text(
        x, y, text, ha=align, va="center", fontweight=weight, color=FAINT if faint else INK,
        fontsize=SIZES["small" if small else "text"],
    )  # fmt: skip


def _rule(axes: Axes, y: float, width: float) -> None:
    axes.plot([0.0, 1.0], [y, y], color=INK, linewidth=width, clip_on=False)


def mathematical(label: str) -> str:
    """A norm's label with its exponent raised: "L2" as in the paper."""
    head, bracket, rest = label.partition("(")
    if len(head) > 1 and head[0] in "LH":
        exponent = head[1:].replace("∞", r"\infty")
        return f"$\\mathbf{{{head[0]}}}^{{\\mathbf{{{exponent}}}}}$" + bracket + rest
    return label
