"""What training chose, judged once on the test units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.evidence.analysis.calibration import Calibration, calibrate
from benchmarks.evidence.analysis.ceiling import halves, repeated
from benchmarks.evidence.analysis.fitting import Family, Fit, fit, objective
from benchmarks.evidence.analysis.knowing import (
    Knowing,
    Predicted,
    evaluated_by_level,
    tuned_by_level,
)
from benchmarks.evidence.analysis.metrics import Scores, scores
from benchmarks.evidence.analysis.settings import (
    FASTEST,
    PAPER,
    ExpectedCollisions,
    Setting,
    evaluated,
)
from benchmarks.evidence.analysis.statistics import Bootstrap, Interval, mean
from benchmarks.evidence.analysis.table import LEVELS, Table
from benchmarks.evidence.analysis.truth import Judgement, certain, closed_loop, paper
from ompl_risk._arrays import FloatArray
from ompl_risk.errors import ArgumentError

BY_LEVEL = (
    "L^p of 1/d, p and d0 tuned",
    "H1 of 1/d, d0 and τ tuned",
    "L^p of GaussianTail, p and σ tuned",
)
"""Families that are tuned to each level as well."""

PREFERRED = "preferred by training"
KNOWS = "knows the level"
MODERATE = LEVELS.index("moderate")
"""The level of settings that know one, where the paper's judges know of none."""

POINTS = 0.10
"""By how much the recommended setting should find the safest flight more often."""


class Row(NamedTuple):
    """A setting that is judged on the test units, and why."""

    role: str
    setting: Setting | Knowing


@dataclass(frozen=True, eq=False)
class Findings:
    """Everything that the page is written from.

    Attributes:
        whole: all units, of both splits.
        test: the test units.
        fit: what training chose.
        rows: settings that are judged, the recommended one first, then the paper's four.
        values: what they give the test flights, at each level, shape (S, L, U, 5).
        judge, pc: closed-loop probabilities by level, and the paper's judges.
        by_judge, by_pc: scores by them, each of shape (S, judges, U).
        ceiling: scores of one half of the rollouts by the other, and of rollouts drawn again.
        calibration: predicted probabilities by level; empty if no rate was among the families.
        draws, by_terrain: bootstrap by unit, and by terrain as a check.
    """

    whole: Table
    test: Table
    fit: Fit
    rows: tuple[Row, ...]
    values: FloatArray
    judge: Judgement
    pc: Judgement
    by_judge: Scores
    by_pc: Scores
    ceiling: tuple[Scores, Scores]
    calibration: tuple[Calibration, ...]
    draws: Bootstrap
    by_terrain: Bootstrap

    @cached_property
    def masks(self) -> dict[str, NDArray[np.bool_]]:
        """Which sets count: decided ones of all levels, of each, and with a sure safest; all."""
        decided = self.judge.decided
        levels = {
            name: decided & (np.arange(len(decided)) == k)[:, None]
            for k, name in enumerate(self.judge.names)
        }
        sure = {"certain": certain(self.test)}
        return {"pooled": decided, **levels, **sure, "all sets": np.ones_like(decided)}

    @property
    def paper(self) -> slice:
        """The rows of the paper's four norms."""
        return slice(1, 1 + len(PAPER))

    def intervals(self, metric: str, mask: str = "pooled") -> list[Interval]:
        """The mean of a score for each row, with its interval."""
        return self.draws.intervals(getattr(self.by_judge, metric), self.masks[mask])

    @property
    def chance(self) -> float:
        """In what share of the decided sets a flight drawn by lot is (one of) the safest."""
        lots = scores(np.zeros_like(self.judge.values), self.judge.values)
        return float(mean(lots.safest, self.masks["pooled"]))

    def pc_intervals(self, metric: str, index: int) -> list[Interval]:
        """The same by one of the paper's judges."""
        only = np.arange(len(self.pc.names)) == index
        return self.draws.intervals(getattr(self.by_pc, metric), self.pc.decided & only[:, None])

    def best_of_paper(self, metric: str) -> int:
        """The row of the paper's norm of greatest mean score, chosen on the test units."""
        means = mean(getattr(self.by_judge, metric)[self.paper], self.masks["pooled"])
        return self.paper.start + int(np.argmax(means))


class Comparison(NamedTuple):
    """The recommended setting less the best of the paper's four, in one score.

    Attributes:
        metric: name of the score.
        best: the paper's norm, the best one on the test units.
        by_unit: paired difference, units drawn with replacement.
        by_terrain: terrains drawn instead.
        anew: the best of the four chosen anew in each draw, which is harder still.
    """

    metric: str
    best: Setting | Knowing
    by_unit: Interval
    by_terrain: Interval
    anew: Interval


def compare(findings: Findings, metric: str, mask: str = "pooled") -> Comparison:
    """Compare the recommended setting with the best of the paper's four on the same sets."""
    found, counted = getattr(findings.by_judge, metric), findings.masks[mask]
    best = findings.best_of_paper(metric)
    gain = (found[0] - found[best])[None]
    four = found[findings.paper]
    estimate = mean(found[:1], counted) - mean(four, counted).max()
    draws = findings.draws.means(found[:1], counted)
    draws = draws - findings.draws.means(four, counted).max(axis=0)
    return Comparison(
        metric,
        findings.rows[best].setting,
        findings.draws.intervals(gain, counted)[0],
        findings.by_terrain.intervals(gain, counted)[0],
        findings.draws.summary(estimate, draws)[0],
    )


def gain_on_paper(findings: Findings, row: int, metric: str) -> Interval:
    """Score of a row less that of the best of the paper's four, on the same decided sets."""
    found = getattr(findings.by_judge, metric)
    gain = (found[row] - found[findings.best_of_paper(metric)])[None]
    return findings.draws.intervals(gain, findings.masks["pooled"])[0]


def target_reached(safest: Comparison, tau: Comparison) -> bool:
    """Ten points more sets and a higher tau, both with intervals above zero."""
    enough = safest.by_unit.mean >= POINTS and safest.by_unit.low > 0.0
    return enough and tau.by_unit.low > 0.0


def analyse(whole: Table, families: Sequence[Family]) -> Findings:
    """Fit on the training units, then judge what was chosen on the test units, once.

    Raises:
        ArgumentError: no test unit, or as `fit`.
    """
    training, test = whole.part("train"), whole.part("test")
    if not len(test):
        raise ArgumentError("whole", str(whole.path), "a table with complete test units")
    found = fit(training, families)
    rates = [s for f in families for s in f.settings if isinstance(s, ExpectedCollisions)]
    judge, pc = closed_loop(test), paper(test)
    rows = _rows(found, _recommended(found, test, judge), _known(training, families))
    values = evaluated_by_level([row.setting for row in rows], test.profiles)
    return Findings(
        whole,
        test,
        found,
        rows,
        values,
        judge,
        pc,
        scores(values, judge.values),
        scores(values[:, MODERATE, None], pc.values),
        (halves(test), repeated(test)),
        calibrate(training, test, rates) if rates else (),
        Bootstrap.of(test.units),
        Bootstrap.of(test.places),
    )


def _known(training: Table, families: Sequence[Family]) -> list[Row]:
    """Rows that know the level: each of ``BY_LEVEL`` that there is, tuned to it, and prediction."""
    by_name = {family.name: family.settings for family in families}
    tuned = [
        Row(KNOWS, tuned_by_level(training, name.partition(",")[0], by_name[name]))
        for name in BY_LEVEL if name in by_name
    ]  # fmt: skip
    return [*tuned, Row(KNOWS, Predicted())]


def twice_better(preferred: FloatArray, simple: FloatArray, draws: Bootstrap, counted: Any) -> bool:
    """Whether what training prefers has a certainly greater objective on the test sets too."""
    return draws.intervals((preferred - simple)[None], counted)[0].low > 0.0


def _recommended(found: Fit, test: Table, judge: Judgement) -> Setting:
    if found.preferred == found.simple:
        return found.simple
    both = objective(evaluated([found.preferred, found.simple], test.profiles), judge)
    draws = Bootstrap.of(test.units)
    return found.preferred if twice_better(both[0], both[1], draws, judge.decided) else found.simple


def _rows(found: Fit, recommended: Setting, known: Sequence[Row]) -> tuple[Row, ...]:
    rows = [Row("recommended", recommended)]
    rows += [Row("paper", setting) for setting in PAPER]
    rows += [
        Row(family.name, setting)
        for family, setting in zip(found.families, found.choices, strict=True)
    ]
    if found.preferred != found.simple:
        rows.insert(1 + len(PAPER), Row(PREFERRED, found.preferred))
    return (*rows, *known, Row("fastest flight, risk unseen", FASTEST))
