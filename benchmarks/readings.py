"""What of a figure is compared with the baseline, and how closely."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.metric import Better, Metric, Tolerance

TIMES = frozenset({"s", "ms", "us", "us/query", "1/s", "states/s"})
"""Units of figures that depend on the machine and on what else runs on it."""

LOOSE = 1.0
"""For time: twice as slow is a regression."""

TIGHT = 0.02
"""For counts, memory and errors, which the seed determines up to rounding."""

ROUNDING = 0.01
"""Errors may grow by this part of their limit: what is left of them is rounding."""


@dataclass(frozen=True)
class Reading:
    """A figure as the baseline keeps it.

    Attributes:
        value: median; times better than the peer, or multiples of the yardstick, by the tolerance.
        unit: of the value.
        better: whether lower or higher values are better.
        tolerance: how much worse it may become.
    """

    value: float
    unit: str
    better: Better
    tolerance: Tolerance


Readings = dict[str, Reading]
"""By "benchmark: figure"."""


def readings(metrics: Mapping[str, Sequence[Metric]], yardstick: float) -> Readings:
    """All figures as the baseline keeps them.

    Args:
        metrics: by benchmark.
        yardstick: seconds of the fixed computation in this run.
    """
    return {
        f"{name}: {metric.name}": reading(metric, yardstick)
        for name, each in metrics.items()
        for metric in each
    }


def reading(metric: Metric, yardstick: float) -> Reading:
    """A figure as the baseline keeps it."""
    tolerance = metric.tolerance or usual_tolerance(metric)
    value, unit, better = metric.value.median, metric.unit, metric.better
    if tolerance.of == "advantage" and metric.advantage is not None:
        peer = "" if metric.peer is None else f" {metric.peer.name}"
        value, unit, better = metric.advantage.median, f"times{peer}", "higher"
    elif tolerance.of == "yardstick":
        rate = unit.endswith("/s")
        value, unit = (value * yardstick if rate else value / yardstick), f"{unit}, by yardstick"
    return Reading(value, unit, better, tolerance)


def usual_tolerance(metric: Metric) -> Tolerance:
    """Tight for correctness, counts and memory; loose for time, and beside the peer if it has one.

    A share of the peer's time hardly depends on the machine, so it says more than the time itself.
    """
    if metric.target is not None and metric.target.correctness:
        limit = metric.target.limit
        return Tolerance(TIGHT, absolute=ROUNDING * abs(limit) if math.isfinite(limit) else 0.0)
    if metric.unit not in TIMES:
        return Tolerance(TIGHT)
    return Tolerance(LOOSE, of="yardstick" if metric.advantage is None else "advantage")
