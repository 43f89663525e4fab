"""The tables of norms, PC and CA, as parts of a figure."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from ompl_risk.report.style import DPI, FAINT, INK, RISKIEST, SAFEST, SIZES, colour, dashes, short
from ompl_risk.report.text_size import text_width

NAMES, UNITS, RULE = 1.28, 1.86, 2.2
"""Where names of norms, their units and the rule below stand [lines of text]; then come rows."""
ORDER_LINES = 2
"""Of an order that takes more lines below its column only the first name is shown."""


@dataclass(frozen=True)
class NormTable:
    """Norms of several trajectories.

    Args:
        title: what stands above.
        labels: short labels of the trajectories, a row each.
        columns: values by the norm's label, one for each trajectory.
        units: unit of each column, by the norm's label.
        form: how numbers are written.
        durations: of the trajectories; of those with the same value the fastest comes first.
    """

    title: str
    labels: Sequence[str]
    columns: Mapping[str, Sequence[float]]
    units: Mapping[str, str]
    form: str = "#.3g"
    durations: Sequence[float] = ()

    def text(self, value: float) -> str:
        """A number as it is shown; infinity is a collision."""
        return "collides" if math.isinf(value) else format(value, self.form)

    def order(self, column: str) -> list[int]:
        """Rows from the least value to the greatest."""
        values = self.columns[column]
        ties = self.durations or [0.0] * len(values)
        return sorted(range(len(values)), key=lambda i: (values[i], ties[i], i))


def draw_norm_table(axes: Axes, table: NormTable) -> None:
    """Draw a table; the least number of a column is marked as safest, the greatest as riskiest.

    Args:
        axes: where to draw, of fixed size.
        table: what to draw.
    """
    rows = len(table.labels)
    first = 0.16 if max(map(len, table.labels)) <= 4 else 0.3
    width = (1.0 - first) / len(table.columns)
    inches = width * axes.get_window_extent().width / DPI
    in_line = _names_in_line(table.labels, inches)
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    lines = math.ceil(rows / in_line) if in_line else 1
    axes.set_ylim(RULE + rows + 1.25 + 0.7 * (lines - 1), 0.0)  # in lines of text, downwards
    axes.text(0.0, 0.45, table.title, fontsize=SIZES["text"] + 1, color=INK, va="center")
    for i, label in enumerate(table.labels):
        style: Any = dashes(i)
        axes.plot(
            [0.01, 0.05], [RULE + 0.55 + i] * 2, color=colour(i), linestyle=style, linewidth=4
        )
        _cell(axes, 0.07, RULE + 0.55 + i, label, weight="bold", align="left")
    for k, column in enumerate(table.columns):
        _draw_column(axes, table, column, first + k * width, width)
        centre = first + (k + 0.5) * width
        if in_line:
            _draw_order(axes, table, column, centre, in_line)
        else:
            _draw_safest(axes, table, column, centre, inches)
    _rule(axes, RULE, 1.2)
    _rule(axes, RULE + rows + 0.1, 0.8)
    _cell(
        axes, 0.012, RULE + rows + 0.65, "order" if in_line else "safest", align="left", faint=True
    )


def _names_in_line(labels: Sequence[str], width: float) -> int:
    """How many names of an order fit into a line [inch]; 0 if it takes too many lines."""
    if max(map(len, labels)) > 2:
        return 0
    size = SIZES["small"]
    wide = max(text_width(f"{label} M", size) - text_width("M", size) for label in labels)
    most = math.floor(0.95 * width / wide)
    if most == 0 or most * ORDER_LINES < len(labels):
        return 0
    return math.ceil(len(labels) / math.ceil(len(labels) / most))


def _draw_order(axes: Axes, table: NormTable, column: str, centre: float, in_line: int) -> None:
    names = [table.labels[i] for i in table.order(column)]
    below = RULE + len(names) + 0.65
    for k in range(0, len(names), in_line):
        line = " ".join(names[k : k + in_line])
        _cell(axes, centre, below + 0.7 * k / in_line, line, small=True)


def _draw_safest(axes: Axes, table: NormTable, column: str, centre: float, inches: float) -> None:
    """The first of an order that has no room, cut to the width of its column [inch]."""
    name = table.labels[table.order(column)[0]]
    letters = len(name)
    while letters > 3 and text_width(name, SIZES["small"]) > 0.95 * inches:
        letters -= 1
        (name,) = short([name], letters)
    _cell(axes, centre, RULE + len(table.labels) + 0.65, name, small=True)


def _draw_column(axes: Axes, table: NormTable, column: str, left: float, width: float) -> None:
    centre, order = left + width / 2, table.order(column)
    _cell(axes, centre, NAMES, mathematical(column), weight="bold")
    _cell(axes, centre, UNITS, table.units[column], faint=True, small=True)
    texts = [table.text(value) for value in table.columns[column]]
    for i, text in enumerate(texts):
        background = _background(text, least=texts[order[0]], greatest=texts[order[-1]])
        if background:
            corner = left + 0.06 * width, RULE + 0.1 + i
            axes.add_patch(Rectangle(corner, 0.88 * width, 0.9, color=background))
        _cell(axes, centre, RULE + 0.55 + i, text, weight="bold" if background else "normal")


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
