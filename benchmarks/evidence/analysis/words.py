"""The findings in sentences, which follow the numbers whichever way they fall."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks.evidence.analysis.findings import (
    POINTS,
    Comparison,
    Findings,
    compare,
    gain_on_paper,
    target_reached,
)
from benchmarks.evidence.analysis.knowing import Knowing
from benchmarks.evidence.analysis.settings import FAR
from benchmarks.evidence.analysis.statistics import Interval, mean
from benchmarks.evidence.analysis.strata import MEASURES, THIRDS, strata
from benchmarks.evidence.analysis.tables import difference, number, probability, share

HALVES, AGAIN = 0, 1

ENOUGH = 30
"""Test units below which the page warns of what it says."""


def answer(findings: Findings) -> Iterator[str]:
    """What was found, a paragraph each."""
    if not findings.judge.decided.any():
        yield (
            "No test set is decided: the judge cannot tell the flights of any set apart, so there "
            "is nothing to find."
        )
        return
    units = int(findings.judge.decided.any(axis=0).sum())
    if units < ENOUGH:
        yield (
            f"**Only {units} test unit{'s' * (units != 1)} with a decided set: far too few to "
            "conclude anything.** Intervals are drawn from these alone, and say nothing of others."
        )
    safest, tau = compare(findings, "safest"), compare(findings, "tau")
    yield _headline(findings, safest, tau)
    yield _target(safest, tau)
    if not target_reached(safest, tau):
        yield _room(findings, safest)
    yield _knowing(findings)
    yield _h1(findings)
    yield _pc(findings)
    yield _where(findings)
    yield _challengers(findings)


def _headline(findings: Findings, safest: Comparison, tau: Comparison) -> str:
    best = [row.setting for row in findings.rows].index(safest.best)
    found, taus = findings.intervals("safest"), findings.intervals("tau")
    regret = findings.intervals("regret")
    ordered = [row.setting for row in findings.rows].index(tau.best)
    return (
        f"**{findings.rows[0].setting.label}**, chosen on training alone, finds the safest of five "
        f"flights in {share(found[0])} of {int(findings.masks['pooled'].sum())} decided test sets; "
        f"the best of the paper's four there, {safest.best.label}, in {share(found[best])}; "
        f"drawing lots would in {100 * findings.chance:.0f} %. Its mean Kendall tau is "
        f"{number(taus[0])}, against {number(taus[ordered])} of {tau.best.label}. The flight "
        "that it picks collides more often than the safest one by "
        f"{probability(regret[0])}, that of {safest.best.label} by {probability(regret[best])}."
    )


def _target(safest: Comparison, tau: Comparison) -> str:
    reached = target_reached(safest, tau)
    return (
        f"The target was {100 * POINTS:.0f} points more sets and a higher tau, both with 95 % "
        f"intervals that exclude zero. It is **{'reached' if reached else 'not reached'}**: the "
        f"paired differences are {difference('safest', safest.by_unit)} and "
        f"{difference('tau', tau.by_unit)}. With the best of the four chosen anew in each draw "
        f"they are {difference('safest', safest.anew)} and {difference('tau', tau.anew)}, "
        f"and with whole terrains drawn {difference('safest', safest.by_terrain)} and "
        f"{difference('tau', tau.by_terrain)}."
    )


def _room(findings: Findings, safest: Comparison) -> str:
    """Why the target is missed, as far as the numbers tell."""
    counted = findings.masks["pooled"]
    ends = [mean(each.safest, counted) for each in findings.ceiling]
    rows = [row.setting for row in findings.rows]
    scores = mean(findings.by_judge.safest, counted)
    best_row = rows.index(safest.best)
    best, top = scores[best_row], int(np.argmax(scores))
    low, high = sorted(100 * (end - best) for end in ends)
    enough = (
        f"less than the {100 * POINTS:.0f} points asked for: no setting could be expected to gain "
        "them"
        if high < 100 * POINTS
        else "so the judge's noise does not rule the target out"
    )
    return (
        f"Why: {safest.best.label} is {low:+.1f} to {high:+.1f} points from where the judge's own "
        f"noise ends (see the ceiling), {enough}. The most that any setting listed here finds on "
        f"test is {100 * scores[top]:.0f} % ({rows[top].label}), {100 * (scores[top] - best):+.1f} "
        f"points; picking it now would be picking by the test. {_certain(findings, best_row)}"
    ).rstrip()


def _certain(findings: Findings, best: int) -> str:
    """How it goes where the judge knows which flight is the safest."""
    counted = findings.masks["certain"]
    if not counted.any():
        return ""
    found = findings.intervals("safest", "certain")
    return (
        f"In the {int(counted.sum())} sets in which the judge is certain which flight is the "
        f"safest, {findings.rows[best].setting.label} finds it in {share(found[best])} and "
        f"{findings.rows[0].setting.label} in {share(found[0])}: there is little left to gain, "
        "and what differs is how settings order flights that are nearly equally safe."
        if found[best].mean > 1.0 - POINTS
        else f"In the {int(counted.sum())} sets in which the judge is certain which flight is the "
        f"safest, {findings.rows[best].setting.label} finds it in {share(found[best])} and "
        f"{findings.rows[0].setting.label} in {share(found[0])}."
    )


def _knowing(findings: Findings) -> str:
    """What knowing the size of the errors is worth."""
    parts = []
    for k, row in enumerate(findings.rows):
        if not isinstance(row.setting, Knowing):
            continue
        safest, tau = (gain_on_paper(findings, k, metric) for metric in ("safest", "tau"))
        found = findings.intervals("safest")[k]
        parts.append(
            f"{row.setting.label} {share(found)}, {difference('safest', safest)} and "
            f"{difference('tau', tau)}"
        )
    return (
        "Settings that know the level of disturbance, against the best of the paper's four (safest "
        f"found, gain in it and in tau): {'; '.join(parts)}. The prediction has nothing fitted, "
        "but the sizes of the errors that the judge draws: it is the closed form of what the judge "
        "simulates, and so says what a number without rollouts can know, not what a norm "
        "of the distance can."
    )


def _h1(findings: Findings) -> str:
    """How the paper's own H1 does among the paper's four."""
    rows = findings.rows[findings.paper]
    h1 = next(k for k, row in enumerate(rows) if row.setting.label.startswith("H1"))
    parts = []
    for metric, words in (("safest", "safest found"), ("tau", "tau")):
        scores = getattr(findings.by_judge, metric)[findings.paper]
        means = mean(scores, findings.masks["pooled"])
        others = [k for k in range(len(rows)) if k != h1]
        rival = others[int(np.argmax(means[others]))]
        gain = findings.draws.intervals(
            (scores[h1] - scores[rival])[None], findings.masks["pooled"]
        )[0]
        parts.append(
            f"{_verdict(gain)} the best L^p in {words} ({rows[rival].setting.norm.label}, "  # type: ignore[attr-defined]
            f"{difference(metric, gain)})"
        )
    return f"The paper's H1 (d0 = {FAR:g} m, τ = 1 s): {' and '.join(parts)}."


def _verdict(gain: Interval) -> str:
    if not gain.excludes_zero:
        return "no certain difference from"
    return "better than" if gain.low > 0.0 else "worse than"


def _pc(findings: Findings) -> str:
    """What the paper's own judges would have said."""
    second = findings.pc.names.index("L2 of P_c")
    found = findings.pc_intervals("safest", second)
    four = list(range(findings.paper.start, findings.paper.stop))
    best = max(four, key=lambda k: found[k].mean)
    closed = [i.mean for i in findings.intervals("safest")]
    return (
        f"By the paper's own judge, the L2 norm of P_c, the best of the four is "
        f"{findings.rows[best].setting.label} with {share(found[best])} of all "
        f"{int(findings.pc.decided[second].sum())} units, and the recommended setting finds "
        f"{share(found[0])}. By closed-loop probability that same norm of the paper finds "
        f"{100 * closed[best]:.0f} %."
    )


def _where(findings: Findings) -> str:
    """How it goes where each danger is greatest, and in which strata the recommended one loses."""
    parts, lost, total = [], [], 0
    for stratum in strata(findings):
        found = stratum.scores["safest"]
        four = found[findings.paper]
        best = int(np.argmax([each.mean for each in four]))
        label = findings.rows[findings.paper][best].setting.label
        total += 1
        if stratum.group in MEASURES and stratum.name.startswith(THIRDS[-1]):
            parts.append(
                f"{stratum.group} {100 * found[0].mean:.0f} % against "
                f"{100 * four[best].mean:.0f} % of {label}"
            )
        scores = findings.by_judge.safest
        gain = findings.draws.intervals(
            (scores[0] - scores[findings.paper][best])[None], stratum.counted
        )[0]
        if gain.mean < 0.0:
            lost.append(f"{stratum.group}, {stratum.name} ({difference('safest', gain)}, {label})")
    return (
        f"In the third of the units with most of each danger it finds the safest so often: "
        f"{'; '.join(parts)}. In {len(lost)} of {total} strata one of the paper's four finds it "
        f"more often{': ' if lost else ''}{'; '.join(lost)}."
    )


def _twice(findings: Findings) -> str:
    """What became of a preference for something that is not simple."""
    found = findings.fit
    if found.preferred == found.simple:
        return "None is certainly better, so the simple setting is recommended."
    won = findings.rows[0].setting == found.preferred
    return (
        f"Training prefers the {found.source}; on the test units it is "
        f"{'certainly better too, and recommended' if won else 'not certainly better'}"
        f"{'.' if won else ', so the simple setting is recommended.'}"
    )


def _challengers(findings: Findings) -> str:
    """What was not simple, and whether it was certainly better."""
    parts = [
        f"{each.name} ({each.setting.label}) {each.gain.mean:+.3f} "
        f"[{each.gain.low:+.3f}, {each.gain.high:+.3f}]"
        for each in findings.fit.challengers
    ]
    return (
        f'The best simple family of training is "{findings.fit.leader}". On terrains held out of '
        f"training, objective over that: {'; '.join(parts) or 'nothing else was tried'}. "
        f"{_twice(findings)}"
    )
