"""The ranking as tables for a terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from ompl_risk.ranking.agreement import Agreement
from ompl_risk.ranking.export import norm_unit

if TYPE_CHECKING:
    from ompl_risk.ranking.assessment import Assessment, Estimate
    from ompl_risk.ranking.result import Ranking

SAFEST = "bold green"
RISKIEST = "red"


def render(ranking: Ranking) -> RenderableType:
    """Norms, orders, agreement and attribution, one below the other."""
    parts: list[RenderableType] = [
        trajectory_table(ranking),
        norm_table(ranking, "Norms of f (* safest)", ranking.orders, of_probability=False),
    ]
    if ranking.has_probability:
        title = "Norms of the probability of collision (* safest)"
        parts.append(norm_table(ranking, title, ranking.pc_orders, of_probability=True))
    if ranking.has_estimates:
        parts.append(probability_table(ranking))
    parts.append(order_table(ranking))
    if len(ranking.assessments) > 1:
        parts.append(agreement_table(ranking.agreement, "Kendall tau-b between norms"))
        if ranking.pc_agreement is not None:
            parts.append(
                agreement_table(
                    ranking.pc_agreement, "Kendall tau-b: norms (rows), probability (columns)"
                )
            )
        if ranking.probability_agreement is not None:
            title = "Kendall tau-b: norms (rows), probability of a collision"
            parts.append(agreement_table(ranking.probability_agreement, title))
    parts.append(attributions(ranking))
    if not ranking.durations_comparable:
        parts.append(duration_note(ranking))
    return Group(*parts)


def trajectory_table(ranking: Ranking) -> Table:
    """Duration, length and closest approach, a row for each trajectory."""
    table = _titled("Trajectories")
    table.add_column("trajectory")
    for heading in ("duration [s]", "length [m]", "least clearance [m]", "at t [s]"):
        table.add_column(Text(heading), justify="right")  # "[s]" would be markup
    for a in ranking.assessments:
        numbers = (a.duration, a.length, a.min_clearance, a.min_clearance_time)
        style = RISKIEST if a.collides else ""
        table.add_row(Text(a.name), *(f"{value:.5g}" for value in numbers), style=style)
    return table


def norm_table(
    ranking: Ranking, title: str, orders: Mapping[str, tuple[str, ...]], *, of_probability: bool
) -> Table:
    """The norms of f or of the probability of collision; * marks the safest by each."""
    table = _titled(title)
    table.add_column("trajectory")
    for norm in ranking.norms:
        unit = norm_unit(norm, of="1" if of_probability else ranking.avoidance.unit)
        table.add_column(Text(f"{norm.label}\n[{unit}]"), justify="right")
    rows = {a.name: a.pc_norms if of_probability else a.norms for a in ranking.assessments}
    for name in rows:
        table.add_row(Text(name), *(_value(rows, k, orders[k], name) for k in ranking.labels))
    return table


def probability_table(ranking: Ranking) -> Table:
    """The probability that the whole trajectory ends in collision, and how sure that is."""
    table = _titled("Probability of a collision (* least)")
    table.add_column("trajectory")
    for heading in ("estimate", "at least", "at most"):
        table.add_column(heading, justify="right")
    table.add_column("")
    least = min(a.estimate.probability for a in ranking.assessments if a.estimate is not None)
    for a in ranking.assessments:
        if a.estimate is None:
            continue
        star, style = ("* ", SAFEST) if a.estimate.probability == least else ("", "")
        bounds = (f"{p:.3g}" for p in (a.estimate.low, a.estimate.high))
        # a bare 0 would say more than was found
        estimate = f"{a.estimate.probability:.3g}" if a.estimate.probability > 0.0 else "none seen"
        counts = _counts(a.estimate)
        table.add_row(Text(a.name), Text(f"{star}{estimate}", style=style), *bounds, Text(counts))
    return table


def _counts(estimate: Estimate) -> str:
    """Hits and rollouts, where the estimate has them; and what weights may hide."""
    hits, rollouts = getattr(estimate, "hits", None), getattr(estimate, "rollouts", None)
    if hits is None or rollouts is None:
        return ""
    counts = f"{hits:,} of {rollouts:,} rollouts"
    bound = getattr(estimate, "upper_bound", None)
    if getattr(estimate, "weights", None) is None or bound is None:
        return counts
    return f"{counts}, weighted;\nwhatever was missed at most {bound():.3g}"


def order_table(ranking: Ranking) -> Table:
    """The order of the trajectories by each norm."""
    table = _titled("From safest to riskiest")
    table.add_column("by")
    table.add_column("order")
    for label, order in ranking.orders.items():
        table.add_row(Text(label), Text("  ".join(order)))
    for label, order in ranking.pc_orders.items():
        table.add_row(Text(f"P_c {label}"), Text("  ".join(order)))
    if ranking.has_estimates:
        table.add_row(Text("probability"), Text("  ".join(ranking.probability_order)))
    return table


def agreement_table(agreement: Agreement, title: str) -> Table:
    """Kendall's tau-b, a row and a column for each norm."""
    table = _titled(title)
    table.add_column("")
    for label in agreement.columns:
        table.add_column(Text(label), justify="right")
    for label, row in zip(agreement.rows, agreement.tau, strict=True):
        table.add_row(Text(label), *(f"{tau:.2f}" for tau in row))
    return table


def attributions(ranking: Ranking) -> Table:
    """Where the last norm's risk comes from, a sentence for each trajectory."""
    label = ranking.labels[-1]
    table = _titled(f"Where {label} comes from")
    table.add_column("trajectory")
    table.add_column("")
    for a in ranking.assessments:
        table.add_row(Text(a.name), Text(_sentence(a, label)))
    return table


def duration_note(ranking: Ranking) -> Text:
    """What to do about durations that do not compare."""
    fronts = "; ".join(f"{label}: {', '.join(ranking.pareto(label))}" for label in ranking.labels)
    percent = 100 * ranking.duration_spread
    spread = f"{percent:.3g}" if percent < 1000 else f"{percent:,.0f}"
    return Text(
        f"Durations differ by {spread} %, more than "
        f"{100 * ranking.duration_tolerance:.3g} %, so the norms do not compare as they stand. "
        f"Not beaten in both duration and norm: {fronts}.",
        style="yellow",
    )


def _titled(title: str) -> Table:
    """A table that is as wide as its title: a narrower one would break it."""
    return Table(title=escape(title), title_justify="left", min_width=len(title))


def _value(
    rows: Mapping[str, Mapping[str, float]], label: str, order: tuple[str, ...], name: str
) -> Text:
    value, least = rows[name][label], rows[order[0]][label]
    if value == least < math.inf:
        return Text(f"* {value:.4g}", style=SAFEST)
    return Text(f"{value:.4g}", style=RISKIEST if name == order[-1] else "")


def _sentence(a: Assessment, label: str) -> str:
    if a.collision_time is not None and a.collision_position is not None:
        x, y, _ = a.collision_position
        return f"collides, first at t = {a.collision_time:.1f} s near ({x:.0f}, {y:.0f}) m"
    part = a.attribution[label]
    return "no obstacle nearer than d0" if part is None else part.sentence
