"""Whether anything became worse than the baseline allows."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from rich import box
from rich.table import Table
from rich.text import Text

from benchmarks.readings import Reading, Readings
from benchmarks.report import number

Verdict = Literal["kept", "better", "worse", "gone", "new", "changed"]

CLOSING: frozenset[Verdict] = frozenset({"worse", "gone", "changed"})
"""What closes the gate; a new figure has no baseline yet, and is only reported."""

STYLES: dict[Verdict, str] = {
    "kept": "green", "better": "cyan", "worse": "bold red", "gone": "bold red", "new": "yellow",
    "changed": "bold red",
}  # fmt: skip


@dataclass(frozen=True)
class Change:
    """A figure beside its baseline.

    Attributes:
        name: "benchmark: figure".
        before: in the baseline, None for a new figure.
        now: in this run, None for one that is gone.
    """

    name: str
    before: Reading | None
    now: Reading | None

    @property
    def verdict(self) -> Verdict:
        """What became of it; "changed" is another unit or direction under the old name."""
        if self.before is None:
            return "new"
        if self.now is None:
            return "gone"
        if (self.before.unit, self.before.better) != (self.now.unit, self.now.better):
            return "changed"
        if is_worse(self.before, self.now.value):
            return "worse"
        return "better" if is_better(self.before, self.now.value) else "kept"

    @property
    def closes(self) -> bool:
        """Whether it closes the gate."""
        return self.verdict in CLOSING

    @property
    def factor(self) -> float:
        """How many times worse, 1 for the same; below 1 if better; NaN if there is no telling."""
        if self.before is None or self.now is None:
            return math.nan
        before, now = self.before.value, self.now.value
        if before == now:
            return 1.0
        worse, base = (now, before) if self.before.better == "lower" else (before, now)
        if math.isnan(worse) or math.isnan(base) or (math.isinf(worse) and math.isinf(base)):
            return math.nan
        return math.inf if base == 0.0 else worse / base


def allowed(before: Reading) -> float:
    """The worst value that the gate lets pass.

    ::

        lower is better:    value + max(relative value, absolute)
        higher is better:   value - max(value relative / (1 + relative), absolute)

    so that with a relative tolerance of 1 a time may double and a rate may halve.
    """
    value, relative, absolute = before.value, before.tolerance.relative, before.tolerance.absolute
    worst = math.inf if before.better == "lower" else -math.inf
    if math.isinf(relative) or math.isinf(absolute):
        return worst
    if math.isinf(value):
        return value
    if before.better == "lower":
        return value + max(relative * abs(value), absolute)
    return value - max(abs(value) * relative / (1.0 + relative), absolute)


def is_worse(before: Reading, now: float) -> bool:
    """Whether a value is worse than the baseline allows; not-a-number always is."""
    limit = allowed(before)
    return not (now <= limit if before.better == "lower" else now >= limit)


def is_better(before: Reading, now: float) -> bool:
    """Whether a value is so much better that, had it been the baseline, the old one would fail."""
    if math.isinf(before.tolerance.relative) or math.isnan(now):
        return False
    turned = Reading(now, before.unit, before.better, before.tolerance)
    return is_worse(turned, before.value)


def compared(
    before: Readings, now: Readings, benchmarks: Collection[str] | None = None
) -> list[Change]:
    """Every figure beside its baseline.

    Args:
        before: the baseline.
        now: of this run.
        benchmarks: those that were run; the rest of the baseline is left out. None for all.
    """

    def was_run(name: str) -> bool:
        return benchmarks is None or name.split(": ", 1)[0] in benchmarks

    names = dict.fromkeys([*(name for name in before if was_run(name)), *now])
    return [Change(name, before.get(name), now.get(name)) for name in names]


def table(changes: Sequence[Change]) -> Table:
    """All that is not as it was, the worst first."""
    result = Table(
        title="against the baseline", title_justify="left", title_style="bold", box=box.SIMPLE_HEAD
    )
    result.add_column("figure", overflow="fold")
    for heading in ("baseline", "now", "worse by", "allowed", "verdict"):
        result.add_column(heading, justify="right")
    for change in sorted(changes, key=_rank):
        if change.verdict == "kept":
            continue
        before, now = change.before, change.now
        result.add_row(
            change.name,
            "" if before is None else _with_unit(before),
            "" if now is None else _with_unit(now),
            "" if before is None or now is None else _times(change.factor),
            "" if before is None else _limit(before),
            Text(change.verdict, style=STYLES[change.verdict]),
        )
    return result


def summary(changes: Sequence[Change]) -> str:
    """One line: how many figures are as they were, and how many are not."""
    verdicts = [change.verdict for change in changes]
    kinds: tuple[Verdict, ...] = ("kept", "worse", "gone", "changed", "better", "new")
    counts = (f"{verdicts.count(kind)} {kind}" for kind in kinds if kind in verdicts)
    return f"{len(changes)} figures: {', '.join(counts)}"


def _rank(change: Change) -> tuple[bool, float]:
    factor = change.factor
    return not change.closes, -math.inf if math.isnan(factor) else -factor


def _with_unit(reading: Reading) -> str:
    return f"{number(reading.value)} {reading.unit}".rstrip()


def _times(factor: float) -> str:
    return "?" if math.isnan(factor) else f"{number(factor)} times"


def _limit(before: Reading) -> str:
    return f"{'<=' if before.better == 'lower' else '>='} {number(allowed(before))}"
