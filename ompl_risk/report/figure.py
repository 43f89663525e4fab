"""The figure of a ranking: the paper's Fig. 5."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from ompl_risk.ranking.export import norm_unit
from ompl_risk.report.norm_tables import NormTable, draw_norm_table
from ompl_risk.report.plan_view import draw_plan_view
from ompl_risk.report.style import FAINT, INK, SIZES, new_figure, save, short
from ompl_risk.report.time_plots import draw_avoidance, draw_distance, draw_probability

if TYPE_CHECKING:
    from ompl_risk.probability import CollisionProfile
    from ompl_risk.ranking import Ranking
    from ompl_risk.terrains import Terrain

WIDTH = 16.0


def ranking_figure(
    ranking: Ranking,
    profiles: Mapping[str, CollisionProfile],
    terrain: Terrain,
    *,
    ceiling: float | None = None,
    title: str = "",
    path: str | Path | None = None,
) -> Figure:
    """Draw the paths over the terrain, d(t), f(t), P_c(t) and both tables of norms.

    Args:
        ranking: made with these profiles; its order of trajectories is that of the colours.
        profiles: probability of collision by name of the trajectory.
        terrain: the ground.
        ceiling: altitude [m] that paths had to stay below, if there was one.
        title: what stands above the map.
        path: where to write the figure, if given.

    Returns:
        The figure, 1600 pixels wide.

    Raises:
        FileError: the file cannot be written.

    Reference: Nair and Kobilarov, Fig. 5.
    """
    labels = short([a.name for a in ranking.assessments])
    extra = 0.31 * max(0, len(labels) - 5)  # inches: tables grow by a line for each trajectory
    height = 10.4 + 2 * extra
    figure = new_figure(WIDTH, height)
    bottom, gap = 3.05 / height, 0.62 / height
    middle = bottom + 0.5 / height + gap
    top = 1 - 0.62 / height
    plan = figure.add_axes((0.045, middle, 0.565, top - middle))
    draw_plan_view(
        plan, terrain, [a.trajectory for a in ranking.assessments], labels, ceiling=ceiling
    )
    _heading(figure, title or f"Paths over {terrain.name}", height)
    half = (top - middle - 0.2 / height) / 2
    tables = _tables(ranking, labels)
    for k, table in enumerate(tables):
        y = top - half - k * (half + 0.2 / height)
        draw_norm_table(figure.add_axes((0.635, y, 0.35, half)), table)
    low, tall = 0.6 / height, bottom - 0.6 / height
    plots = [figure.add_axes((0.045 + k * 0.328, low, 0.284, tall)) for k in range(3)]
    draw_distance(plots[0], ranking.assessments, ranking.avoidance.d0)
    draw_avoidance(plots[1], ranking.assessments, ranking.avoidance)
    draw_probability(plots[2], ranking.assessments, profiles)
    if path is not None:
        save(figure, path)
    return figure


def _heading(figure: Figure, title: str, height: float) -> None:
    y = 1 - 0.36 / height
    figure.text(0.045, y, title, fontsize=SIZES["title"], fontweight="bold", color=INK, va="center")
    note = "in order of the L² norm of $P_c$; least of a column blue, greatest orange"
    figure.text(0.985, y, note, fontsize=SIZES["small"], color=FAINT, ha="right", va="center")


def _tables(ranking: Ranking, labels: list[str]) -> list[NormTable]:
    kinds = (
        ("Probability of collision (PC): norms of $P_c(t)$", "1", "pc_norms"),
        ("Collision avoidance (CA): norms of $f(t)$", ranking.avoidance.unit, "norms"),
    )
    return [
        NormTable(
            title,
            labels,
            {k: [getattr(a, field)[k] for a in ranking.assessments] for k in ranking.labels},
            {norm.label: _unit(norm_unit(norm, of=of)) for norm in ranking.norms},
            durations=[a.duration for a in ranking.assessments],
        )
        for title, of, field in kinds
    ]


def _unit(unit: str) -> str:
    """A unit with its roots written out: "s^(1/2)/m" becomes "√s/m"; none for a bare number."""
    return "" if unit == "1" else unit.replace("s^(1/2)", "√s")
