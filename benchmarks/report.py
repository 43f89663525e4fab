"""Figures as a table for a terminal and as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from benchmarks.metric import Metric, Spread

FORMAT = 1
"""Version of the JSON's layout."""


def table(name: str, metrics: Sequence[Metric]) -> Table:
    """Figures of one benchmark: medians, and the advantage with its quartiles."""
    result = Table(title=name, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD)
    result.add_column("figure", overflow="fold")
    for heading in ("ours", "peer", "times better", "target", "met"):
        result.add_column(heading, justify="left" if heading == "peer" else "right")
    for metric in metrics:
        peer, advantage = metric.peer, metric.advantage
        result.add_row(
            metric.name,
            f"{number(metric.value.median)} {metric.unit}".rstrip(),
            f"{number(peer.value.median)} {peer.name}" if peer else "",
            times(advantage) if advantage else "",
            target(metric),
            verdict(metric),
        )
    return result


def notes(metrics: Sequence[Metric]) -> list[str]:
    """The notes, each with the first figure that it belongs to."""
    first: dict[str, str] = {}
    for metric in metrics:
        if metric.note:
            first.setdefault(metric.note, metric.name)
    return [f"{name}: {note}" for note, name in first.items()]


def number(value: float) -> str:
    """Three significant digits; whole numbers in full."""
    return f"{value:,.0f}" if 1000.0 <= abs(value) < 1e9 else f"{value:.3g}"


def times(advantage: Spread) -> str:
    """Median and quartiles of how many times better ours is."""
    low, high = number(advantage.low), number(advantage.high)
    return number(advantage.median) + (f" ({low} to {high})" if low != high else "")


def target(metric: Metric) -> str:
    """The limit, as a reader would write it."""
    if metric.target is None:
        return ""
    if metric.target.of == "advantage":
        return f">= {number(metric.target.limit)} times"
    return f"{'<=' if metric.better == 'lower' else '>='} {number(metric.target.limit)}"


def verdict(metric: Metric) -> Text:
    """Whether the target is met; a missed figure of correctness stands out."""
    if metric.met is None:
        return Text("")
    if metric.failed:
        return Text("WRONG", style="bold red")
    return Text("yes", style="green") if metric.met else Text("NO", style="bold yellow")


def document(results: Mapping[str, Sequence[Metric]], **facts: Any) -> str:
    """Everything as JSON; numbers that JSON does not have become the strings nan, inf, -inf."""
    metrics = [
        {"benchmark": name, **asdict(metric), "met": metric.met}
        for name, each in results.items()
        for metric in each
    ]
    whole = {"format": FORMAT, **facts, "metrics": metrics}
    return json.dumps(_portable(whole), indent=2, allow_nan=False) + "\n"


def _portable(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _portable(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_portable(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value
