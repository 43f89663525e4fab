"""The results page: question, answer, tables, figures, procedure, limits, provenance."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from benchmarks import environment
from benchmarks.evidence import procedure
from benchmarks.evidence.analysis import calibration, ceiling, fitting, statistics, strata
from benchmarks.evidence.analysis.findings import Findings
from benchmarks.evidence.analysis.knowing import Knowing
from benchmarks.evidence.analysis.settings import NormOf, OfDistance, Setting
from benchmarks.evidence.analysis.table import Table
from benchmarks.evidence.analysis.tables import Sheet, markdown
from benchmarks.evidence.analysis.truth import LEAST_HITS, PAIRS, SIGNIFICANCE
from benchmarks.evidence.analysis.words import answer

COMMAND = "python -m benchmarks.evidence.analysis PARQUET --page docs/evidence.md"
QUESTION = """\
Five flights take the same time; which is the safest? A *setting* answers with a number for each
flight from its profile alone: a norm of an avoidance function of the clearance, say. The paper's
four are the L1, L2, L∞ and H1 norms of 1/d - 1/d0 with d0 = 100 m. The judge here is the simulated
flight itself: vehicle, tracking controller, navigation, gusts and map error in a closed loop,
hundreds of times for each flight, and the share of rollouts that hit the ground. A *set* is five
flights of a unit (a terrain with a start and a goal) at one level of disturbance."""
SCORES = """\
- *finds the safest*: the flight of least value is the one that collides least. Where a setting ties
  flights it earns the share of them that are right; where the judge ties the safest, any of them is
  right. Drawing lots finds one in five, and more where several never collide. *Finds the riskiest*:
  the same at the other end.
- *Kendall's tau*: tau-b between the setting's order of the five and the judge's.
- *regret*: probability of collision of the flight picked less that of the safest one. Both are
  counted, and the least of five counts is too low rather than too high: regret is somewhat too
  great, for all settings alike."""
LIMITS = (
    "One vehicle, one tracking controller and one model of the disturbances, each with a stated "
    "source but none measured on a real flight: what is recommended suits errors of this kind and "
    "size. With errors of another size the lengths in the setting have to be fitted anew.",
    "Terrains are drawn by the number of a unit alone: those of the first units had been flown "
    "over, with other starts and goals, while the procedure was chosen.",
    "A rollout that leaves the map or goes out of control would count as a collision like one that "
    "hits the ground. How rollouts end is not kept; in those that were looked at every hit was a "
    "contact.",
    "The three levels of disturbance weigh by their number of decided sets. The tables by level "
    "show what that hides.",
    "One of the test grounds is a single map of a real place, on which all its units lie; the "
    "others are synthetic. Drawing whole terrains instead of units shows how much hangs on it.",
    "Undecided sets are left out of the main tables: there the judge cannot tell even the safest "
    "flight from the riskiest. The last table has all sets.",
    "A set is decided by the same rollouts that then judge it, and the judge is noisy: no setting "
    "can reach 100 % but by luck. The ceiling says how far it could.",
    "Flights are sampled every 0.2 s, some 5 m. That is fine enough for integrals; but flights "
    "that share their closest approach are sampled there at different places, so that L∞, and "
    "norms of a large p, tell them apart by chance.",
    "The best of the paper's four is chosen on the test units, which favours it; that the "
    "recommended setting was not is the point of the split. Differences with other settings, and "
    "within strata, are many: one in twenty intervals misses by chance.",
    "Where a setting is right in every set, a bootstrap interval has no width; it is then no "
    "measure of certainty.",
)


def page(findings: Findings, tables: Sequence[Sheet], figures: dict[str, str]) -> str:
    """The page in Markdown.

    Args:
        findings: what was found.
        tables: of it.
        figures: path of each figure as the page links it, by the heading that it stands under.
    """
    lines = ["# Which norm predicts collisions", "", f"Written by `{COMMAND}`; do not edit.", ""]
    lines += [QUESTION, "", "## Answer", ""]
    for paragraph in answer(findings):
        lines += [paragraph, ""]
    lines += ["In code:", "", f"    {code(findings.rows[0].setting)}", ""]
    lines += ["## Scores", "", SCORES, "", *_images(figures, "Scores")]
    for sheet in tables:
        lines += _section(sheet, figures)
    lines += ["## Limits", "", *(f"- {limit}" for limit in LIMITS), ""]
    lines += [*_procedure(), *_provenance(findings.whole)]
    return "\n".join(lines).rstrip() + "\n"


def code(setting: Setting | Knowing) -> str:
    """How a setting is used."""
    if isinstance(setting, NormOf) and isinstance(setting.integrand, OfDistance):
        avoidance, norm = setting.integrand.avoidance, setting.norm
        return f"rank(trajectories, clearance, {avoidance!r}, norms=({norm!r},))"
    return repr(setting)


def _section(sheet: Sheet, figures: dict[str, str]) -> Iterator[str]:
    yield from (f"## {sheet.title}", "", *_images(figures, sheet.title))
    yield from (*markdown(sheet), "")


def _images(figures: dict[str, str], title: str) -> Iterator[str]:
    for heading, path in figures.items():
        if title.startswith(heading):
            yield from (f"![{heading}]({path})", "")


def _procedure() -> Iterator[str]:
    """How units are drawn, what is decided, fitted, and drawn again: the modules' own words."""
    yield from ("## Procedure", "", (procedure.__doc__ or "").strip(), "")
    yield from (
        f"A set is decided if a flight of it collided in at least {LEAST_HITS} rollouts and "
        f"McNemar's exact test between its riskiest and its safest flight, times {PAIRS} for the "
        f"pairs that could have been chosen, is at most {SIGNIFICANCE:g}.",
        "",
    )
    for module in (fitting, statistics, ceiling, strata, calibration):
        yield from ((module.__doc__ or "").strip(), "")


def _provenance(whole: Table) -> Iterator[str]:
    yield from ("## Seeds, versions, failures", "")
    if whole.reasons:
        for reason, times in whole.reasons.items():
            yield f"- {times} units: {reason}"
        yield ""
    rollouts = sorted({*whole.rollouts.ravel().tolist()})
    yield (
        f"- rollouts of each flight and level: {', '.join(map(str, rollouts))}\n"
        f"- bootstrap: {statistics.RESAMPLES} draws, seed {statistics.SEED}; ceiling: "
        f"{ceiling.DRAWS} draws, seed {ceiling.SEED}; cross-validation: {fitting.FOLDS} folds"
    )
    packages = {k: v for k, v in environment.versions().items() if v != "not installed"}
    yield f"- report made with {', '.join(f'{k} {v}' for k, v in packages.items())}"
    yield from ("- the campaign's own record:", "", "```json")
    yield from (json.dumps(whole.facts, indent=1, ensure_ascii=False), "```")
