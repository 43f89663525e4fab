"""The findings as tables, for a terminal and as Markdown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from rich.markup import escape
from rich.table import Table as RichTable

from benchmarks.evidence.analysis.findings import Findings, compare, gain_on_paper
from benchmarks.evidence.analysis.knowing import ByLevel, Knowing, Predicted
from benchmarks.evidence.analysis.statistics import Interval
from benchmarks.evidence.analysis.strata import strata
from benchmarks.evidence.analysis.table import SPLITS, STATUSES
from ompl_risk._arrays import FloatArray


class Sheet(NamedTuple):
    """A table: its title, the names of its columns, its lines."""

    title: str
    header: tuple[str, ...]
    lines: list[list[str]]


METRICS = {
    "safest": "finds the safest",
    "riskiest": "finds the riskiest",
    "tau": "Kendall's tau",
    "regret": "regret",
}
"""Scores as columns are called."""
MASKS = {
    "pooled": "decided sets of all levels",
    "certain": "sets in which the safest flight is certain",
    "all sets": "all sets, undecided ones too",
}
"""Sets as titles call them."""
ORDERING = ("safest", "tau")
"""Those that the target is about."""


def sheets(findings: Findings) -> Iterator[Sheet]:
    """All tables, in the order of the page."""
    yield counts(findings)
    yield fitted(findings)
    yield standing(findings, "pooled")
    yield comparisons(findings)
    yield by_size(findings)
    yield predicted(findings)
    yield by_level(findings, "safest")
    yield by_level(findings, "tau")
    yield ceiling(findings)
    if findings.masks["certain"].any():
        yield standing(findings, "certain")
    if findings.calibration:
        yield calibrated(findings)
    yield by_pc(findings)
    yield from by_stratum(findings)
    yield standing(findings, "all sets")


def counts(findings: Findings) -> Sheet:
    """What became of the units, and how many sets are decided."""
    whole, test = findings.whole, findings.judge.decided
    train = findings.fit.sets
    decided = {"train": f"{train[0]} of {train[1]}", "test": f"{test.sum()} of {test.size}"}
    lines = [
        [split, *(str(whole.outcomes.get((split, status), 0)) for status in STATUSES),
         decided[split]]
        for split in SPLITS
    ]  # fmt: skip
    header = ("split", "complete", "fewer than five flights", "failed", "decided sets")
    return Sheet("Units and sets", header, lines)


def fitted(findings: Findings) -> Sheet:
    """Each family's choice and how it did on training."""
    found = findings.fit
    lines = [
        [family.name, setting.label, f"{grid.max():.3f}", number(interval, 3)]
        for family, setting, grid, interval in zip(
            found.families, found.choices, found.objectives, found.held_out, strict=True
        )
    ]
    header = ("family", "chosen", "objective", "objective on terrains held out")
    return Sheet("Fitted on training", header, lines)


def standing(findings: Findings, mask: str) -> Sheet:
    """All settings by all scores, levels pooled."""
    what = MASKS[mask]
    columns = [
        [written(metric, each) for each in findings.intervals(metric, mask)] for metric in METRICS
    ]
    lines = [
        [row.role, row.setting.label, *cells]
        for row, *cells in zip(findings.rows, *columns, strict=True)
    ]
    total = int(findings.masks[mask].sum())
    header = ("", "setting", *METRICS.values())
    return Sheet(f"Test: {total} {what}, by closed-loop probability", header, lines)


def comparisons(findings: Findings) -> Sheet:
    """The recommended setting less the best of the paper's four."""
    lines = []
    for metric, name in METRICS.items():
        if metric == "regret":
            continue  # whose best is the least
        found = compare(findings, metric)
        cells = (difference(metric, i) for i in (found.by_unit, found.by_terrain, found.anew))
        lines.append([name, found.best.label, *cells])
    header = (
        "score", "best of the paper's four on test", "difference, units drawn",
        "terrains drawn", "best of the four chosen anew in each draw",
    )  # fmt: skip
    return Sheet("Recommended setting less the best of the paper's four", header, lines)


def by_size(findings: Findings) -> Sheet:
    """What those that know the level gain on the best of the paper's four."""
    lines = []
    for k, row in enumerate(findings.rows):
        if not isinstance(row.setting, Knowing):
            continue
        parts = row.setting.settings if isinstance(row.setting, ByLevel) else ()
        gains = (difference(metric, gain_on_paper(findings, k, metric)) for metric in ORDERING)
        lines.append([row.setting.label, *gains, "; ".join(part.label for part in parts)])
    header = (
        "setting", *(f"{METRICS[metric]}: gain on the best of the paper's four" for metric in
                     ORDERING), "at each level",
    )  # fmt: skip
    return Sheet("Knowing how large the errors are", header, lines)


def predicted(findings: Findings) -> Sheet:
    """The probability predicted from the sizes of the errors, against that counted."""
    k = next(k for k, row in enumerate(findings.rows) if isinstance(row.setting, Predicted))
    lines = []
    for level, name in enumerate(findings.judge.names):
        said, counted = findings.values[k, level].ravel(), findings.judge.values[level].ravel()
        numbers = (
            said.mean(), counted.mean(), float(np.sqrt(np.mean((said - counted) ** 2))),
            float(np.abs(said - counted).max()), _correlation(said, counted),
        )  # fmt: skip
        lines.append([name, *(f"{x:.4f}" for x in numbers)])
    header = (
        "level", "mean predicted", "mean counted", "rms difference", "greatest difference",
        "correlation",
    )  # fmt: skip
    return Sheet("Probability of collision predicted without rollouts: test flights", header, lines)


def _correlation(a: FloatArray, b: FloatArray) -> float:
    """Pearson's; NaN where one of them is the same everywhere."""
    if a.std() == 0.0 or b.std() == 0.0:
        return float("nan")
    return float(np.corrcoef(a, b)[0, 1])


def by_level(findings: Findings, metric: str) -> Sheet:
    """A score of all settings by level of disturbance."""
    names = findings.judge.names
    columns = [[written(metric, i) for i in findings.intervals(metric, name)] for name in names]
    lines = [
        [row.setting.label, *cells] for row, *cells in zip(findings.rows, *columns, strict=True)
    ]
    header = ("setting", *(f"{n} ({int(findings.masks[n].sum())} sets)" for n in names))
    return Sheet(f"Test by level: {METRICS[metric]}", header, lines)


def ceiling(findings: Findings) -> Sheet:
    """How well the judge predicts itself."""
    lines = []
    names = ("one half of the rollouts by the other", "rollouts drawn again by those counted")
    for name, found in zip(names, findings.ceiling, strict=True):
        cells = []
        for metric in METRICS:
            interval = findings.draws.intervals(
                getattr(found, metric)[None], findings.masks["pooled"]
            )[0]
            cells.append(written(metric, interval))
        lines.append([name, *cells])
    return Sheet("Ceiling: how well the judge predicts itself", ("", *METRICS.values()), lines)


def calibrated(findings: Findings) -> Sheet:
    """Predicted probabilities against what happened, by level."""
    lines = [
        [
            each.level, each.setting.label, f"{each.predicted.mean():.4f}",
            f"{each.observed.mean():.4f}", f"{100.0 * each.exceeding:.0f} %",
        ]
        for each in findings.calibration
    ]  # fmt: skip
    header = ("level", "rate fitted on training", "mean predicted on test", "mean observed",
              "flights certainly above the expected number")  # fmt: skip
    return Sheet("Calibration: expected collisions against probability", header, lines)


def by_pc(findings: Findings) -> Sheet:
    """All settings by the paper's own judges."""
    names = findings.pc.names
    columns = [[share(i) for i in findings.pc_intervals("safest", k)] for k in range(len(names))]
    second = names.index("L2 of P_c")
    columns += [
        [written(metric, i) for i in findings.pc_intervals(metric, second)]
        for metric in ("riskiest", "tau")
    ]
    columns.append([f"{i.mean:.3g}" for i in findings.pc_intervals("regret", second)])
    lines = [
        [row.setting.label, *cells] for row, *cells in zip(findings.rows, *columns, strict=True)
    ]
    header = (
        "setting", *(f"safest by {name}" for name in names), "riskiest by L2 of P_c",
        "tau with L2 of P_c", "regret in L2 of P_c [s^(1/2)]",
    )  # fmt: skip
    return Sheet("Test: by the paper's own judges", header, lines)


def by_stratum(findings: Findings) -> Iterator[Sheet]:
    """The recommended and the paper's settings by kind of set."""
    rows = findings.rows[: findings.paper.stop]
    for metric in ("safest", "tau"):
        lines = []
        for stratum in strata(findings):
            cells = stratum.scores[metric][: len(rows)]
            lines.append(
                [stratum.group, stratum.name, str(int(stratum.counted.sum())),
                 *(written(metric, each) for each in cells)]
            )  # fmt: skip
        header = ("by", "", "sets", *(row.setting.label for row in rows))
        yield Sheet(f"Where settings win and lose: {METRICS[metric]}", header, lines)


def written(metric: str, interval: Interval) -> str:
    """A score with its interval."""
    if metric in ("safest", "riskiest"):
        return share(interval)
    return probability(interval) if metric == "regret" else number(interval)


def difference(metric: str, interval: Interval) -> str:
    """A difference with its sign."""
    if np.isnan(interval.mean):
        return "none"
    if metric in ("safest", "riskiest"):
        middle, low, high = (100.0 * x for x in interval)
        return f"{middle:+.1f} points [{low:+.1f}, {high:+.1f}]"
    return f"{interval.mean:+.3f} [{interval.low:+.3f}, {interval.high:+.3f}]"


def share(interval: Interval) -> str:
    """Such as "71 % [66, 76]"."""
    if np.isnan(interval.mean):
        return "none"
    middle, low, high = (100.0 * x for x in interval)
    return f"{middle:.0f} % [{low:.0f}, {high:.0f}]"


def number(interval: Interval, digits: int = 2) -> str:
    """Such as "0.71 [0.66, 0.76]"."""
    if np.isnan(interval.mean):
        return "none"
    middle, low, high = (f"{x:.{digits}f}" for x in interval)
    return f"{middle} [{low}, {high}]"


def probability(interval: Interval) -> str:
    """Such as "0.0071 [0.0066, 0.0076]"."""
    return number(interval, 4)


def markdown(sheet: Sheet) -> list[str]:
    """The lines of a sheet as a Markdown table, without its title."""
    rows: Sequence[Sequence[str]] = [sheet.header, ["---"] * len(sheet.header), *sheet.lines]
    return ["| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows]


def terminal(sheet: Sheet) -> RichTable:
    """A sheet for a terminal."""
    table = RichTable(title=sheet.title, title_justify="left", title_style="bold")
    for name in sheet.header:
        table.add_column(escape(name), overflow="fold")
    for line in sheet.lines:
        table.add_row(*map(escape, line))
    return table
