"""Distance, avoidance function and probability of collision over time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes

from ompl_risk._arrays import FloatArray
from ompl_risk.avoidance import Avoidance
from ompl_risk.report.style import FAINT, INK, SIZES, colour, dashes

if TYPE_CHECKING:
    from ompl_risk.probability import CollisionProfile
    from ompl_risk.ranking import Assessment

BEYOND = 2.5
"""The distance axis ends at this many d0: what lies beyond poses no danger."""
LARGEST_F = 20.0
"""The axis of f ends at f(d0 / 20) at most: nearer to a collision it would hide all else."""


def draw_distance(axes: Axes, assessments: Sequence[Assessment], d0: float) -> None:
    """Draw d(t) with a line at d0; collisions are marked."""
    top = min(BEYOND * d0, 1.05 * max(float(a.d[np.isfinite(a.d)].max()) for a in assessments))
    top = max(top, 1.5 * min(float(a.d.min()) for a in assessments))  # that some is in sight
    low = min(0.0, *(float(np.maximum(a.d, -0.2 * d0).min()) for a in assessments))
    for i, a in _safest_last(assessments):
        d = np.clip(a.d, low - d0, top + d0)
        _line(axes, i, a.trajectory.t, d)
        if a.collision_time is not None:
            axes.plot(a.collision_time, 0.0, "X", color=colour(i), markersize=9, zorder=5)
    axes.axhline(d0, color=INK, linewidth=1.2, linestyle=(0, (4, 2)))
    axes.annotate(
        f"$d_0$ = {d0:g} m",
        (0.99, d0),
        xycoords=axes.get_yaxis_transform(),
        xytext=(0, 3),
        textcoords="offset points",
        ha="right",
        va="bottom",
        fontsize=SIZES["small"],
        color=INK,
        zorder=6,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
    )
    axes.set_ylim(low, top)
    _finish(axes, "Distance to obstacles $d(t)$ [m]", assessments)


def draw_avoidance(axes: Axes, assessments: Sequence[Assessment], avoidance: Avoidance) -> None:
    """Draw f(t); the axis is cut where collisions or near ones would hide the rest."""
    cut = float(avoidance(avoidance.d0 / LARGEST_F))
    peak = max(float(np.minimum(a.f, cut).max()) for a in assessments)
    for i, a in _safest_last(assessments):
        _line(axes, i, a.trajectory.t, np.minimum(a.f, 2.0 * cut))
    axes.set_ylim(0.0, 1.05 * peak if peak > 0.0 else avoidance.typical)
    _finish(axes, f"Avoidance function $f(t)${in_unit(avoidance)}", assessments)


def in_unit(avoidance: Avoidance) -> str:
    """The unit of f behind a label: " [1/m]", nothing for a bare number."""
    return "" if avoidance.unit == "1" else f" [{avoidance.unit}]"


def draw_probability(
    axes: Axes, assessments: Sequence[Assessment], profiles: Mapping[str, CollisionProfile]
) -> None:
    """Draw P_c(t) with its bounds."""
    for i, a in _safest_last(assessments):
        profile = profiles[a.name]
        axes.fill_between(
            profile.t, profile.low, profile.high, color=colour(i), alpha=0.25, linewidth=0
        )
        _line(axes, i, profile.t, profile.p)
    radius = next(iter(profiles.values())).radius
    top = max(float(profile.high.max()) for profile in profiles.values())
    axes.set_ylim(0.0, 1.05 * top if top > 0.0 else 1.0)
    _finish(axes, f"Probability of collision $P_c(t)$, $r$ = {radius:g} m", assessments)


def _safest_last(assessments: Sequence[Assessment]) -> list[tuple[int, Assessment]]:
    """The first is drawn last, so on top."""
    return list(enumerate(assessments))[::-1]


def _line(axes: Axes, index: int, t: FloatArray, values: FloatArray) -> None:
    style: Any = dashes(index)
    axes.plot(t, values, color=colour(index), linestyle=style, linewidth=1.6)


def _finish(axes: Axes, title: str, assessments: Sequence[Assessment]) -> None:
    begin = min(float(a.trajectory.t[0]) for a in assessments)
    end = max(float(a.trajectory.t[-1]) for a in assessments)
    axes.set_xlim(begin, end if end > begin else math.nextafter(begin, math.inf))
    axes.set_title(title, fontsize=SIZES["text"] + 1, loc="left", color=INK)
    axes.set_xlabel("$t$ [s]", fontsize=SIZES["text"])
    axes.tick_params(labelsize=SIZES["small"])
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
