"""Fig. 2 and Table I of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ompl_risk.report.norm_tables import NormTable, draw_norm_table
from ompl_risk.report.style import FAINT, INK, SIZES, colour, new_figure, save
from ompl_risk.table1 import CURVES, NORMS, Table1, curve, table1

SHOWN = 6.0
"""The curves are drawn on [-6, 6] s; beyond they are below 1e-3."""


def table1_figure(table: Table1 | None = None, path: str | Path | None = None) -> Figure:
    """Draw the four curves of Fig. 2 beside Table I as printed and as computed.

    Args:
        table: from `table1.table1`, which is computed if left out.
        path: where to write the figure, if given.

    Returns:
        The figure, 1600 pixels wide.

    Raises:
        FileError: the file cannot be written.

    Reference: Nair and Kobilarov, Fig. 2 and Table I.
    """
    table = table1() if table is None else table
    figure = new_figure(16.0, 6.0)
    axes = figure.add_axes((0.045, 0.13, 0.5, 0.75))
    t = np.linspace(-SHOWN, SHOWN, 1201)
    for i, name in enumerate(CURVES):
        axes.plot(t, curve(name, t), color=colour(i), linewidth=2.2, label=name)
    axes.set_title("Avoidance functions of Fig. 2", fontsize=SIZES["title"], loc="left", color=INK)
    axes.set_xlabel("$t$ [s]", fontsize=SIZES["text"])
    axes.set_ylabel("$f(t)$", fontsize=SIZES["text"])
    axes.set_xlim(-SHOWN, SHOWN)
    axes.set_ylim(0.0, 0.85)
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=SIZES["small"])
    axes.legend(fontsize=SIZES["text"], frameon=False)
    for y, kind, form, title in (
        (0.5, "ours", ".3f", "Our norms"),
        (0.06, "printed", ".1f", "Table I as printed (L¹: 10 x norm, H¹: 10 x norm²)"),
    ):
        columns = {
            norm.label: [getattr(table.row(name, norm.label), kind) for name in CURVES]
            for norm in NORMS
        }
        units = dict.fromkeys(columns, "")
        draw_norm_table(
            figure.add_axes((0.6, y, 0.375, 0.42)), NormTable(title, CURVES, columns, units, form)
        )
    if path is not None:
        save(figure, path)
    return figure
