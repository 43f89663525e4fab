"""The campaign in tables: on the terminal and as Markdown."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

from rich.markup import escape
from rich.table import Table

from benchmarks.campaign.metrics import METRICS
from benchmarks.campaign.run import prepared
from benchmarks.campaign.summary import Standing, Verdict, standings, verdicts
from benchmarks.campaign.table import Row
from benchmarks.metric import Spread

BUSY = 0.9
"""Below this share of processor time a planner had to wait for others."""
SHOWN = 3
"""So many objectives that do as well as the winner are named, the best first."""
EXPLAINED = (
    "Median over seeds with quartiles; a run without a path counts as the worst. "
    "= names objectives whose median lies within the winner's quartiles, + counts more of them. "
    "{} are bounds of a probability: 95 % intervals of sampled errors, and for P_c(t) over terrain "
    "the estimated error of the quadrature."
)


def winner_tables(rows: Sequence[Row]) -> Iterator[Table]:
    """For each scene, who wins each metric."""
    for title, header, lines in _tables(rows):
        table = Table(title=title, title_justify="left", title_style="bold", show_lines=False)
        for name in header:
            table.add_column(name, overflow="fold")
        for line in lines:
            table.add_row(*map(escape, line))
        yield table


def markdown(rows: Sequence[Row]) -> str:
    """The same as text, with what became of the runs."""
    parts = ["# Which objective wins which metric", "", EXPLAINED, ""]
    parts += [f"- {note}" for note in notes(rows)]
    for title, header, lines in _tables(rows):
        parts += ["", f"## {title}", "", _line(header), _line(["---"] * len(header))]
        parts += [_line(line) for line in lines]
    return "\n".join(parts) + "\n"


def notes(rows: Sequence[Row]) -> list[str]:
    """What became of the runs, and what a reader has to know about them."""
    counts = Counter(each["status"] for each in rows)
    found = [f"{len(rows)} runs: {', '.join(f'{n} {status}' for status, n in counts.items())}"]
    scenes = dict.fromkeys(each["scene"] for each in rows)
    samples = ", ".join(f"{prepared(name).sampling.samples} in {name}" for name in scenes)
    found.append(f"sampled errors for each probability: {samples}")
    for each in rows:
        if each["status"] in ("failed", "unsound"):
            run = f"{each['scene']}, {each['objective']} by {each['planner']}, seed {each['seed']}"
            found.append(f"{each['status']}: {run}: {each['reason']}")
    codes = Counter(each["code"] for each in rows)
    if len(codes) > 1:
        found.append(
            f"the runs come from {len(codes)} states of the code ({', '.join(codes)}), so they "
            "compare only as far as the changes between them do not matter"
        )
    shares = [e["seconds"] / e["wall seconds"] for e in rows if e["wall seconds"]]
    busy = sum(share < BUSY for share in shares)
    if busy:
        found.append(
            f"the machine was busy: in {busy} of {len(shares)} runs the planner had the processor "
            f"for less than {BUSY:.0%} of the time; budgets and curves are in processor time, so "
            "that costs it caches at most"
        )
    return found


def _tables(rows: Sequence[Row]) -> Iterator[tuple[str, list[str], list[list[str]]]]:
    """Title, header and lines of each scene's table."""
    everything = standings(rows)
    found = verdicts(everything)
    for scene in dict.fromkeys(each.scene for each in everything):
        planners = list(dict.fromkeys(each.planner for each in everything if each.scene == scene))
        lines = [
            [_label(name), *(_cell(found[scene, name, planner]) for planner in planners)]
            for name in METRICS
        ]
        title = f"{scene}: {prepared(scene).about}; winners among {_objectives(everything, scene)}"
        header = [f"{p} ({_solved(everything, scene, p)})" for p in planners]
        yield title, ["metric", *header], lines


def _objectives(everything: Sequence[Standing], scene: str) -> str:
    names = dict.fromkeys(each.objective for each in everything if each.scene == scene)
    return ", ".join(names)


def _solved(everything: Sequence[Standing], scene: str, planner: str) -> str:
    chosen = [s for s in everything if (s.scene, s.planner) == (scene, planner)]
    one = {each.objective: each for each in chosen}.values()
    return f"{sum(s.solved for s in one)}/{sum(s.runs for s in one)} solved"


def _label(name: str) -> str:
    metric = METRICS[name]
    unit = "" if metric.unit == "1" else f" [{metric.unit}]"
    return f"{name}{unit}{' (greatest)' if metric.better == 'higher' else ''}"


def _cell(judged: Verdict) -> str:
    if judged.winner is None:
        return "no path in half of the runs"
    names = [each.objective for each in judged.equals]
    more = f" +{len(names) - SHOWN}" if len(names) > SHOWN else ""
    equals = f" = {', '.join(names[:SHOWN])}{more}" if names else ""
    bounds = judged.winner.bounds
    limits = "" if bounds is None else f" {{{_text(bounds[0])}, {_text(bounds[1])}}}"
    return f"{judged.winner.objective} {spread_text(judged.winner.spread)}{limits}{equals}"


def spread_text(spread: Spread) -> str:
    """Such as "0.0268 [0.0264, 0.0271]"; the quartiles are left out where they are the median."""
    if spread.low == spread.high:
        return _text(spread.median)
    return f"{_text(spread.median)} [{_text(spread.low)}, {_text(spread.high)}]"


def _text(value: float) -> str:
    return "none" if math.isinf(value) else f"{value:.3g}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |"
