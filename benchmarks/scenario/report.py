"""What was found in all pairs: tables on the terminal and as Markdown, and a figure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from benchmarks.scenario import procedure
from benchmarks.scenario.findings import CLAIMS, REFERENCE, Share, claims_with_ties, hits

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BECAME = {"judged": "judged", "fewer": "with fewer than five flights", "failed": "failed"}
"""What becomes of a pair, by its status."""

Records = Sequence[Mapping[str, Any]]


def judged(records: Records) -> list[Mapping[str, Any]]:
    """Those with five flights."""
    return [record for record in records if record["status"] == "judged"]


def notes(records: Records) -> list[str]:
    """What became of the pairs."""
    counts = Counter(record["status"] for record in records)
    parts = ", ".join(f"{counts[status]} {words}" for status, words in BECAME.items())
    found = [f"{len(records)} pairs: {parts}", *_other_places(records)]
    spreads = [_spread(record) for record in judged(records)]
    if spreads:
        found.append(
            f"durations of the five differ by {100 * float(np.median(spreads)):.1f} % in the "
            f"median, {100 * max(spreads):.1f} % at most"
        )
    found += _ties(judged(records))
    found += [f"pair {r['pair']}: {r['reason']}" for r in records if r["status"] == "failed"]
    return found


def _other_places(records: Records) -> Iterator[str]:
    """That this is not quite the procedure, if so."""
    used = {record["procedure"]["places"] for record in records if "procedure" in record}
    for places in sorted(used - {procedure.PLACES}):
        yield f"roadmaps of {places} places, where the procedure has {procedure.PLACES}"


def _ties(sets: Records) -> Iterator[str]:
    """Which norms tie flights, and in how many sets."""
    for table, what in (("norms", "f"), ("pc norms", "P_c")):
        values = [list(record[table].values()) for record in sets]
        for label in sets[0]["orders"] if sets else ():
            tied = sum(len({norms[label] for norms in five}) < len(five) for five in values)
            if tied:
                yield (
                    f"{label} of {what} ties flights in {tied} of {len(sets)} sets; orders put the "
                    "shorter first"
                )


def _spread(record: Mapping[str, Any]) -> float:
    durations = record["durations"].values()
    return max(durations) / min(durations) - 1.0


def tables(records: Records) -> Iterator[tuple[str, list[str], list[list[str]]]]:
    """Title, header and lines of each table; none without a pair that was judged."""
    sets = judged(records)
    if not sets:
        return
    lines, either = [], [claims_with_ties(record) for record in sets]
    for name, words in CLAIMS.items():
        share = Share.of([record["claims"][name] for record in sets])
        tied = Share.of([each[name] for each in either])
        lines.append([words, f"{share.count} of {share.total}", str(share), str(tied)])
    header = ["finding", "holds in", "share [95 % interval]", "the same if ties go either way"]
    yield "What the paper found", header, lines
    for title, end in (("safest", 0), ("riskiest", -1)):
        found = hits(sets, end)
        header = ["norm of f", *(f"{title} by {pc} of P_c" for pc in found)]
        lines = [[label, *map(str, row.values())] for label, row in found.items()]
        yield f"How often a norm finds the {title} flight", header, lines
    lines = [[label, _mean([record["tau"][label] for record in sets])] for label in sets[0]["tau"]]
    header = ["norm of f", f"mean tau with {REFERENCE} of P_c"]
    yield "Agreement of the orders: Kendall's tau [95 % interval of the mean]", header, lines


def _mean(values: Sequence[float]) -> str:
    """Such as "0.80 [0.75, 0.85]", within -1 and 1; of one value, that alone."""
    middle = float(np.mean(values))
    if len(values) == 1:
        return f"{middle:.2f}"
    error = 1.96 * float(np.std(values, ddof=1)) / len(values) ** 0.5
    return f"{middle:.2f} [{max(middle - error, -1.0):.2f}, {min(middle + error, 1.0):.2f}]"


def terminal_tables(records: Records) -> Iterator[Table]:
    """The tables for a terminal."""
    for title, header, lines in tables(records):
        table = Table(title=title, title_justify="left", title_style="bold")
        for name in header:
            table.add_column(name)
        for line in lines:
            table.add_row(*line)
        yield table


def markdown(records: Records) -> str:
    """The tables, what became of the pairs, and the procedure."""
    words = procedure.__doc__ or ""
    parts = ["# Five flights of equal time, many times", "", *(f"- {n}" for n in notes(records))]
    for title, header, lines in tables(records):
        parts += ["", f"## {title}", "", _row(header), _row(["---"] * len(header))]
        parts += [_row(line) for line in lines]
    return "\n".join([*parts, "", "## Procedure", "", words.strip(), ""])


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def draw_hits(records: Records, path: Path) -> None:
    """Draw how often each norm finds the safest and the riskiest flight, with intervals."""
    from matplotlib.figure import Figure

    sets = judged(records)
    figure = Figure((9.0, 4.2), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for axis, (title, end) in zip(axes, (("safest", 0), ("riskiest", -1)), strict=True):
        shares = {label: row[REFERENCE] for label, row in hits(sets, end).items()}
        _draw_shares(axis, shares, 100.0 / procedure.FLIGHTS)
        axis.set_title(f"finds the {title} by {REFERENCE} of $P_c$", fontsize=10)
        axis.set_xlabel("norm of $f$")
    axes[0].set_ylabel("share of sets [%]")
    figure.suptitle(f"{len(sets)} sets of five flights", fontsize=11)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    figure.savefig(path, dpi=150)


def _draw_shares(axis: Axes, shares: Mapping[str, Share], chance: float) -> None:
    """A bar for each share, and what chance would find [%]."""
    axis.set_ylim(0.0, 105.0)  # room for the end of an interval at 100 %
    axis.set_yticks(range(0, 101, 20))
    axis.axhline(
        chance, color="#cc3311", linestyle="--", linewidth=1.2, label=f"chance: {chance:g} %"
    )
    if not shares:
        axis.set_xticks([])
        axis.text(0.5, 0.5, "no pair was judged", transform=axis.transAxes, ha="center")
        return
    places = range(len(shares))
    middle = [100.0 * s.count / s.total for s in shares.values()]
    reach = [
        [m - 100.0 * s.low for m, s in zip(middle, shares.values(), strict=True)],
        [100.0 * s.high - m for m, s in zip(middle, shares.values(), strict=True)],
    ]
    axis.bar(places, middle, color="#a9c4e0", width=0.6, zorder=0, label="found")
    axis.errorbar(
        places, middle, reach, fmt="none", color="#222222", capsize=4, label="95 % interval"
    )
    ticks = [f"{label}\n{m:.0f} %" for label, m in zip(shares, middle, strict=True)]
    axis.set_xticks(places, ticks)
